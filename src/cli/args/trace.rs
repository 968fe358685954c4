//! The options of `photosphere trace`.

use std::path::PathBuf;

use clap::Args;

use crate::scene::Override;

use super::accel::AccelArg;
use super::picture::PictureArgs;
use super::scene::SceneArgs;
use super::studio::StudioArgs;
use super::values::pixel;

/// Explain one path step by step, and draw it
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  photosphere trace scenes/paper/fig2.toml --pixel 320,240
  photosphere trace scenes/cornell-spheres.toml --pixel 200,330 --svg path.svg
  photosphere trace fig2.toml --pixel 320,240 --integrator paper --json

The path is the one that `render` traces with the same options: the same random numbers and bit-identical
light. The symbols are those of the rendering equation

  L_o = L_e + integral of f_r L_i |cos| over the sphere of directions

x_k is vertex k of the path, p the pdf of a direction (per solid angle), w the weight of multiple
importance sampling, and T the throughput: the product of f_r |cos| / p and of tau so far. tau is the
transmittance of a medium along one segment: of the path, where T includes it, or towards a light.
V is that of translucent surfaces on the way to a light, t_ball what a connection loses at its ball,
and L_e includes the opacity of the emitter. A shadow catcher shows L, what is behind everything, if
the light that it asks for arrives. Each line that begins with `+` adds light to the sample; their sum
is L_o at the camera.

The drawing shows the path from the side, on the upright plane in which it is largest, and names the
spheres that the path hits or samples. Shadow rays are solid if they reach the emitter; if something
is in the way, they are dashed and end there, with a cross.")]
pub struct TraceArgs {
    #[command(flatten)]
    pub scene: SceneArgs,

    /// The pixel, counted from 0 at the upper left
    #[arg(long, value_name = "X,Y", value_parser = pixel)]
    pub pixel: (u32, u32),

    /// The sample of that pixel, counted from 0
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub sample: u32,

    /// Draw the path to this .svg file
    #[arg(long, value_name = "FILE.svg")]
    pub svg: Option<PathBuf>,

    #[command(flatten)]
    pub accel: AccelArg,

    #[command(flatten)]
    picture: PictureArgs,

    /// Print one JSON object
    #[arg(long)]
    pub json: bool,

    // Last, because its heading holds for all options behind it.
    #[command(flatten)]
    pub studio: StudioArgs,
}

impl TraceArgs {
    /// Returns the overrides of the scene. `--set` comes last and wins.
    pub fn overrides(&self) -> Vec<Override> {
        self.picture.overrides(&self.scene)
    }
}
