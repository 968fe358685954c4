//! The options of `photosphere denoise`.

use std::path::PathBuf;

use clap::Args;

use crate::image_io::PngDepth;

use super::output::LookArgs;
use super::values::{named, one_of};

/// Remove the noise of a finished picture with Intel Open Image Denoise
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  photosphere denoise fig2.exr -o clean.exr
  photosphere denoise fig2.exr -o clean.png --tone agx
  OIDN_DIR=/opt/oidn photosphere denoise fig2.exr -o clean.exr

The library must be installed: pip install pyoidn, a package of the system, or an unpacked release
that OIDN_DIR names. IN may be .exr, .hdr or .pfm. The layers denoising_albedo and denoising_normal of
an .exr file, which render writes with --denoise, keep edges and what is seen in mirrors and through
glass sharp; albedo and normal serve as well, but for those.

An .exr file keeps all layers of IN and gets the layer `denoised`; other formats show that layer. The
record says that the picture is biased: its values are guesses, and no error is known of them.")]
pub struct DenoiseArgs {
    /// The picture
    #[arg(value_name = "IN")]
    pub input: PathBuf,

    /// The new picture; its extension chooses the format
    #[arg(short = 'o', long = "output", value_name = "OUT")]
    pub output: PathBuf,

    #[command(flatten)]
    pub look: LookArgs,

    /// Bits per channel of .png files: 8 or 16
    #[arg(long, value_name = "N", value_parser = one_of(named::<PngDepth>()))]
    pub bits: Option<PngDepth>,

    /// Threads to use [default: all]
    #[arg(long, value_name = "T", value_parser = super::values::threads())]
    pub threads: Option<usize>,

    /// Print only warnings and errors
    #[arg(short, long)]
    pub quiet: bool,
}
