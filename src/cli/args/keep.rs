//! The options of long renders: checkpoints, sample ranges, resuming and merging.

use std::path::PathBuf;
use std::time::Duration;

use clap::Args;

use crate::math::Rect;

use super::memory::MemoryArg;
use super::output::{OutputArgs, StdoutArgs};
use super::values::{duration, threads, window};

/// How a render is kept from being lost.
#[derive(Args, Debug)]
pub struct CheckpointArgs {
    /// Save the samples to this file periodically and when the render finishes, and resume from it
    /// if it exists. `photosphere resume FILE --extend-to N` adds samples
    #[arg(long, value_name = "FILE")]
    pub checkpoint: Option<PathBuf>,

    /// How often to save the checkpoint or -o FILE.part, such as 90s, 5m or 1h
    #[arg(long, value_name = "TIME", default_value = "60s", value_parser = duration, allow_hyphen_values = true)]
    pub checkpoint_every: Duration,
}

/// Resume an interrupted render, or add samples to a finished one
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  photosphere render fig2.toml -o fig2.exr --spp 4096 --checkpoint fig2.part
  photosphere resume fig2.part
  photosphere resume fig2.part --extend-to 16384 -o better.exr

The options of the interrupted command stay in force, including its output files and previews, unless
you override them here. A scene that has changed is refused. A checkpoint may come from a stranger: a
picture outside its folder is written only if -o names it, and tev is used only with --tev.")]
pub struct ResumeArgs {
    /// The checkpoint or part
    #[arg(value_name = "FILE")]
    pub file: PathBuf,

    /// The picture, instead of the one that the interrupted command named, which must be in the
    /// folder of FILE; may be repeated
    #[arg(short = 'o', long = "output", value_name = "FILE")]
    pub outputs: Vec<PathBuf>,

    #[command(flatten)]
    pub stdout: StdoutArgs,

    /// Render until every pixel has N samples, even if the render was finished; replaces --noise
    /// and --time
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub extend_to: Option<u32>,

    /// The scene file, if it has moved
    #[arg(long, value_name = "FILE")]
    pub scene: Option<PathBuf>,

    /// Update this .png file with the picture so far [default: as before, in the folder of FILE]
    #[arg(long, value_name = "FILE")]
    pub preview: Option<PathBuf>,

    /// Show the picture so far in the viewer tev at this address
    #[arg(long, value_name = "HOST:PORT")]
    pub tev: Option<String>,

    /// How often to save the checkpoint [default: as before]
    #[arg(long, value_name = "TIME", value_parser = duration, allow_hyphen_values = true)]
    pub checkpoint_every: Option<Duration>,

    /// Threads to use [default: as before]
    #[arg(long, value_name = "T", value_parser = threads())]
    pub threads: Option<usize>,

    #[command(flatten)]
    pub memory: MemoryArg,

    /// Print only warnings and errors
    #[arg(short, long)]
    pub quiet: bool,

    /// Print the statistics of the render as one JSON object on the standard output
    #[arg(long)]
    pub json: bool,
}

/// Merge parts into the picture of a single render
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  photosphere render fig2.toml --samples 0..32 -o a.part
  photosphere render fig2.toml --samples 32..64 -o b.part
  photosphere merge a.part b.part -o fig2.exr
  photosphere merge a.part b.part -o both.part
  photosphere merge left.part right.part -o face.exr --crop 200,100,300,200

`photosphere plan` prints such commands for any number of shards. Parts are sample ranges (--samples),
crops (--crop) or both, in any order. The merged pixels are bit-identical to those of a single render.
If a part did not reach its noise target, the picture is written anyway, and the exit code is 1.")]
pub struct MergeArgs {
    /// The parts; a checkpoint is a part, too
    #[arg(value_name = "PART", required = true)]
    pub parts: Vec<PathBuf>,

    #[command(flatten)]
    pub output: OutputArgs,

    #[command(flatten)]
    pub stdout: StdoutArgs,

    /// The crop that the parts cover together [default: that of one crop, or the whole picture]
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = window)]
    pub crop: Option<Rect>,

    /// Merge even if pixels or samples are missing
    #[arg(long)]
    pub allow_gaps: bool,

    /// Print only warnings and errors
    #[arg(short, long)]
    pub quiet: bool,
}
