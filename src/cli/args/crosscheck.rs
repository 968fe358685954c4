//! The options of `photosphere crosscheck`.

use std::path::PathBuf;

use clap::Args;

use super::accel::AccelsArg;
use super::scene::SceneArgs;
use super::values::seed;

/// Check every intersector against exact arithmetic, on rays of the scene
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  photosphere crosscheck scenes/cornell-spheres.toml
  photosphere crosscheck grains.toml --rays 3000 --dump wrong-rays.txt

A third each are rays of the camera, their bounces, and random rays at difficult places. `equal` and
`ambiguous` (within the rounding that the intersector states for itself) are right; anything else
makes the exit code 1: another sphere (wrong), none (lost) or one where there is none (ghosts), and a
wrong distance, side of the sphere or occlusion. More than 1 % of ambiguous answers to the rays of the
camera and their bounces is worth a warning: spheres are then too small for how far away they are.")]
pub struct CrosscheckArgs {
    #[command(flatten)]
    pub scene: SceneArgs,

    #[command(flatten)]
    pub accels: AccelsArg,

    /// Rays to trace, from 3 to 10 million; each is compared with every sphere of the scene
    #[arg(long, value_name = "N", default_value_t = 30_000)]
    #[arg(value_parser = clap::value_parser!(u32).range(3..=10_000_000))]
    pub rays: u32,

    /// Chooses the random rays
    #[arg(long, value_name = "S", default_value_t = 0)]
    #[arg(value_parser = seed())]
    pub seed: u64,

    /// Write the rays that were answered wrongly to a file
    #[arg(long, value_name = "FILE")]
    pub dump: Option<PathBuf>,
}
