//! `photosphere plan`: how to share a render out.
//!
//! A plan only prints. What it prints relies on `render -o FILE.part`: that file appears whole or
//! not at all, is its own checkpoint, and has nothing more done to it when it is finished. So any
//! shard may be run again, and two copies of one at once do no harm.

mod openjd;
mod script;
mod shards;

use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::scene::{Override, Settings, read_file};

use super::args::{Division, OutputArgs, PlanArgs, PlanFormat, StopArgs};
use super::exit::Exit;
use super::outputs::{Outputs, is_part, refuse_duplicate_paths};
use super::print;
use super::system::on_threads;
use shards::Shard;

/// The commands of a shared render.
struct ShardPlan {
    /// What to call it: the name of the scene.
    name: String,
    scene: String,
    /// The merged picture, in all its files.
    outputs: Vec<String>,
    division: Division,
    shards: Vec<Shard>,
    /// Options that all shards have in common.
    options: Vec<String>,
    /// Options of the merge.
    merge_options: Vec<String>,
}

/// # Errors
/// When the scene has mistakes, when a file cannot be written or has no place for what is asked,
/// when there is less to share out than there are shards, or when shards would not fit together.
pub(super) fn run(args: &PlanArgs) -> Result<Exit> {
    let outputs = outputs(args);
    let files: Vec<_> = outputs.files.iter().map(|file| ("-o", file.as_path())).collect();
    refuse_duplicate_paths(&files)?;
    Outputs::new(&outputs.output_spec(), &outputs.kinds(), outputs.has_layers())?;
    let overrides = overrides(args);
    // Its tables are looked at, but not read: that may take more memory than there is here.
    let file = on_threads(args.scene.threads(), || read_file(&args.scene.path, &overrides))?;
    let division = division(&args.stop, args.by)?;
    args.stop.stop_criteria().validate(&file.settings.render)?;
    // Two machines may choose differently, and their parts would not add up.
    let backend = args.accel.choice.select_for_count(file.sphere_count() as usize).backend;
    let plan = ShardPlan::new(args, &outputs, division, &file.settings, backend.name())?;
    print::result(&match args.format {
        PlanFormat::Shell => script::shell(&plan)?,
        PlanFormat::Slurm => script::slurm(&plan)?,
        PlanFormat::Openjd => openjd::template(&plan)?,
    })?;
    Ok(Exit::Done)
}

/// What the options change in the scene.
fn overrides(args: &PlanArgs) -> Vec<Override> {
    let most = args.stop.overrides(args.picture.has_samples());
    most.into_iter().chain(args.picture.overrides(&args.scene)).collect()
}

/// The files asked for, or one that is named after the scene.
fn outputs(args: &PlanArgs) -> OutputArgs {
    let mut outputs = args.output.clone();
    if outputs.files.is_empty() {
        let stem = args.scene.path.file_stem().unwrap_or_default();
        let mut name = stem.to_owned();
        name.push(".exr");
        outputs.files.push(PathBuf::from(name));
    }
    outputs
}

/// How the work can be divided.
fn division(stop: &StopArgs, asked: Option<Division>) -> Result<Division> {
    let refused = |message: &str, help: &str| Err(Error::input(message).with_help(help));
    match (stop.noise, stop.limit_option(), asked) {
        (_, Some(limit), _) => refused(
            &format!(
                "{limit} ends each shard wherever its machine is by then, so that no two plans make \
                 the same picture"
            ),
            "use --spp N or --noise ERROR; sbatch and render farms have limits of time of their own",
        ),
        (Some(_), None, Some(Division::Samples)) => refused(
            "--noise decides from all samples of a square when to stop, so they cannot be shared out",
            "share out the pixels: --by crop",
        ),
        (Some(_), None, _) => Ok(Division::Crop),
        (None, None, asked) => Ok(asked.unwrap_or(Division::Samples)),
    }
}

