//! Sums of a tile: a few neighbouring pixels.

use crate::color::{PathRadiance, VisibleSurface};
use crate::error::{Error, Result};
use crate::fault::fault;

use super::exact_sum::{ExactSum, U192, limit};
use super::layer::{Layer, RadianceScale, SampleRun};

/// Samples are summed in blocks of this many consecutive ones, in index order.
pub const BLOCK_SIZE: u32 = 16;

/// Number of colour channels whose squares are summed.
const COLOR: usize = 3;

/// Layout of the sums: one plane for every channel of every layer, with its step, and the squares
/// of the finished blocks of the beauty.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct FilmLayout {
    pub(super) scale: RadianceScale,
    pub(super) layers: Vec<Layer>,
    pub(super) squares: bool,
    steps: Vec<i32>,
    limits: Vec<f64>,
}

impl FilmLayout {
    pub(super) fn new(scale: RadianceScale, layers: &[Layer], squares: bool) -> Self {
        let steps: Vec<i32> = layers
            .iter()
            .flat_map(|layer| std::iter::repeat_n(layer.step(scale), layer.channels()))
            .collect();
        let limits = steps.iter().map(|&step| limit::<i128>(step)).collect();
        Self { scale, layers: layers.to_vec(), squares, steps, limits }
    }

    /// Number of 128-bit sums per pixel.
    pub(super) fn sum_count(&self) -> usize {
        self.steps.len()
    }

    /// Number of 192-bit sums per pixel.
    pub(super) fn square_count(&self) -> usize {
        if self.squares { COLOR } else { 0 }
    }

    /// Returns the plane of a layer's first channel.
    pub(super) fn first_plane(&self, layer: Layer) -> Option<usize> {
        let at = self.layers.iter().position(|kept| *kept == layer)?;
        Some(self.layers[..at].iter().map(|layer| layer.channels()).sum())
    }

    /// Returns the bytes per pixel without partial blocks.
    pub(super) fn bytes_per_pixel(&self) -> usize {
        let coverage = self.layers.contains(&Layer::Coverage);
        // Assumes that each pixel sees one sphere.
        let coverage = if coverage { size_of::<Vec<(u32, u32)>>() + 4 * 8 } else { 0 };
        let sums = self.sum_count() * size_of::<i128>() + self.square_count() * size_of::<U192>();
        size_of::<u32>() + sums + coverage
    }

    /// Adds each pixel's samples to its running sums.
    fn accumulate(&self, sums: &mut [f64], runs: &[SampleRun<'_>]) {
        let mut rest = sums;
        for layer in &self.layers {
            let (own, others) = rest.split_at_mut(layer.channels() * runs.len());
            layer.add(own, runs);
            rest = others;
        }
    }

    /// Returns the planes of direct and indirect light if their squares are summed.
    pub(super) fn square_planes(&self) -> Option<[usize; 2]> {
        let planes = [self.first_plane(Layer::Direct)?, self.first_plane(Layer::Indirect)?];
        self.squares.then_some(planes)
    }

    /// Returns true if all sums, plane after plane, are finite and below the limits.
    pub(super) fn fits(&self, sums: &[f64], pixels: usize) -> bool {
        let planes = sums.chunks_exact(pixels).zip(&self.limits);
        planes.into_iter().all(|(plane, limit)| plane.iter().all(|sum| sum.abs() < *limit))
    }

    fn is_finite(&self, light: &PathRadiance, seen: Option<&VisibleSurface>) -> bool {
        self.layers.iter().all(|layer| layer.is_finite(light, seen))
    }
}

/// A block that is too bright for the sums.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct BlockOverflow {
    pub(super) pixel: usize,
    pub(super) first_sample: u32,
    pub(super) value: f64,
    pub(super) limit: f64,
}

