//! `photosphere plan`: prints the commands that distribute a render over several machines.
//!
//! A plan only prints. Its commands rely on `render -o FILE.part`: the file is written atomically,
//! is its own checkpoint, and does not change once it is finished. Any shard can therefore be run
//! again, and two copies of one shard at the same time do no harm.

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

/// The commands of a distributed render.
struct ShardPlan {
    /// The name of the plan: that of the scene.
    name: String,
    scene: String,
    /// The files of the merged picture.
    outputs: Vec<String>,
    division: Division,
    shards: Vec<Shard>,
    /// Options that all shards share.
    options: Vec<String>,
    /// Options of the merge.
    merge_options: Vec<String>,
}

/// Runs the command.
///
/// # Errors
/// If the scene has mistakes, if a file cannot be written or cannot hold the requested layers, if
/// there are more shards than work to divide, or if the parts could not be merged.
pub(super) fn run(args: &PlanArgs) -> Result<Exit> {
    let outputs = outputs(args);
    let files: Vec<_> = outputs.files.iter().map(|file| ("-o", file.as_path())).collect();
    refuse_duplicate_paths(&files)?;
    Outputs::new(&outputs.output_spec(), &outputs.kinds(), outputs.has_layers())?;
    let overrides = overrides(args);
    // Checks the tables without loading them: they may need more memory than this machine has.
    let file = on_threads(args.scene.threads(), || read_file(&args.scene.path, &overrides))?;
    let division = division(&args.stop, args.by)?;
    args.stop.stop_criteria().validate(&file.settings.render)?;
    // Two machines might choose differently, and their parts could not be merged.
    let backend = args.accel.choice.select_for_count(file.sphere_count() as usize).backend;
    let plan = ShardPlan::new(args, &outputs, division, &file.settings, backend.name())?;
    print::result(&match args.format {
        PlanFormat::Shell => script::shell(&plan)?,
        PlanFormat::Slurm => script::slurm(&plan)?,
        PlanFormat::Openjd => openjd::template(&plan)?,
    })?;
    Ok(Exit::Done)
}

/// Returns the overrides of the scene.
fn overrides(args: &PlanArgs) -> Vec<Override> {
    let most = args.stop.overrides(args.picture.has_samples());
    most.into_iter().chain(args.picture.overrides(&args.scene)).collect()
}

/// Returns the requested output files, or one named after the scene.
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

/// Returns how to divide the work.
fn division(stop: &StopArgs, asked: Option<Division>) -> Result<Division> {
    let refused = |message: &str, help: &str| Err(Error::input(message).with_help(help));
    match (stop.noise, stop.limit_option(), asked) {
        (_, Some(limit), _) => refused(
            &format!(
                "{limit} stops each shard after as many samples as its machine gets done, so the \
                 picture cannot be reproduced"
            ),
            "use --spp N or --noise ERROR; set a time limit in sbatch or in the render farm",
        ),
        (Some(_), None, Some(Division::Samples)) => refused(
            "--noise decides from all samples of a square, so sample ranges cannot be separate shards",
            "divide the pixels: --by crop",
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

    /// Returns the arguments of the command that renders a shard. `shard` is one of
    /// [`Self::shards`] as text, or a placeholder for it.
    fn render(&self, shard: &str) -> Vec<String> {
        let mut words = vec!["render".to_owned(), self.scene.clone()];
        words.extend(self.options.iter().cloned());
        words.extend([format!("--{}", self.option()), shard.to_owned()]);
        words.extend(["-o".to_owned(), self.part(shard), "--quiet".to_owned()]);
        words
    }

    /// Returns the arguments of the command that merges all parts.
    fn merge(&self) -> Vec<String> {
        let mut words = vec!["merge".to_owned()];
        words.extend(self.shards.iter().map(|shard| self.part(&shard.to_string())));
        words.extend(self.outputs.iter().flat_map(|file| ["-o".to_owned(), file.clone()]));
        words.extend(self.merge_options.iter().cloned());
        words.push("--quiet".to_owned());
        words
    }

    /// Returns the option of `render` that takes a shard.
    fn option(&self) -> &'static str {
        match self.division {
            Division::Samples => "samples",
            Division::Crop => "crop",
        }
    }

    /// Returns the file of a shard, next to the picture and named after the shard.
    fn part(&self, shard: &str) -> String {
        let first = Path::new(&self.outputs[0]);
        // The names differ for `a.exr` and `a.part`, because one may be a shard of the other.
        let stem = first.with_extension(if is_part(first) { "all" } else { "" });
        format!("{}.{}-{shard}.part", stem.display(), self.option())
    }
}

/// Returns the options that affect the picture, as the user wrote them, and the intersector by
/// name.
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

/// Returns a path as text, for scripts and templates. Nothing can mistake it for an option.
fn text(path: &Path) -> Result<String> {
    let text = path.to_str().ok_or_else(|| {
        Error::input(format!("the name `{}` is not UTF-8 text", path.display()))
            .with_help("plans need file names in UTF-8; rename the file")
    })?;
    Ok(if text.starts_with('-') { format!("./{text}") } else { text.to_owned() })
}

#[cfg(test)]
mod tests;
