//! STAND-IN, to be replaced by the real room when merging: noise instead of light.
#![allow(missing_docs, reason = "thrown away when merging")]

use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;

use crate::accel::{Accel, Cancel};
use crate::color::Rgb;
use crate::error::Result;
use crate::film::Picture;
use crate::scene::Scene;

pub struct RenderOptions<'a> {
    pub cancel: Cancel,
    pub progress: &'a (dyn Fn(Progress) + Sync),
}

#[derive(Clone, Copy, Debug)]
pub struct Progress {
    pub samples_done: u64,
    pub samples_total: u64,
}

pub struct Outcome {
    pub picture: Picture,
    pub samples: u64,
    pub rays: u64,
    pub complete: bool,
    pub warnings: Vec<String>,
}

pub fn render(scene: &Scene, accel: &dyn Accel, options: &RenderOptions<'_>) -> Result<Outcome> {
    let image = scene.description().image;
    let (width, height) = (image.width as usize, image.height as usize);
    let (pixels, spp) = (width * height, u64::from(scene.description().render.samples_per_pixel));
    let mut light = vec![Rgb::ZERO; pixels];
    let done = AtomicU64::new(0);
    for sample in 0..spp {
        light.par_chunks_mut(256).enumerate().for_each(|(chunk, light)| {
            if options.cancel.is_cancelled() {
                return;
            }
            let mut hits = vec![crate::math::Hit::MISS; light.len()];
            let ray = scene.spheres().ask(&scene.camera().ray(0.5, 0.5));
            accel.closest(&vec![ray; light.len()], &mut hits);
            for (i, light) in light.iter_mut().enumerate() {
                let hash = (chunk * 256 + i) as u64 ^ sample.wrapping_mul(0x9e37_79b9_7f4a_7c15);
                *light += Rgb::splat((hash >> 40) as f32);
            }
            let n = light.len() as u64;
            let samples_done = done.fetch_add(n, Ordering::Relaxed) + n;
            let samples_total = spp * pixels as u64;
            (options.progress)(Progress { samples_done, samples_total });
        });
    }
    let samples = done.into_inner();
    Ok(Outcome {
        picture: Picture { width, height, direct: light, indirect: vec![Rgb::ZERO; pixels] },
        samples,
        rays: samples,
        complete: samples == spp * pixels as u64,
        warnings: Vec::new(),
    })
}