/// The sums of a tile, plane by plane.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Tile {
    /// Number of samples of each pixel, including non-finite ones.
    pub(super) counts: Vec<u32>,
    /// Sums of finished blocks. Empty before the first sample.
    pub(super) sums: Vec<i128>,
    /// Sums of squares of finished blocks.
    pub(super) sums_of_squares: Vec<U192>,
    /// Running sums of partial blocks; empty if no pixel has one.
    pub(super) partial_blocks: Vec<f64>,
    /// Number of non-finite samples of each pixel; empty if there are none.
    pub(super) non_finite_counts: Vec<u32>,
    /// How many samples of each pixel see each row first, ordered by row; empty if not counted.
    pub(super) coverage: Vec<Vec<(u32, u32)>>,
}

impl Tile {
    /// Creates an empty tile that reserves all memory needed for finished blocks. `None` if there
    /// is not enough.
    pub(super) fn new(plan: &FilmLayout, pixels: usize) -> Option<Self> {
        let mut tile = Self::new_lazy(pixels);
        tile.sums.try_reserve_exact(pixels * plan.sum_count()).ok()?;
        tile.sums_of_squares.try_reserve_exact(pixels * plan.square_count()).ok()?;
        Some(tile)
    }

    /// Creates an empty tile that allocates on demand.
    pub(super) fn new_lazy(pixels: usize) -> Self {
        Self { counts: vec![0; pixels], ..Self::default() }
    }

    /// Adds the next samples of all pixels: `counts` of each, one pixel after the other. On failure
    /// nothing is added from the block that does not fit onwards.
    pub(super) fn add(
        &mut self,
        plan: &FilmLayout,
        counts: &[u32],
        samples: SampleRun<'_>,
    ) -> std::result::Result<(), BlockOverflow> {
        self.allocate(plan);
        let mut rest = samples;
        let mut own: Vec<SampleRun<'_>> = counts
            .iter()
            .map(|&count| {
                let (own, others) = rest.split_at(count as usize);
                rest = others;
                own
            })
            .collect();
        // Fill up the block that each pixel is in, then continue.
        while own.iter().any(|samples| !samples.is_empty()) {
            let runs: Vec<SampleRun<'_>> = own
                .iter_mut()
                .zip(&self.counts)
                .map(|(samples, count)| {
                    let left = (BLOCK_SIZE - count % BLOCK_SIZE) as usize;
                    let (run, others) = samples.split_at(samples.len().min(left));
                    *samples = others;
                    run
                })
                .collect();
            self.add_runs(plan, &runs)?;
        }
        Ok(())
    }

    fn allocate(&mut self, plan: &FilmLayout) {
        let pixels = self.counts.len();
        self.sums.resize(pixels * plan.sum_count(), 0);
        self.sums_of_squares.resize(pixels * plan.square_count(), U192::default());
        if plan.layers.contains(&Layer::Coverage) {
            self.coverage.resize(pixels, Vec::new());
        }
    }

