//! The options of `photosphere plan`.

use std::time::Duration;

use clap::{Args, ValueEnum};

use crate::scene::Override;

use super::accel::AccelArg;
use super::output::OutputArgs;
use super::picture::PictureArgs;
use super::scene::SceneArgs;
use super::stop::StopArgs;
use super::values::duration;

/// Print how to share a render out: the commands of its shards, or a job for a render farm
#[derive(Args, Debug)]
#[command(mut_arg("files", |files| files.required(false).help(
    "The merged picture; the parts lie beside it. May be repeated [default: named after the scene, .exr]"
)))]
#[command(after_help = "\
Examples:
  photosphere plan fig2.toml --shards 4 --spp 1024 -o fig2.exr
  photosphere plan fig2.toml --shards 4 --spp 1024 -o fig2.exr | sh
  photosphere plan fig2.toml --shards 16 --noise 1% -o fig2.exr > fig2.sh
  photosphere plan fig2.toml --shards 16 --format slurm > job && bash job
  photosphere plan fig2.toml --shards 16 --format openjd > job && openjd run job

Shards may run in any order, at once, on any machine that sees the same files, and again: each is
a part that is its own checkpoint, so a shard that was stopped goes on, and one that is finished has
nothing more to do. The merged picture has the bytes that one render without a break gives (with
--no-run-figures; without, the pixels). Shell and Slurm scripts run the program that the variable
PHOTOSPHERE names, `photosphere` where it is not set; a job template has the parameter Program.")]
pub struct PlanArgs {
    #[command(flatten)]
    pub scene: SceneArgs,

    /// How many shards, from 1
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub shards: u32,

    /// What to print
    #[arg(long, value_name = "NAME", value_enum, default_value_t = PlanFormat::Shell)]
    pub format: PlanFormat,

    /// What each shard is a part of [default: samples; crop with --noise]
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

    /// How often each shard keeps what it has, as in 90s, 5m or 1h
    #[arg(long, value_name = "TIME", default_value = "60s", value_parser = duration, allow_hyphen_values = true)]
    pub checkpoint_every: Duration,
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
    /// A script for Slurm that submits an array of shards, and the merge that waits for it
    Slurm,
    /// A job template of the Open Job Description specification, as JSON
    Openjd,
}

/// How the work is divided.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Division {
    /// The samples of each pixel: all shards take equally long, and each is the whole picture
    Samples,
    /// The pixels, in rectangles along the grid of 16 x 16: less to write, but of unequal cost
    Crop,
}
