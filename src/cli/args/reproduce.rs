//! The options of `photosphere reproduce`.

use std::path::PathBuf;

use clap::Args;

use crate::accel::Backend;

use super::accel::backends;
use super::memory::MemoryArg;
use super::values::{count, threads};

/// Render a picture again from what it says of itself, and compare
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  photosphere reproduce fig2.png
  photosphere reproduce grains.exr --folder ~/simulation --accel native

The scene is in the picture; its tables and images are looked for where they were, or in --folder, and
must have the values that they had. The exit code is 0 where all pixels agree to the bit, and 1 where
some do not; then it says what differs in how the two were made, and by how much they differ: in
standard errors for a .exr file, in steps of 255 for a .png file.

A picture of a stranger may name any scene and any number of samples. It says first how many samples
it takes, and more than --max-samples are refused, as is what needs more memory than is free.")]
pub struct ReproduceArgs {
    /// A .png or .exr file of this program
    #[arg(value_name = "PICTURE")]
    pub picture: PathBuf,

    /// Where the scene's tables and images are; by default where they were
    #[arg(long, value_name = "FOLDER")]
    pub folder: Option<PathBuf>,

    /// The intersector; by default the one that the picture was made with
    #[arg(long, value_name = "NAME", value_parser = backends())]
    pub accel: Option<Backend>,

    /// Render at most this many samples, counted over all pixels, as in 1e12
    #[arg(long, value_name = "N", value_parser = count, default_value = "1e10")]
    pub max_samples: u64,

    #[command(flatten)]
    pub memory: MemoryArg,

    /// Threads to use; all cores by default
    #[arg(long, value_name = "T", value_parser = threads())]
    pub threads: Option<usize>,

    /// Say nothing but the result, warnings and errors
    #[arg(short, long)]
    pub quiet: bool,
}
