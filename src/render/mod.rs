//! Renders a scene on all threads.
//!
//! The picture is rendered in passes of one block of samples, and each pass in jobs of some pixels.
//! A pixel belongs to one job of a pass, and passes follow one another, so its samples are added in
//! index order whatever the threads do: the bits of the picture depend on the scene alone.

use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;

use crate::accel::{Accel, Cancel};
use crate::color::Radiance;
use crate::error::Result;
use crate::film::{BLOCK, Film, Picture, Pixel};
use crate::integrator::{self, Integrator, SampleAddress, Tally, Workspace, World};
use crate::scene::Scene;

/// Samples that a job aims to have in flight at once.
const BATCH: usize = 1024;

/// How to render.
pub struct RenderOptions<'a> {
    /// Set from elsewhere to stop early.
    pub cancel: Cancel,
    /// Called now and then, from any thread.
    pub progress: &'a (dyn Fn(Progress) + Sync),
}

/// How far a render is.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Samples finished.
    pub samples_done: u64,
    /// Samples asked for.
    pub samples_total: u64,
}

/// A rendered picture.
#[derive(Debug)]
pub struct Outcome {
    /// The picture.
    pub picture: Picture,
    /// Samples rendered.
    pub samples: u64,
    /// Rays traced, shadow rays included.
    pub rays: u64,
    /// Whether all samples were rendered.
    pub complete: bool,
    /// What the user should know about the picture.
    pub warnings: Vec<String>,
}

/// Renders the scene on the current rayon thread pool. Cancelled, it gives the picture so far.
///
/// # Errors
/// When there is no memory for the picture.
pub fn render(scene: &Scene, accel: &dyn Accel, options: &RenderOptions<'_>) -> Result<Outcome> {
    let window = scene.description().image.window();
    let mut film = Film::new(window.width as usize, window.height as usize)?;
    let renderer = Renderer {
        world: World { scene, accel, cancel: &options.cancel },
        integrator: integrator::of_scene(scene),
        options,
        samples_done: AtomicU64::new(0),
        samples_per_pixel: scene.description().render.samples_per_pixel,
    };
    let passes = (0..renderer.samples_per_pixel)
        .step_by(BLOCK as usize)
        .take_while(|_| !options.cancel.is_cancelled());
    let tally =
        passes.map(|first| renderer.pass(&mut film, first)).fold(Tally::default(), |a, b| a + b);
    let transparent = scene.description().background.transparent;
    let picture = if transparent { film.picture_with_alpha() } else { film.picture() };
    Ok(Outcome {
        samples: renderer.samples_done.load(Ordering::Relaxed),
        rays: tally.rays,
        complete: renderer.is_complete(),
        warnings: warnings(scene, &tally, &picture),
        picture,
    })
}

struct Renderer<'a> {
    world: World<'a>,
    integrator: Box<dyn Integrator>,
    options: &'a RenderOptions<'a>,
    samples_done: AtomicU64,
    samples_per_pixel: u32,
}

/// What a thread keeps between jobs.
#[derive(Default)]
struct Desk {
    workspace: Workspace,
    samples: Vec<SampleAddress>,
    radiance: Vec<Radiance>,
}

impl Renderer<'_> {
    /// Adds one block of samples, from `first` on, to every pixel.
    fn pass(&self, film: &mut Film, first: u32) -> Tally {
        let block = BLOCK.min(self.samples_per_pixel - first);
        let pixels_per_job = BATCH / block as usize;
        film.pixels_mut()
            .par_chunks_mut(pixels_per_job)
            .enumerate()
            .map_init(Desk::default, |desk, (job, pixels)| {
                self.job(desk, job * pixels_per_job, pixels, first..first + block)
            })
            .reduce(Tally::default, |a, b| a + b)
    }

    fn job(
        &self,
        desk: &mut Desk,
        first_pixel: usize,
        pixels: &mut [Pixel],
        block: std::ops::Range<u32>,
    ) -> Tally {
        let window = self.world.scene.description().image.window();
        let width = window.width as usize;
        let Desk { workspace, samples, radiance } = desk;
        samples.clear();
        for pixel in first_pixel..first_pixel + pixels.len() {
            let x = window.x + (pixel % width) as u32;
            let y = window.y + (pixel / width) as u32;
            samples.extend(block.clone().map(|sample| SampleAddress { x, y, sample }));
        }
        radiance.clear();
        radiance.resize(samples.len(), Radiance::default());
        let tally = self.integrator.estimate(self.world, samples, radiance, workspace);
        if self.options.cancel.is_cancelled() {
            return tally; // stopped half-way: what there is of these samples is not used
        }
        for (pixel, radiance) in pixels.iter_mut().zip(radiance.chunks(block.len())) {
            pixel.add_block(radiance);
        }
        self.report(samples.len() as u64);
        tally
    }

    fn report(&self, samples: u64) {
        let samples_done = self.samples_done.fetch_add(samples, Ordering::Relaxed) + samples;
        (self.options.progress)(Progress { samples_done, samples_total: self.samples_total() });
    }

    fn samples_total(&self) -> u64 {
        let window = self.world.scene.description().image.window();
        u64::from(window.width) * u64::from(window.height) * u64::from(self.samples_per_pixel)
    }

    fn is_complete(&self) -> bool {
        self.samples_done.load(Ordering::Relaxed) == self.samples_total()
    }
}

fn warnings(scene: &Scene, tally: &Tally, picture: &Picture) -> Vec<String> {
    let mut warnings = Vec::new();
    if scene.description().render.clamp_indirect.is_some() {
        let options = scene.description().render.biases().join(", ");
        warnings.push(format!("the picture is biased by {options}"));
    }
    if picture.non_finite() > 0 {
        let count = picture.non_finite();
        warnings.push(format!("{count} pixels are infinite or not a number: please report this"));
    }
    if tally.media_overflows > 0 {
        let count = tally.media_overflows;
        warnings.push(format!("{count} paths were inside more than 8 dielectric spheres at once"));
    }
    if tally.cut_off > 0 {
        let count = tally.cut_off;
        warnings.push(format!("{count} paths were cut off after 10000 edges, which loses light"));
    }
    warnings
}
