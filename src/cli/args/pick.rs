//! The options of `photosphere pick`.

use std::path::PathBuf;

use clap::Args;

/// Print the particle that a pixel of a picture shows, with all its columns
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  photosphere pick run.png 412 300
  photosphere pick run.exr 412 300 --json | jq .columns.c_pe

Pixels are counted from 0 at the upper left. The picture records its scene; the particle file must be
the one that it was made of.")]
pub struct PickArgs {
    /// The picture
    #[arg(value_name = "PICTURE")]
    pub picture: PathBuf,

    /// The column of the pixel
    #[arg(value_name = "X")]
    pub x: u32,

    /// The row of the pixel
    #[arg(value_name = "Y")]
    pub y: u32,

    /// The folder of the scene's files [default: that of the picture]
    #[arg(long, value_name = "DIR")]
    pub folder: Option<PathBuf>,

    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}
