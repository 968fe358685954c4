//! The options of `photosphere crosscheck`.

use std::path::PathBuf;

use clap::Args;

use super::accel::AccelsArg;
use super::scene::SceneArgs;
use super::values::seed;

/// Test every intersector against double-double arithmetic, on rays of the scene
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  photosphere crosscheck scenes/cornell-spheres.toml
  photosphere crosscheck grains.toml --rays 3000 --dump wrong-rays.txt

A third of the rays are camera rays, a third their bounces, and a third random rays at difficult
places. `equal` and `ambiguous` answers (within the rounding error that the intersector states) are
correct. Any other answer makes the exit code 1: another sphere (wrong), no sphere (lost), a sphere
where there is none (ghosts), or a wrong distance, side or occlusion. A warning is printed if more than
1 % of the answers to camera rays and bounces are ambiguous: the spheres are then too small for their
distance.")]
pub struct CrosscheckArgs {
    #[command(flatten)]
    pub scene: SceneArgs,

    #[command(flatten)]
    pub accels: AccelsArg,

    /// Rays to trace, from 3 to 10 million; each is compared with every sphere of the scene
    #[arg(long, value_name = "N", default_value_t = 30_000)]
    #[arg(value_parser = clap::value_parser!(u32).range(3..=10_000_000))]
    pub rays: u32,

    /// The seed of the random rays
    #[arg(long, value_name = "S", default_value_t = 0)]
    #[arg(value_parser = seed())]
    pub seed: u64,

    /// Write the rays with wrong answers to a file
    #[arg(long, value_name = "FILE")]
    pub dump: Option<PathBuf>,
}
