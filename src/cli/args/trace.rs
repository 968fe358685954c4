//! The options of `photosphere trace`.

use std::path::PathBuf;

use clap::Args;

use crate::scene::Override;

use super::{AccelArg, SceneArgs, Size, size, whole};

/// Tell one path step by step, and draw it
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  photosphere trace scenes/paper/fig2.toml --pixel 320,240
  photosphere trace scenes/cornell-spheres.toml --pixel 200,330 --sample 7 --svg path.svg
  photosphere trace fig2.toml --pixel 320,240 --integrator paper --json | jq .radiance

The path is the very one that render takes there: same seed, same random numbers, same light to the
bit. It is told in the letters of the rendering equation

  L_o = L_e + integral of f_r L_i |cos| over the sphere of directions

x_k is the path's vertex number k, p the density of a direction (per solid angle), w the weight of
multiple importance sampling, and T the product of f_r |cos| / p so far. Each line that begins with
`+` adds light to the sample; their sum is the sample's L_o at the camera.

The drawing looks at the path from the side: upright, on the plane in which the path is largest.
Spheres that the path meets or aims at are named. Rays towards lamps are drawn through where they
arrive and dashed where something is in the way.")]
pub(in crate::cli) struct TraceArgs {
    #[command(flatten)]
    pub(in crate::cli) scene: SceneArgs,

    /// The pixel, counted from 0 at the upper left
    #[arg(long, value_name = "X,Y", value_parser = pixel)]
    pub(in crate::cli) pixel: (u32, u32),

    /// The sample of that pixel, counted from 0
    #[arg(long, value_name = "N", default_value_t = 0, allow_negative_numbers = true)]
    pub(in crate::cli) sample: u32,

    /// Draw the path
    #[arg(long, value_name = "FILE")]
    pub(in crate::cli) svg: Option<PathBuf>,

    #[command(flatten)]
    pub(in crate::cli) accel: AccelArg,

    /// The estimator of light
    #[arg(long, value_name = "NAME")]
    integrator: Option<String>,

    /// The size of the picture in pixels, as in 640x480
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<Size>,

    /// Chooses the random numbers
    #[arg(long, value_name = "S", value_parser = whole, allow_negative_numbers = true)]
    seed: Option<i128>,

    /// The longest path in edges
    #[arg(long, value_name = "D", value_parser = whole, allow_negative_numbers = true)]
    max_depth: Option<i128>,

    /// Print one JSON object
    #[arg(long)]
    pub(in crate::cli) json: bool,
}

impl TraceArgs {
    /// What the options change in the scene; `--set` has the last word.
    pub(in crate::cli) fn overrides(&self) -> Vec<Override> {
        let mut overrides = Vec::new();
        let mut set = |option: String, key: &str, value: String| {
            overrides.push(Override { option, key: key.to_owned(), value });
        };
        if let Some(name) = &self.integrator {
            set(format!("--integrator {name}"), "render.integrator", name.clone());
        }
        if let Some(size) = self.size {
            set(format!("--size {size}"), "image.width", size.width.to_string());
            set(format!("--size {size}"), "image.height", size.height.to_string());
        }
        let numbers = [
            ("--seed", "render.seed", self.seed),
            ("--max-depth", "render.max_depth", self.max_depth),
        ];
        for (option, key, number) in numbers {
            if let Some(number) = number {
                set(format!("{option} {number}"), key, number.to_string());
            }
        }
        overrides.extend(self.scene.overrides());
        overrides
    }
}

fn pixel(text: &str) -> Result<(u32, u32), String> {
    let read = || {
        let (x, y) = text.split_once(',')?;
        Some((x.trim().parse().ok()?, y.trim().parse().ok()?))
    };
    read().ok_or_else(|| "it must be X,Y, as in 320,240".to_owned())
}
