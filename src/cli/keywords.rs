//! The options of `photosphere render` for another front end whose keywords they are, such as the
//! Python package. One definition serves both, so that names, values and defaults cannot differ.

use std::path::{Path, PathBuf};

use clap::error::ContextKind;
use clap::{Arg, ArgAction};

use crate::error::{Error, Result};
use crate::job::{CheckpointHeader, Job, OutputSpec};
use crate::overlay::OverlaySpec;
use crate::scene::{Override, SceneFile, Settings, TableInput, read_file, read_text_with};
use crate::studio::{Import, StudioOptions, Style, import_particles, overlay_spec};

use super::args::{Command, help};
use super::memory::{self, MemoryNeeds};
use super::particle_file::ParticleFile;
use super::render::{RenderRequest, scene_text};

/// An option of `photosphere render`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Keyword {
    /// The name, without dashes in front.
    pub name: String,
    /// What its value is called; `None` for a flag.
    pub value: Option<String>,
    /// The help text.
    pub help: String,
    /// The default, if it is fixed.
    pub default: Option<String>,
    /// The values that it accepts, if they are names.
    pub choices: Vec<String>,
}

/// Returns every option of `photosphere render`, in the order of its help.
pub fn keywords() -> Vec<Keyword> {
    let mut program = help::program();
    program.build();
    let render = program.find_subcommand("render");
    let options = render.into_iter().flat_map(|command| command.get_opts().chain(flags(command)));
    options.filter(|arg| arg.get_id() != "help").filter_map(keyword).collect()
}

fn flags(command: &clap::Command) -> impl Iterator<Item = &Arg> {
    let is_flag = |arg: &&Arg| !arg.is_positional() && !arg.get_action().takes_values();
    command.get_arguments().filter(is_flag)
}

fn keyword(arg: &Arg) -> Option<Keyword> {
    let is_flag = matches!(arg.get_action(), ArgAction::SetTrue);
    let value = arg.get_value_names().and_then(|names| names.first()).map(ToString::to_string);
    let default = arg.get_default_values().first();
    let choices = arg.get_possible_values();
    let visible = choices.iter().filter(|choice| !choice.is_hide_set());
    Some(Keyword {
        name: arg.get_long()?.to_owned(),
        value: value.filter(|_| !is_flag),
        help: arg.get_help().map(ToString::to_string).unwrap_or_default(),
        default: default.filter(|_| !is_flag).map(|text| text.to_string_lossy().into_owned()),
        choices: visible.map(|choice| choice.get_name().to_owned()).collect(),
    })
}

/// A render that options describe.
pub struct KeywordRender(RenderRequest);

/// Where the scene of a render comes from.
#[derive(Clone, Debug)]
#[allow(clippy::large_enum_variant, reason = "one exists at a time, and it is moved once")]
pub enum SceneInput {
    /// A scene file, or a particle file.
    File(PathBuf),
    /// The text of a scene, whose tables are in memory or in files.
    Text {
        /// The name of the scene in messages.
        name: String,
        /// The text.
        text: String,
        /// Where relative paths start.
        folder: PathBuf,
        /// The tables in memory, as in [`read_text_with`].
        tables: Vec<TableInput>,
    },
    /// Particles, which the options frame and light.
    Particles {
        /// The name of the particles in messages.
        name: String,
        /// The file that stands for them in the scene.
        path: PathBuf,
        /// The particles.
        particles: TableInput,
    },
}

/// A scene that has been read.
#[derive(Debug)]
pub struct OpenedScene {
    /// The scene.
    pub file: SceneFile,
    /// The text of a scene that was made of particles.
    pub text: Option<String>,
    /// What the user should know of the file.
    pub notes: Vec<String>,
    /// The choices that were made automatically: names and values of options.
    pub choices: Vec<(&'static str, String)>,
}

impl KeywordRender {
    /// Reads options as words of a command line, such as `--spp=64`.
    ///
    /// # Errors
    /// Says what is wrong with them.
    pub fn parse(words: &[String]) -> std::result::Result<Self, String> {
        let begin = ["photosphere", "render", "scene", "--output=none"].map(str::to_owned);
        let line = begin.iter().chain(words).map(Into::into);
        let cli = super::parse(&mut help::program(), line).map_err(|mut answer| {
            answer.remove(ContextKind::Usage);
            let text = answer.render().to_string();
            let message = text.split("\n\n").next().unwrap_or_default();
            message.trim_start_matches("error: ").trim().to_owned()
        })?;
        match &cli.command {
            Command::Render(args) => Ok(Self(RenderRequest::of_args(args))),
            _ => Err("these are not the options of a render".to_owned()),
        }
    }

    /// Returns the render that a checkpoint belongs to, and its scene; `None` if the scene was made
    /// of values, of which no file or text is known.
    ///
    /// # Errors
    /// If the recorded path is no regular file.
    pub fn of_checkpoint(header: &CheckpointHeader) -> Result<(Self, Option<SceneInput>)> {
        let file = header.source.as_ref().and_then(|source| source.file.clone());
        let input = match (scene_text(header), &file) {
            (Some(source), _) => Some(SceneInput::Text {
                name: source.name,
                text: source.text.unwrap_or_default(),
                folder: source.folder,
                tables: Vec::new(),
            }),
            // A pipe or a device that a stranger names could keep the program waiting.
            (None, Some(path)) if path.exists() && !path.is_file() => {
                return Err(Error::file("read the scene", path, "it is not a regular file"));
            }
            (None, file) => file.clone().map(SceneInput::File),
        };
        let output = OutputSpec { files: Vec::new(), ..header.output.clone().unwrap_or_default() };
        let scene = file.unwrap_or_default();
        Ok((Self(RenderRequest::of_header(header, scene, output)), input))
    }

