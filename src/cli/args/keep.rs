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
    /// Keep the samples so far in this file, and go on from it where it is already there. Written
    /// at the end, too: `photosphere resume FILE --extend-to N` adds samples
    #[arg(long, value_name = "FILE")]
    pub checkpoint: Option<PathBuf>,

    /// How often the checkpoint is written, as in 90s, 5m or 1h; for -o FILE.part as well
    #[arg(long, value_name = "TIME", default_value = "60s", value_parser = duration, allow_hyphen_values = true)]
    pub checkpoint_every: Duration,
}

/// Go on with a render from its checkpoint or part
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  photosphere render fig2.toml -o fig2.exr --spp 4096 --checkpoint fig2.part
  photosphere resume fig2.part
  photosphere resume fig2.part --extend-to 16384 -o better.exr

All that decides the picture and its files is as in the interrupted command, but for what is given here.
A scene that has changed since is refused. A checkpoint may come from a stranger: a picture outside its
folder is written only where -o names it, and tev is shown the picture only with --tev.")]
pub struct ResumeArgs {
    /// The checkpoint, or the part
    #[arg(value_name = "FILE")]
    pub file: PathBuf,

    /// The picture, in place of the one that the interrupted command named, which must be in the
    /// folder of FILE; may be repeated
    #[arg(short = 'o', long = "output", value_name = "FILE")]
    pub outputs: Vec<PathBuf>,

    #[command(flatten)]
    pub stdout: StdoutArgs,

    /// Render this many samples of every pixel, also where all that were asked for are there; in
    /// place of --noise and --time
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub extend_to: Option<u32>,

    /// The scene file, where it is somewhere else now
    #[arg(long, value_name = "FILE")]
    pub scene: Option<PathBuf>,

    /// Keep a .png file of the picture so far [default: as before, in the folder of FILE]
    #[arg(long, value_name = "FILE")]
    pub preview: Option<PathBuf>,

    /// Show the picture so far in the viewer tev, which listens there
    #[arg(long, value_name = "HOST:PORT")]
    pub tev: Option<String>,

    /// How often the checkpoint is written [default: as before]
    #[arg(long, value_name = "TIME", value_parser = duration, allow_hyphen_values = true)]
    pub checkpoint_every: Option<Duration>,

    /// Threads to use [default: as before]
    #[arg(long, value_name = "T", value_parser = threads())]
    pub threads: Option<usize>,

    #[command(flatten)]
    pub memory: MemoryArg,

    /// Say nothing but warnings and errors
    #[arg(short, long)]
    pub quiet: bool,

    /// Print one JSON object with the figures of the render on the standard output
    #[arg(long)]
    pub json: bool,
}

/// Add up parts of a picture
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  photosphere render fig2.toml --samples 0..32 -o a.part
  photosphere render fig2.toml --samples 32..64 -o b.part
  photosphere merge a.part b.part -o fig2.exr
  photosphere merge a.part b.part -o both.part
  photosphere merge left.part right.part -o face.exr --crop 200,100,300,200

`photosphere plan` prints such commands for any number of shards. Parts are ranges of samples
(--samples), windows (--crop) or both, in any order. What comes out has the very bits of one render
without a break. Where parts did not meet their noise target, the picture is written, too, and the exit
code is 1.")]
pub struct MergeArgs {
    /// The parts; checkpoints are parts, too
    #[arg(value_name = "PART", required = true)]
    pub parts: Vec<PathBuf>,

    #[command(flatten)]
    pub output: OutputArgs,

    #[command(flatten)]
    pub stdout: StdoutArgs,

    /// The window that parts of several windows make together, where that is not the whole picture
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = window)]
    pub crop: Option<Rect>,

    /// Make a picture of what there is, also where pixels or samples are missing
    #[arg(long)]
    pub allow_gaps: bool,

    /// Say nothing but warnings and errors
    #[arg(short, long)]
    pub quiet: bool,
}
