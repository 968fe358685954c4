//! Progressive rendering: fills a film pass by pass on all threads of the current pool.
//!
//! A pass renders the selected pixels up to the end of a block of samples, in tasks of several
//! tiles. The film is exact, so the picture is bit-identical for any order of pixels and any
//! assignment to threads.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

use crate::accel::Accel;
use crate::color::PathRadiance;
use crate::error::Result;
use crate::film::{BLOCK_SIZE, Film, SampleRun, TILE_SIZE};
use crate::integrator::{self, Integrator, RenderContext, RenderStats, SampleAddress, Workspace};
use crate::scene::PreparedScene;
use crate::task::CancelToken;

/// Target number of samples in flight per task.
const BATCH_SAMPLES: usize = 1024;

/// Renders samples into one film.
pub struct ProgressiveRenderer<'a> {
    context: RenderContext<'a>,
    integrator: Box<dyn Integrator>,
    film: &'a Film,
    counters: &'a Counters,
}

/// Counters of the work on a film, readable from any thread.
#[derive(Debug, Default)]
pub struct Counters {
    samples_done: AtomicU64,
    samples_total: AtomicU64,
    stats: Mutex<RenderStats>,
}

impl Counters {
    /// Counters for a film that will have `samples_total` samples.
    pub fn new(film: &Film, samples_total: u64) -> Self {
        let counts = Self::default();
        counts.samples_done.store(film.sample_count(), Ordering::Relaxed);
        counts.set_samples_total(samples_total);
        counts
    }

    /// Sets how many samples the film will have.
    pub fn set_samples_total(&self, total: u64) {
        self.samples_total.store(total, Ordering::Relaxed);
    }

    /// Render statistics so far.
    pub fn stats(&self) -> RenderStats {
        *self.stats.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Samples in the film so far.
    pub fn samples_done(&self) -> u64 {
        self.samples_done.load(Ordering::Relaxed)
    }

    /// Samples that the film will have.
    pub fn samples_total(&self) -> u64 {
        self.samples_total.load(Ordering::Relaxed)
    }

    fn add(&self, samples: u64, stats: RenderStats) {
        {
            let mut total = self.stats.lock().unwrap_or_else(PoisonError::into_inner);
            *total = *total + stats;
        }
        self.samples_done.fetch_add(samples, Ordering::Relaxed);
    }
}

/// Per-thread scratch memory, kept between tasks.
#[derive(Default)]
struct ThreadScratch {
    workspace: Workspace,
    samples: Vec<SampleAddress>,
    radiance: Vec<PathRadiance>,
    /// Sample count of each pixel, then the number of samples to add.
    counts: Vec<u32>,
}

impl<'a> ProgressiveRenderer<'a> {
    /// Renders into a film of the prepared scene, which may already have samples.
    pub fn new(
        prepared: &'a PreparedScene,
        accel: &'a dyn Accel,
        film: &'a Film,
        counts: &'a Counters,
        cancel: &'a CancelToken,
    ) -> Self {
        let context = RenderContext::new(prepared, accel, cancel);
        Self { context, integrator: integrator::create(prepared), film, counters: counts }
    }

    /// The film.
    pub fn film(&self) -> &'a Film {
        self.film
    }

