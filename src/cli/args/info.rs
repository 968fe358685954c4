//! The options of `photosphere info`.

use clap::Args;

use super::accel::AccelArg;
use super::memory::MemoryArg;
use super::scene::SceneArgs;

/// Summarise a scene (contents, memory, likely mistakes), a particle file, or a picture (how it was
/// made)
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  photosphere info scenes/cornell-spheres.toml
  photosphere info fig2.png
  photosphere info run.lammpstrj
  photosphere info beads.csv --columns
  photosphere info grains.toml --json | jq .spheres
  photosphere info grains.toml --memory-limit 8GiB

The memory plan comes first: what a render takes with each intersector, predicted from the scene file
and the lengths of its tables before anything is loaded.")]
pub struct InfoArgs {
    #[command(flatten)]
    pub scene: SceneArgs,

    #[command(flatten)]
    pub accel: AccelArg,

    #[command(flatten)]
    pub memory: MemoryArg,

    /// Read all rows of a particle file, for the least and the greatest number of each column and
    /// for the words in it
    #[arg(long)]
    pub columns: bool,

    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}
