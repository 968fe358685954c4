//! The options of `photosphere info`.

use clap::Args;

use super::accel::AccelArg;
use super::memory::MemoryArg;
use super::scene::SceneArgs;

/// Say what is in a scene and what of it deserves attention, or how a picture was made
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  photosphere info scenes/cornell-spheres.toml
  photosphere info fig2.png
  photosphere info grains.toml --json | jq .spheres
  photosphere info grains.toml --memory-limit 8GiB

What comes first is the memory that a render will take with each intersector: from the lengths of the
tables and the scene alone, before anything is loaded.")]
pub struct InfoArgs {
    #[command(flatten)]
    pub scene: SceneArgs,

    #[command(flatten)]
    pub accel: AccelArg,

    #[command(flatten)]
    pub memory: MemoryArg,

    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}
