//! The options of `photosphere reproduce`.

use std::path::PathBuf;

use clap::Args;

use crate::accel::Backend;

use super::accel::backends;
use super::memory::MemoryArg;
use super::values::{count, threads};

/// Re-render a picture from the scene stored in it, and check that every pixel matches
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  photosphere reproduce fig2.png
  photosphere reproduce grains.exr --folder ~/simulation --accel native

The scene is in the picture. Its tables and images are read from where they were, or from --folder, and
must be unchanged. The exit code is 0 if all pixels are bit-identical and 1 otherwise. In that case,
`reproduce` prints what differs in how the two were made, and by how much they differ: in standard
errors for an .exr file, in steps of 255 for a .png file.

The picture of a stranger may name any scene and any number of samples. `reproduce` first prints how
many samples it takes. It refuses more than --max-samples, and what needs more memory than is free.")]
pub struct ReproduceArgs {
    /// A .png or .exr file written by photosphere
    #[arg(value_name = "PICTURE")]
    pub picture: PathBuf,

    /// The folder of the scene's tables and images [default: that of the scene file]
    #[arg(long, value_name = "FOLDER")]
    pub folder: Option<PathBuf>,

    /// The intersector [default: that of the picture]
    #[arg(long, value_name = "NAME", value_parser = backends())]
    pub accel: Option<Backend>,

    /// Render at most this many samples, counted over all pixels, such as 1e12
    #[arg(long, value_name = "N", value_parser = count, default_value = "1e10")]
    pub max_samples: u64,

    #[command(flatten)]
    pub memory: MemoryArg,

    /// Threads to use [default: all cores that affinity and CPU quota allow]
    #[arg(long, value_name = "T", value_parser = threads())]
    pub threads: Option<usize>,

    /// Print only the result, warnings and errors
    #[arg(short, long)]
    pub quiet: bool,
}