    /// Adds samples to every pixel, each within one block.
    fn add_runs(
        &mut self,
        plan: &FilmLayout,
        runs: &[SampleRun<'_>],
    ) -> std::result::Result<(), BlockOverflow> {
        let pixels = self.counts.len();
        let mut running = self.partial_blocks.clone();
        running.resize(pixels * plan.sum_count(), 0.0);
        plan.accumulate(&mut running, runs);
        if !plan.fits(&running, pixels) {
            let left_out = self.resum_finite(plan, &mut running, runs);
            self.check_limits(plan, &running)?;
            self.non_finite_counts.resize(pixels, 0);
            self.non_finite_counts
                .iter_mut()
                .zip(left_out)
                .for_each(|(total, more)| *total += more);
        }
        if fault!(FirstBlockDropped) {
            let is_first = |pixel: usize| self.counts[pixel % pixels] == 0;
            (0..running.len()).filter(|&at| is_first(at)).for_each(|at| running[at] = 0.0);
        }

        for (count, run) in self.counts.iter_mut().zip(runs) {
            *count += run.len() as u32;
        }
        for (rows, run) in self.coverage.iter_mut().zip(runs) {
            run.visible_surfaces.iter().for_each(|seen| add_coverage(rows, seen.row, 1));
        }
        // Finished blocks move to the sums; the others stay partial.
        let finished: Vec<bool> = runs
            .iter()
            .zip(&self.counts)
            .map(|(run, count)| !run.is_empty() && count % BLOCK_SIZE == 0)
            .collect();
        self.add_squares(plan, &running, &finished);
        let all_finished = finished.iter().all(|&finished| finished);
        let planes = running.chunks_exact_mut(pixels).zip(self.sums.chunks_exact_mut(pixels));
        for ((block, totals), &step) in planes.zip(&plan.steps) {
            if all_finished {
                add_all(block, totals, step);
            } else {
                move_finished(block, totals, &finished, step);
            }
        }
        self.partial_blocks = if all_finished { Vec::new() } else { running };
        Ok(())
    }

    /// Adds the squares of the finished blocks of the beauty.
    fn add_squares(&mut self, plan: &FilmLayout, blocks: &[f64], finished: &[bool]) {
        let Some([direct, indirect]) = plan.square_planes() else { return };
        let pixels = self.counts.len();
        let step = plan.scale.square_step();
        for (axis, totals) in self.sums_of_squares.chunks_exact_mut(pixels).enumerate() {
            let plane = |first: usize| &blocks[(first + axis) * pixels..][..pixels];
            let light = plane(direct).iter().zip(plane(indirect)).zip(finished);
            let squares = light.map(|((a, b), &finished)| {
                let light = if finished { a + b } else { 0.0 };
                light * light
            });
            add_each(squares, totals, step);
        }
    }

    /// Recomputes the running sums without the non-finite samples; returns their number for each
    /// pixel.
    fn resum_finite(
        &self,
        plan: &FilmLayout,
        running: &mut [f64],
        runs: &[SampleRun<'_>],
    ) -> Vec<u32> {
        running.fill(0.0);
        running[..self.partial_blocks.len()].copy_from_slice(&self.partial_blocks);
        let good = |run: &SampleRun<'_>| -> (Vec<PathRadiance>, Vec<VisibleSurface>) {
            let (light, seen) = (run.radiance, run.visible_surfaces);
            let is_good = |&at: &usize| plan.is_finite(&light[at], seen.get(at));
            let good: Vec<usize> = (0..run.len()).filter(is_good).collect();
            let seen = good.iter().filter_map(|&at| seen.get(at).copied());
            (good.iter().map(|&at| light[at]).collect(), seen.collect())
        };
        let good: Vec<_> = runs.iter().map(good).collect();
        let good: Vec<SampleRun<'_>> = good
            .iter()
            .map(|(light, seen)| SampleRun { radiance: light, visible_surfaces: seen })
            .collect();
        plan.accumulate(running, &good);
        runs.iter().zip(good).map(|(run, good)| (run.len() - good.len()) as u32).collect()
    }

    fn check_limits(
        &self,
        plan: &FilmLayout,
        running: &[f64],
    ) -> std::result::Result<(), BlockOverflow> {
        let pixels = self.counts.len();
        for (plane, &limit) in running.chunks_exact(pixels).zip(&plan.limits) {
            if let Some(pixel) = plane.iter().position(|sum| sum.abs() >= limit) {
                let first_sample = self.counts[pixel] / BLOCK_SIZE * BLOCK_SIZE;
                return Err(BlockOverflow { pixel, first_sample, value: plane[pixel], limit });
            }
        }
        Ok(())
    }

    /// Adds other samples of a pixel.
    ///
    /// # Errors
    /// If both have a partial block, and on overflow.
    pub(super) fn merge_pixel(
        &mut self,
        plan: &FilmLayout,
        pixel: usize,
        other: &Self,
        other_pixel: usize,
    ) -> Result<()> {
        let (pixels, other_pixels) = (self.counts.len(), other.counts.len());
        let at = |plane: usize| (plane * pixels + pixel, plane * other_pixels + other_pixel);
        if other.counts[other_pixel] == 0 {
            return Ok(());
        }
        let unfinished = other.counts[other_pixel] % BLOCK_SIZE != 0;
        if unfinished && self.counts[pixel] % BLOCK_SIZE != 0 {
            return Err(Error::input("two films have an unfinished block of the same pixel"));
        }
        self.allocate(plan);
        let mut overflows = false;
        for plane in 0..plan.sum_count() {
            let (to, from) = at(plane);
            let (sum, over) = self.sums[to].add_overflowing(other.sums[from]);
            self.sums[to] = sum;
            overflows |= over;
        }
        for plane in 0..plan.square_count() {
            let (to, from) = at(plane);
            let (sum, over) = self.sums_of_squares[to].add_overflowing(other.sums_of_squares[from]);
            self.sums_of_squares[to] = sum;
            overflows |= over;
        }
        if unfinished {
            self.partial_blocks.resize(pixels * plan.sum_count(), 0.0);
            for plane in 0..plan.sum_count() {
                let (to, from) = at(plane);
                self.partial_blocks[to] = other.partial_blocks[from];
            }
        }
        for &(row, count) in other.coverage.get(other_pixel).into_iter().flatten() {
            add_coverage(&mut self.coverage[pixel], row, count);
        }
        let left_out = other.non_finite_counts.get(other_pixel).copied().unwrap_or(0);
        if left_out > 0 {
            self.non_finite_counts.resize(pixels, 0);
            self.non_finite_counts[pixel] += left_out;
        }
        let (count, over) = self.counts[pixel].overflowing_add(other.counts[other_pixel]);
        self.counts[pixel] = count;
        match overflows || over {
            true => Err(Error::input("the sums of these films are too large to be added")),
            false => Ok(()),
        }
    }

    /// Returns the number of samples of a pixel that its sums contain.
    pub(super) fn finite_samples(&self, pixel: usize) -> u32 {
        self.counts[pixel] - self.non_finite_counts.get(pixel).copied().unwrap_or(0)
    }

    /// Returns the sum of one channel of a layer over a pixel's samples.
    pub(super) fn sum(&self, plan: &FilmLayout, plane: usize, pixel: usize) -> f64 {
        let at = plane * self.counts.len() + pixel;
        self.finished_sum(plan, plane, pixel) + self.partial_blocks.get(at).copied().unwrap_or(0.0)
    }

    /// Returns the sum of one channel of a layer over a pixel's finished blocks.
    pub(super) fn finished_sum(&self, plan: &FilmLayout, plane: usize, pixel: usize) -> f64 {
        let at = plane * self.counts.len() + pixel;
        self.sums.get(at).map_or(0.0, |sum| sum.to_f64(plan.steps[plane]))
    }

    /// Returns the sum of squares of a pixel's finished blocks, for one channel of the beauty.
    pub(super) fn sum_of_squares(&self, plan: &FilmLayout, axis: usize, pixel: usize) -> f64 {
        let pixels = self.counts.len();
        let finished = self.sums_of_squares.get(axis * pixels + pixel);
        finished.map_or(0.0, |sum| sum.to_f64(plan.scale.square_step()))
    }
}

/// Counts more samples that see a row.
fn add_coverage(rows: &mut Vec<(u32, u32)>, row: u32, more: u32) {
    match rows.binary_search_by_key(&row, |(row, _)| *row) {
        Ok(at) => rows[at].1 = rows[at].1.saturating_add(more),
        Err(at) => rows.insert(at, (row, more)),
    }
}

/// Adds the blocks of one plane to its sums.
fn add_all<S: ExactSum>(blocks: &[f64], totals: &mut [S], step: i32) {
    add_each(blocks.iter().copied(), totals, step);
}

/// Moves the finished blocks of one plane to its sums, leaving zeros in their place.
fn move_finished<S: ExactSum>(blocks: &mut [f64], totals: &mut [S], finished: &[bool], step: i32) {
    let taken = blocks
        .iter_mut()
        .zip(finished)
        .map(|(block, &finished)| if finished { std::mem::take(block) } else { 0.0 });
    add_each(taken, totals, step);
}

fn add_each<S: ExactSum>(values: impl Iterator<Item = f64>, totals: &mut [S], step: i32) {
    let mut overflows = false;
    for (total, value) in totals.iter_mut().zip(values) {
        let (sum, over) = total.add_overflowing(S::quantize(value, step));
        *total = sum;
        overflows |= over;
    }
    // The limits exclude overflow, and larger sums are rejected when reading files.
    debug_assert!(!overflows, "the limits leave room for every block");
}
