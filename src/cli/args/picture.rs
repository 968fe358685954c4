//! The options that override a scene's render settings, for every command that renders or plans.
//! The table that declares the keys of a scene also declares these options.

use clap::{Arg, ArgAction, ArgMatches, Args, Command, FromArgMatches};
use serde_json::Value;

use crate::scene::Override;
use crate::scene::keys::{self, CliOption, KeyInfo};

use super::scene::{SceneArgs, SceneOptions};
use super::values::{Size, size, whole};

/// Overrides of the scene's settings.
#[derive(Debug, Default)]
pub struct PictureArgs {
    given: Vec<Override>,
}

/// The option that sets both the width and the height.
const SIZE: &str = "size";

impl PictureArgs {
    /// Returns true if the number of samples is given.
    pub fn has_samples(&self) -> bool {
        self.given.iter().any(|given| given.key == "render.samples_per_pixel")
    }

    /// Returns the overrides of the scene. `--set` comes last and wins.
    pub fn overrides(&self, scene: &SceneArgs) -> Vec<Override> {
        self.overrides_with(&scene.options)
    }

    /// Returns the overrides of the scene. `--set` comes last and wins.
    pub fn overrides_with(&self, options: &SceneOptions) -> Vec<Override> {
        self.given.iter().cloned().chain(options.overrides()).collect()
    }
}

/// Returns the keys that have an option.
fn options() -> impl Iterator<Item = (KeyInfo, CliOption)> {
    keys::all().into_iter().filter_map(|key| key.option.map(|option| (key, option)))
}

/// Returns true if the schema type of the key is `kind`.
fn is_a(key: &KeyInfo, kind: &str) -> bool {
    key.schema["type"] == kind
}

/// The table of particle files, of which options change the first.
const PARTICLES: &str = "particles";

/// Returns true if the key takes any text or a number.
fn is_text(key: &KeyInfo) -> bool {
    key.schema["type"].is_array()
}

/// Returns the help text: the key's description, and the names that it accepts.
fn help(key: &KeyInfo, option: &CliOption) -> String {
    let words = option.help.unwrap_or(key.help);
    let mut letters = words.chars();
    let first: String = letters.next().into_iter().flat_map(char::to_uppercase).collect();
    let mut text = first + letters.as_str();
    let names = key.schema["enum"].as_array().map(Vec::as_slice).unwrap_or_default();
    let names: Vec<&str> = names.iter().filter_map(Value::as_str).collect();
    if let [first @ .., last] = names.as_slice() {
        text += &format!(": {} or {last}", first.join(", "));
    }
    text
}

/// Builds the clap argument. Ranges are checked when the scene is read.
fn argument(key: &KeyInfo, option: &CliOption) -> Arg {
    let arg = Arg::new(option.name).long(option.name).help(help(key, option));
    let arg = if key.table == PARTICLES { arg.help_heading("Particle files") } else { arg };
    if is_a(key, "boolean") {
        return arg.action(ArgAction::SetTrue);
    }
    let arg = arg.value_name(option.value);
    let arg = match is_text(key) {
        true => arg.allow_hyphen_values(true),
        false => arg.allow_negative_numbers(true),
    };
    match is_a(key, "integer") {
        true => arg.value_parser(whole),
        false => arg.value_parser(clap::value_parser!(String)),
    }
}

impl Args for PictureArgs {
    fn augment_args(command: Command) -> Command {
        let size = Arg::new(SIZE)
            .long(SIZE)
            .value_name("WxH")
            .help("The size of the picture in pixels, such as 640x480")
            .value_parser(size);
        let with_keys =
            options().fold(command, |command, (key, option)| command.arg(argument(&key, &option)));
        with_keys.arg(size)
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl FromArgMatches for PictureArgs {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let mut picture = Self::default();
        picture.update_from_arg_matches(matches)?;
        Ok(picture)
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        let size = matches.get_one::<Size>(SIZE).copied();
        self.given.extend(size.into_iter().flat_map(Size::overrides));
        for (key, option) in options() {
            let name = match key.table {
                PARTICLES => format!("{PARTICLES}.0.{}", key.name),
                table => format!("{table}.{}", key.name),
            };
            if is_a(&key, "boolean") {
                if matches.get_flag(option.name) {
                    let flag = format!("--{}", option.name);
                    self.given.push(Override::new(name, "true").with_option([&*flag]));
                }
                continue;
            }
            let given = match is_a(&key, "integer") {
                true => matches.get_one::<i128>(option.name).map(ToString::to_string),
                false => matches.get_one::<String>(option.name).cloned(),
            };
            let Some(given) = given else { continue };
            let value = if is_a(&key, "array") { format!("[{given}]") } else { given.clone() };
            let words = [&*format!("--{}", option.name), &*given];
            self.given.push(Override::new(name, value).with_option(words));
        }
        Ok(())
    }
}
