//! The options of `photosphere trace`.

use std::path::PathBuf;

use clap::Args;

use crate::scene::Override;

use super::accel::AccelArg;
use super::picture::PictureArgs;
use super::scene::SceneArgs;
use super::values::pixel;

/// Tell one path step by step, and draw it
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  photosphere trace scenes/paper/fig2.toml --pixel 320,240
  photosphere trace scenes/cornell-spheres.toml --pixel 200,330 --svg path.svg
  photosphere trace fig2.toml --pixel 320,240 --integrator paper --json

The path is the very one that render takes there with the same options: same seed, same random
numbers, same light to the bit. It is told in the letters of the rendering equation

  L_o = L_e + integral of f_r L_i |cos| over the sphere of directions

x_k is the path's vertex number k, p the density of a direction (per solid angle), w the weight of
multiple importance sampling, and T the product of f_r |cos| / p so far. V is what surfaces that are
not opaque let pass on the way to a light, tau what a medium does on a way that T has not counted yet,
and L_e is already multiplied with the emitter's opacity. Each line that begins with `+` adds light to
the sample; their sum is the sample's L_o at the camera.

The drawing looks at the path from the side: upright, on the plane in which the path is largest.
Spheres that the path meets or aims at are named. Rays towards emitters are drawn through where they
arrive and dashed where something is in the way.")]
pub struct TraceArgs {
    #[command(flatten)]
    pub scene: SceneArgs,

    /// The pixel, counted from 0 at the upper left
    #[arg(long, value_name = "X,Y", value_parser = pixel)]
    pub pixel: (u32, u32),

    /// The sample of that pixel, counted from 0
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub sample: u32,

    /// Draw the path into this .svg file
    #[arg(long, value_name = "FILE.svg")]
    pub svg: Option<PathBuf>,

    #[command(flatten)]
    pub accel: AccelArg,

    #[command(flatten)]
    picture: PictureArgs,

    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

impl TraceArgs {
    /// Returns the overrides of the scene. `--set` comes last and wins.
    pub fn overrides(&self) -> Vec<Override> {
        self.picture.overrides(&self.scene)
    }
}
