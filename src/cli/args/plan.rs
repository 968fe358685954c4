//! The options of `photosphere plan`.

use std::time::Duration;

use clap::{Args, ValueEnum};

use crate::scene::Override;

use super::accel::AccelArg;
use super::output::OutputArgs;
use super::picture::PictureArgs;
use super::scene::SceneArgs;
use super::stop::StopArgs;
use super::studio::StudioArgs;
use super::values::duration;

/// Print the commands of a sharded render: a script, or a job template for a render farm
#[derive(Args, Debug)]
#[command(mut_arg("files", |files| files.required(false).help(
    "The merged picture; the parts are written beside it. May be repeated [default: the name of the scene, with .exr]"
)))]
#[command(after_help = "\
Examples:
  photosphere plan fig2.toml --shards 4 --spp 1024 -o fig2.exr
  photosphere plan fig2.toml --shards 4 --spp 1024 -o fig2.exr | sh
  photosphere plan fig2.toml --shards 16 --noise 1% -o fig2.exr > fig2.sh
  photosphere plan fig2.toml --shards 16 --format slurm > job && bash job
  photosphere plan fig2.toml --shards 16 --format openjd > job && openjd run job

Shards may run in any order, concurrently, on any machines that share files, and repeatedly: each writes
a part that is its own checkpoint, so an interrupted shard resumes and a finished one does nothing.
The pixels of the merged picture are those of a single render; with --no-run-figures, so are the bytes
of the file. Shell and Slurm scripts run the program in the variable PHOTOSPHERE (default: photosphere);
a job template has the parameter Program.")]
pub struct PlanArgs {
    #[command(flatten)]
    pub scene: SceneArgs,

    /// The number of shards, up to 10000
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub shards: u32,

    /// What to print
    #[arg(long, value_name = "NAME", value_enum, default_value_t = PlanFormat::Shell)]
    pub format: PlanFormat,

    /// How to divide the render [default: samples; crop with --noise]
    #[arg(long, value_name = "WHAT", value_enum)]
    pub by: Option<Division>,

    #[command(flatten)]
    pub output: OutputArgs,

    #[command(flatten)]
    pub accel: AccelArg,

    #[command(flatten)]
    pub picture: PictureArgs,

    #[command(flatten)]
    pub stop: StopArgs,

    /// How often each shard saves its samples, such as 90s, 5m or 1h
    #[arg(long, value_name = "TIME", default_value = "60s", value_parser = duration, allow_hyphen_values = true)]
    pub checkpoint_every: Duration,

    // Last, because its heading holds for all options behind it.
    #[command(flatten)]
    pub studio: StudioArgs,
}

impl PlanArgs {
    /// Returns the overrides of the scene.
    pub fn overrides(&self) -> Vec<Override> {
        let most = self.stop.overrides(self.picture.has_samples());
        most.into_iter().chain(self.picture.overrides(&self.scene)).collect()
    }
}

/// Who is to read the plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum PlanFormat {
    /// One command per line, for a shell or for your own script
    Shell,
    /// A Slurm script that submits an array of one task per shard, and a merge that waits for it
    Slurm,
    /// A job template of the Open Job Description specification, as JSON
    Openjd,
}

/// How the work is divided.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Division {
    /// Sample ranges: equal work, and each part holds the whole picture
    Samples,
    /// Rectangles on the grid of 16 x 16 pixels: smaller parts, but unequal work
    Crop,
}