    /// Reads the scene. `changes` are overrides that come after those of the options.
    ///
    /// # Errors
    /// If the scene or an option is wrong.
    pub fn open(&self, input: SceneInput, changes: &[Override]) -> Result<OpenedScene> {
        let overrides: Vec<Override> = self.0.overrides.iter().chain(changes).cloned().collect();
        let made_of_particles = |import: Import| {
            let mut opened = OpenedScene::from(import);
            opened.choices.extend(self.0.default_choices());
            opened
        };
        let file = match input {
            SceneInput::File(path) if !ParticleFile::is_one(&path, &overrides) => {
                read_file(&path, &overrides)?
            }
            SceneInput::File(path) => {
                let file = ParticleFile { path: &path, overrides: &overrides };
                return file.import(&self.0.studio).map(made_of_particles);
            }
            SceneInput::Text { name, text, folder, tables } => {
                read_text_with(&name, &text, &folder, &overrides, tables)?
            }
            SceneInput::Particles { name, path, particles } => {
                let studio = &self.0.studio;
                let import = import_particles(&name, &path, studio, &overrides, particles)?;
                return Ok(made_of_particles(import));
            }
        };
        Ok(OpenedScene { notes: file.warnings(), file, text: None, choices: Vec::new() })
    }

    /// Returns true if the file holds particles rather than a scene.
    pub fn is_particle_file(&self, path: &Path) -> bool {
        ParticleFile::is_one(path, &self.0.overrides)
    }

    /// Refuses a scene that does not fit into memory.
    ///
    /// # Errors
    /// Says how much it needs.
    pub fn check_memory(&self, file: &SceneFile) -> Result<()> {
        let chosen = self.0.job.accel.select_for_count(file.size().spheres as usize);
        let layers = &self.0.job.layers;
        let needs = MemoryNeeds { backends: &[chosen.backend], kinds: layers, besides: 0 };
        memory::check(file, &needs, self.0.memory_limit)
    }

    /// Returns the render with the noise target that `photosphere render` gives particles if no
    /// option says when to stop.
    #[must_use]
    pub fn until_good(self) -> Self {
        Self(self.0.until_good())
    }

    /// Returns the render with the layers that guide a denoiser, if its pictures are denoised.
    #[must_use]
    pub fn guided(self) -> Self {
        if self.0.delivery.denoise { Self(self.0.guided()) } else { self }
    }

    /// Describes what is drawn over the picture.
    pub fn overlay(&self, file: &SceneFile) -> Option<OverlaySpec> {
        overlay_spec(&self.0.delivery.overlay, file, self.0.delivery.dpi)
    }

    /// Returns the job, with these settings of the scene.
    pub fn job(&self, settings: Settings) -> Job {
        Job { settings, ..self.0.job.clone() }
    }

    /// How picture files are written.
    pub fn output(&self) -> &OutputSpec {
        &self.0.delivery
    }

    /// The checkpoint file.
    pub fn checkpoint(&self) -> Option<&Path> {
        self.0.checkpoint.as_deref()
    }

    /// How particles are framed and lit.
    pub fn studio(&self) -> &StudioOptions {
        &self.0.studio
    }

    /// The options that decide how particles look, rather than what surrounds them: two renders for
    /// which they are equal can share particles.
    pub fn look(&self, changes: &[Override]) -> (Style, Vec<(String, String)>) {
        let overrides = self.0.overrides.iter().chain(changes);
        let of_particles = overrides.filter(|given| given.key.starts_with("particles"));
        let look = of_particles.map(|given| (given.key.clone(), given.value.clone()));
        (self.0.studio.style, look.collect())
    }
}

impl From<Import> for OpenedScene {
    fn from(import: Import) -> Self {
        let Import { text, scene, choices, mut notes } = import;
        notes.extend(scene.warnings());
        Self { file: scene, text: Some(text), notes, choices }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_option_is_listed_with_its_value() {
        let all = keywords();
        let named = |name: &str| all.iter().find(|keyword| keyword.name == name).unwrap();
        assert_eq!(named("spp").value.as_deref(), Some("N"));
        assert_eq!(named("ortho").value, None);
        assert!(named("colormap").help.contains("viridis"));
        assert_eq!(named("checkpoint-every").default.as_deref(), Some("60s"));
        let mut names: Vec<&str> = all.iter().map(|keyword| &*keyword.name).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), all.len());
    }

    #[test]
    fn what_is_wrong_with_an_option_is_one_sentence() {
        let words = |text: &str| KeywordRender::parse(&[text.to_owned()]).err().unwrap();
        assert!(words("--noise=5").starts_with("invalid value '5' for '--noise <ERROR>'"));
        assert!(!words("--sppp=5").contains('\n'), "{}", words("--sppp=5"));
    }
}
