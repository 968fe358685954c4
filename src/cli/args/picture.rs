//! The options that change what a picture shows, for every command that makes or plans one.

use clap::Args;

use crate::scene::Override;

use super::{SceneArgs, Size, size, whole};

/// What the picture is to be, where that is not what the scene says.
#[derive(Args, Debug)]
pub(in crate::cli) struct PictureArgs {
    /// What is computed: path, direct, ambient-occlusion, normals, paper or raycast
    #[arg(long, value_name = "NAME")]
    integrator: Option<String>,

    /// How lights are found: mis, light or bsdf
    #[arg(long, value_name = "NAME")]
    estimator: Option<String>,

    /// How random numbers are spread: sobol, independent or stratified
    #[arg(long, value_name = "NAME")]
    sampler: Option<String>,

    /// Samples per pixel, from 1
    #[arg(long, value_name = "N", value_parser = whole, allow_negative_numbers = true)]
    spp: Option<i128>,

    /// The size of the picture in pixels, as in 640x480
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<Size>,

    /// Render this part of the picture only: its first column and row, and the ones behind its last
    #[arg(long, value_name = "X0,Y0,X1,Y1")]
    crop: Option<String>,

    /// Chooses the random numbers; equal seeds give equal pictures
    #[arg(long, value_name = "S", value_parser = whole, allow_negative_numbers = true)]
    seed: Option<i128>,

    /// The longest path in edges: 1 sees lamps only, 2 adds direct light, 3 one bounce
    #[arg(long, value_name = "D", value_parser = whole, allow_negative_numbers = true)]
    max_depth: Option<i128>,
}

impl PictureArgs {
    /// Whether the number of samples is given.
    pub(in crate::cli) fn has_samples(&self) -> bool {
        self.spp.is_some()
    }

    /// What the options change in the scene; `--set` has the last word.
    pub(in crate::cli) fn overrides(&self, scene: &SceneArgs) -> Vec<Override> {
        let mut overrides = Vec::new();
        let mut set = |option: String, key: &str, value: String| {
            overrides.push(Override { option, key: key.to_owned(), value });
        };
        let names = [
            ("--integrator", "render.integrator", &self.integrator),
            ("--estimator", "render.estimator", &self.estimator),
            ("--sampler", "render.sampler", &self.sampler),
        ];
        for (option, key, name) in names {
            if let Some(name) = name {
                set(format!("{option} {name}"), key, name.clone());
            }
        }
        if let Some(Size { width, height }) = self.size {
            let option = format!("--size {width}x{height}");
            set(option.clone(), "image.width", width.to_string());
            set(option, "image.height", height.to_string());
        }
        if let Some(crop) = &self.crop {
            set(format!("--crop {crop}"), "image.crop", format!("[{crop}]"));
        }
        let numbers = [
            ("--spp", "render.samples_per_pixel", self.spp),
            ("--seed", "render.seed", self.seed),
            ("--max-depth", "render.max_depth", self.max_depth),
        ];
        for (option, key, number) in numbers {
            if let Some(number) = number {
                set(format!("{option} {number}"), key, number.to_string());
            }
        }
        overrides.extend(scene.overrides());
        overrides
    }
}