    /// The counters.
    pub fn counters(&self) -> &'a Counters {
        self.counters
    }

    /// Renders the tiles selected by `include` up to sample `end` (exclusive), whatever their
    /// current sample counts. Returns true if complete. If cancelled, every tile ends at a whole
    /// block.
    ///
    /// # Errors
    /// If a pixel is too bright for the film.
    pub fn render_to_sample(
        &self,
        end: u32,
        include: &(dyn Fn(usize) -> bool + Sync),
    ) -> Result<bool> {
        let selected = (0..self.film.frame().tile_count()).filter(|&tile| include(tile)).collect();
        let selected = golden_ratio_order(selected);
        // The first sample that some pixel lacks.
        while let Some(next) = selected.iter().map(|&tile| self.next_sample(tile)).min() {
            if next >= end {
                return Ok(true);
            }
            self.render_pass(
                &selected,
                end.min((next / BLOCK_SIZE + 1).saturating_mul(BLOCK_SIZE)),
            )?;
            if self.cancel_token().is_cancelled() {
                return Ok(selected.iter().all(|&tile| self.next_sample(tile) >= end));
            }
        }
        Ok(true)
    }

    /// The token that cancels this work.
    pub fn cancel_token(&self) -> &'a CancelToken {
        self.context.cancel
    }

    /// The first sample that some pixel of a tile lacks.
    fn next_sample(&self, tile: usize) -> u32 {
        self.film.first_sample() + self.film.min_tile_samples(tile)
    }

    /// Renders tiles up to sample `end`. No tile is more than one block behind.
    fn render_pass(&self, tiles: &[usize], end: u32) -> Result<()> {
        let pending: Vec<usize> =
            tiles.iter().copied().filter(|&tile| self.next_sample(tile) < end).collect();
        let block = (end - 1) % BLOCK_SIZE + 1;
        let tiles_per_job = BATCH_SAMPLES / (TILE_SIZE[0] * TILE_SIZE[1] * block) as usize;
        pending
            .par_chunks(tiles_per_job.max(1))
            .try_for_each_init(ThreadScratch::default, |scratch, tiles| {
                self.render_tiles(scratch, tiles, end)
            })
    }

    fn render_tiles(&self, scratch: &mut ThreadScratch, tiles: &[usize], end: u32) -> Result<()> {
        if self.cancel_token().is_cancelled() {
            return Ok(());
        }
        let ThreadScratch { workspace, samples, radiance, counts } = scratch;
        samples.clear();
        counts.clear();
        let first = self.film.first_sample();
        for &tile in tiles {
            let begin = counts.len();
            self.film.tile_counts(tile, counts);
            for (count, [x, y]) in
                counts[begin..].iter_mut().zip(self.film.frame().tile(tile).pixel_coords())
            {
                let missing = first + *count..end;
                *count = missing.len() as u32;
                samples.extend(missing.map(|sample| SampleAddress { x, y, sample }));
            }
        }
        radiance.clear();
        radiance.resize(samples.len(), PathRadiance::default());
        workspace.record_visible_surfaces(
            self.film.format().layers.iter().any(|layer| layer.uses_visible_surface()),
        );
        let stats = self.integrator.estimate(self.context, samples, radiance, workspace);
        if self.cancel_token().is_cancelled() {
            return Ok(()); // the samples are incomplete
        }
        self.add_to_film(
            tiles,
            counts,
            SampleRun { radiance, visible_surfaces: workspace.visible_surfaces() },
        )?;
        self.counters.add(samples.len() as u64, stats);
        Ok(())
    }

    /// Adds the samples of several tiles to the film.
    fn add_to_film(&self, tiles: &[usize], counts: &[u32], samples: SampleRun<'_>) -> Result<()> {
        let (mut counts, mut samples) = (counts, samples);
        for &tile in tiles {
            let (tile_counts, other_counts) =
                counts.split_at(self.film.frame().tile(tile).pixel_count());
            let sample_count: u32 = tile_counts.iter().sum();
            let (values, rest) = samples.split_at(sample_count as usize);
            self.film.add(tile, tile_counts, values)?;
            (counts, samples) = (other_counts, rest);
        }
        Ok(())
    }
}

/// Orders the tiles in steps of about the golden ratio of their number, so that any consecutive run
/// of them is spread over the picture. The progress within a pass then predicts the rest of the
/// pass, even if the cost varies over the picture.
fn golden_ratio_order(tiles: Vec<usize>) -> Vec<usize> {
    let count = tiles.len();
    let has_common_factor = |step: usize| {
        let (mut a, mut b) = (step, count);
        while b > 0 {
            (a, b) = (b, a % b);
        }
        a > 1
    };
    let mut step = (count as f64 * 0.618_034) as usize;
    while step > 1 && has_common_factor(step) {
        step -= 1;
    }
    (0..count).map(|i| tiles[i * step.max(1) % count]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scattered_tiles_are_the_same_tiles_and_any_tenth_is_spread_over_all() {
        for count in [0, 1, 2, 3, 4, 12, 100, 1200, 4801] {
            let tiles = golden_ratio_order((0..count).collect());
            let mut sorted = tiles.clone();
            sorted.sort_unstable();
            assert!(sorted.into_iter().eq(0..count), "{count}");
        }
        let tiles = golden_ratio_order((0..4800).collect());
        for stretch in tiles.chunks(480) {
            let mean = stretch.iter().sum::<usize>() as f64 / 480.0;
            assert!((mean / 2400.0 - 1.0).abs() < 0.02, "{mean}");
        }
    }
}