impl ShardPlan {
    fn new(
        args: &PlanArgs,
        outputs: &OutputArgs,
        division: Division,
        settings: &Settings,
        accel: &str,
    ) -> Result<Self> {
        let image = &settings.image;
        let shards = match division {
            Division::Samples => shards::by_samples(settings.render.samples_per_pixel, args.shards),
            Division::Crop => shards::by_crop(image.pixel_bounds(), args.shards),
        }?;
        let name = args.scene.path.file_stem().unwrap_or_default();
        let files: Result<Vec<String>> = outputs.files.iter().map(|file| text(file)).collect();
        let [of_parts, mut merge_options] = outputs.to_arguments();
        let mut options = options(args, division, accel);
        options.extend(of_parts);
        if let (Division::Crop, Some(crop)) = (division, image.crop) {
            merge_options.extend(["--crop".to_owned(), crop.to_string()]);
        }
        Ok(Self {
            name: text(Path::new(name))?,
            scene: text(&args.scene.path)?,
            outputs: files?,
            division,
            shards,
            options,
            merge_options,
        })
    }

    /// The words of the command that renders a shard, after the program's name; `shard` is one of
    /// [`Self::shards`] in words, or what stands for it.
    fn render(&self, shard: &str) -> Vec<String> {
        let mut words = vec!["render".to_owned(), self.scene.clone()];
        words.extend(self.options.iter().cloned());
        words.extend([format!("--{}", self.option()), shard.to_owned()]);
        words.extend(["-o".to_owned(), self.part(shard), "--quiet".to_owned()]);
        words
    }

    /// The words of the command that merges all parts.
    fn merge(&self) -> Vec<String> {
        let mut words = vec!["merge".to_owned()];
        words.extend(self.shards.iter().map(|shard| self.part(&shard.to_string())));
        words.extend(self.outputs.iter().flat_map(|file| ["-o".to_owned(), file.clone()]));
        words.extend(self.merge_options.iter().cloned());
        words.push("--quiet".to_owned());
        words
    }

    /// The option of `render` that a shard is the value of.
    fn option(&self) -> &'static str {
        match self.division {
            Division::Samples => "samples",
            Division::Crop => "crop",
        }
    }

    /// The file of a shard: beside the picture, named after what is in it.
    fn part(&self, shard: &str) -> String {
        let first = Path::new(&self.outputs[0]);
        // One name for `a.exr` and another for `a.part`, of which one may be a part of the other.
        let stem = first.with_extension(if is_part(first) { "all" } else { "" });
        format!("{}.{}-{shard}.part", stem.display(), self.option())
    }
}

/// The options that shape the picture, as the user wrote them, and the intersector by its name.
fn options(args: &PlanArgs, division: Division, accel: &str) -> Vec<String> {
    let overrides = overrides(args);
    let is_replaced = |key: &str| division == Division::Crop && key == "image.crop";
    let kept = overrides.iter().filter(|given| !is_replaced(&given.key));
    let mut given: Vec<&str> = kept.map(|given| given.option.as_str()).collect();
    given.dedup(); // --size sets two keys
    let mut words: Vec<String> = (given.into_iter())
        .filter_map(|option| option.split_once(' '))
        .flat_map(|(name, value)| [name.to_owned(), value.to_owned()])
        .collect();
    let mut add = |name: &str, value: String| words.extend([name.to_owned(), value]);
    if let Some(noise) = args.stop.noise {
        add("--noise", noise.to_string());
        add("--confidence", args.stop.confidence.to_string());
    }
    add("--accel", accel.to_owned());
    if args.accel.build.quality != Default::default() {
        add("--build", args.accel.build.quality.name().to_owned());
    }
    if let Some(threads) = args.scene.threads() {
        add("--threads", threads.to_string());
    }
    add("--checkpoint-every", format!("{}s", args.checkpoint_every.as_secs_f64()));
    words
}

/// A path as text, which scripts and templates are; never to be taken for an option.
fn text(path: &Path) -> Result<String> {
    let text = path.to_str().ok_or_else(|| {
        Error::input(format!("the name `{}` is not UTF-8 text", path.display()))
            .with_help("a plan can only name files whose names are; rename it")
    })?;
    Ok(if text.starts_with('-') { format!("./{text}") } else { text.to_owned() })
}

#[cfg(test)]
mod tests;
