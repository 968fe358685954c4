//! The commands of a plan: one for each shard, and the merge.

use std::path::Path;

use crate::cli::args::{Division, OutputArgs, PlanArgs};
use crate::cli::outputs::is_part;
use crate::cli::particle_file::ParticleFile;
use crate::color::ViewTransform;
use crate::error::{Error, Result};
use crate::scene::{Override, Settings};

use super::shards::{self, Shard};

/// The commands of a distributed render.
pub(super) struct ShardPlan {
    /// The name of the plan: that of the scene.
    pub(super) name: String,
    pub(super) scene: String,
    /// The files of the merged picture.
    pub(super) outputs: Vec<String>,
    pub(super) division: Division,
    pub(super) shards: Vec<Shard>,
    /// Options that all shards share.
    pub(super) options: Vec<String>,
    /// Options of the merge.
    pub(super) merge_options: Vec<String>,
}

impl ShardPlan {
    /// Plans the render. `accel` names the intersector of all shards.
    ///
    /// # Errors
    /// If there are more shards than work to divide, or a file name is not UTF-8 text.
    pub(super) fn new(
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
        let mut options = options(args, division, settings, accel);
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
    pub(super) fn render(&self, shard: &str) -> Vec<String> {
        let mut words = vec!["render".to_owned(), self.scene.clone()];
        words.extend(self.options.iter().cloned());
        words.extend([format!("--{}", self.option()), shard.to_owned()]);
        words.extend(["-o".to_owned(), self.part(shard), "--quiet".to_owned()]);
        words
    }

    /// Returns the arguments of the command that merges all parts.
    pub(super) fn merge(&self) -> Vec<String> {
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
fn options(args: &PlanArgs, division: Division, settings: &Settings, accel: &str) -> Vec<String> {
    let overrides = args.overrides();
    let is_replaced = |key: &str| division == Division::Crop && key == "image.crop";
    let kept = overrides.iter().filter(|given| !is_replaced(&given.key));
    let mut given: Vec<&[String]> = kept.map(Override::option).collect();
    given.dedup(); // --size sets two keys
    let mut words = given.concat();
    words.extend(args.studio.to_arguments());
    let mut add = |name: &str, value: String| words.extend([name.to_owned(), value]);
    if let Some(noise) = args.stop.noise {
        add("--noise", noise.to_string());
        add("--confidence", args.stop.confidence.to_string());
    }
    if let Some(quality) = args.stop.quality {
        add("--quality", quality.name().to_owned());
        add("--max-spp", args.stop.max_spp.to_string());
        let ViewTransform { exposure, tone, .. } = args.output.look();
        add("--tone", tone.name().to_owned());
        add("--exposure", exposure.to_string());
    }
    let has_samples = args.stop.has_target() || args.picture.has_samples();
    if division == Division::Crop
        && !has_samples
        && ParticleFile::is_one(&args.scene.path, &overrides)
    {
        // Without a number, each crop of a particle file would be rendered until it is good.
        add("--spp", settings.render.samples_per_pixel.to_string());
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
