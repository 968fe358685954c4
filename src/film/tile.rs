//! Sums of a tile of neighbouring pixels.

use crate::color::{PathRadiance, VisibleSurface};
use crate::error::{Error, Result};
use crate::fault::fault;

use super::exact_sum::{ExactSum, U192, limit};
use super::layer::{Layer, RadianceScale, SampleRun};

/// Number of consecutive samples in a block; each block is summed in index order.
pub const BLOCK_SIZE: u32 = 16;

/// Number of colour channels whose squares are summed.
const COLOR: usize = 3;

/// Layout of the sums: one plane for every channel of every layer, with its step, and the squares
/// of the finished blocks of the beauty.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct FilmLayout {
    pub(super) scale: RadianceScale,
    pub(super) layers: Vec<Layer>,
    pub(super) sums_squares: bool,
    steps: Vec<i32>,
    limits: Vec<f64>,
}

impl FilmLayout {
    pub(super) fn new(scale: RadianceScale, layers: &[Layer], sums_squares: bool) -> Self {
        let steps: Vec<i32> = layers
            .iter()
            .flat_map(|layer| std::iter::repeat_n(layer.step(scale), layer.channels()))
            .collect();
        let limits = steps.iter().map(|&step| limit::<i128>(step)).collect();
        Self { scale, layers: layers.to_vec(), sums_squares, steps, limits }
    }

    /// Number of 128-bit sums per pixel.
    pub(super) fn sum_count(&self) -> usize {
        self.steps.len()
    }

    /// Number of 192-bit sums per pixel.
    pub(super) fn square_count(&self) -> usize {
        if self.sums_squares { COLOR } else { 0 }
    }

    /// Returns the plane of a layer's first channel.
    pub(super) fn first_plane(&self, layer: Layer) -> Option<usize> {
        let index = self.layers.iter().position(|kept| *kept == layer)?;
        Some(self.layers[..index].iter().map(|layer| layer.channels()).sum())
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
        self.sums_squares.then_some(planes)
    }

    /// Returns true if all sums, plane after plane, are finite and below the limits.
    pub(super) fn fits(&self, sums: &[f64], pixels: usize) -> bool {
        let planes = sums.chunks_exact(pixels).zip(&self.limits);
        planes.into_iter().all(|(plane, limit)| plane.iter().all(|sum| sum.abs() < *limit))
    }

    fn is_finite(&self, radiance: &PathRadiance, surfaces: Option<&VisibleSurface>) -> bool {
        self.layers.iter().all(|layer| layer.is_finite(radiance, surfaces))
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
    /// Number of samples of each pixel whose first hit is each row, ordered by row; empty if not
    /// counted.
    pub(super) coverage: Vec<Vec<(u32, u32)>>,
}

impl Tile {
    /// Creates an empty tile that reserves all memory needed for finished blocks. `None` if there
    /// is not enough.
    pub(super) fn new(layout: &FilmLayout, pixels: usize) -> Option<Self> {
        let mut tile = Self::new_lazy(pixels);
        tile.sums.try_reserve_exact(pixels * layout.sum_count()).ok()?;
        tile.sums_of_squares.try_reserve_exact(pixels * layout.square_count()).ok()?;
        Some(tile)
    }

    /// Creates an empty tile that allocates on demand.
    pub(super) fn new_lazy(pixels: usize) -> Self {
        Self { counts: vec![0; pixels], ..Self::default() }
    }

    /// Adds the next samples of all pixels: `counts` of each, one pixel after the other. On failure
    /// the overflowing block and everything after it is not added.
    pub(super) fn add(
        &mut self,
        layout: &FilmLayout,
        counts: &[u32],
        samples: SampleRun<'_>,
    ) -> std::result::Result<(), BlockOverflow> {
        self.allocate(layout);
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
                    let remaining = (BLOCK_SIZE - count % BLOCK_SIZE) as usize;
                    let (run, others) = samples.split_at(samples.len().min(remaining));
                    *samples = others;
                    run
                })
                .collect();
            self.add_runs(layout, &runs)?;
        }
        Ok(())
    }

    fn allocate(&mut self, layout: &FilmLayout) {
        let pixels = self.counts.len();
        self.sums.resize(pixels * layout.sum_count(), 0);
        self.sums_of_squares.resize(pixels * layout.square_count(), U192::default());
        if layout.layers.contains(&Layer::Coverage) {
            self.coverage.resize(pixels, Vec::new());
        }
    }

    /// Adds samples to every pixel, each within one block.
    fn add_runs(
        &mut self,
        layout: &FilmLayout,
        runs: &[SampleRun<'_>],
    ) -> std::result::Result<(), BlockOverflow> {
        let pixels = self.counts.len();
        let mut running = self.partial_blocks.clone();
        running.resize(pixels * layout.sum_count(), 0.0);
        layout.accumulate(&mut running, runs);
        if !layout.fits(&running, pixels) {
            let non_finite = self.resum_finite(layout, &mut running, runs);
            self.check_limits(layout, &running)?;
            self.non_finite_counts.resize(pixels, 0);
            self.non_finite_counts
                .iter_mut()
                .zip(non_finite)
                .for_each(|(total, count)| *total += count);
        }
        if fault!(FirstBlockDropped) {
            let is_first = |pixel: usize| self.counts[pixel % pixels] == 0;
            (0..running.len())
                .filter(|&index| is_first(index))
                .for_each(|index| running[index] = 0.0);
        }

        for (count, run) in self.counts.iter_mut().zip(runs) {
            *count += run.len() as u32;
        }
        for (rows, run) in self.coverage.iter_mut().zip(runs) {
            run.visible_surfaces.iter().for_each(|surface| add_coverage(rows, surface.row, 1));
        }
        // Finished blocks move to the sums; the others stay partial.
        let finished: Vec<bool> = runs
            .iter()
            .zip(&self.counts)
            .map(|(run, count)| !run.is_empty() && count % BLOCK_SIZE == 0)
            .collect();
        self.add_squares(layout, &running, &finished);
        let all_finished = finished.iter().all(|&finished| finished);
        let planes = running.chunks_exact_mut(pixels).zip(self.sums.chunks_exact_mut(pixels));
        for ((block, totals), &step) in planes.zip(&layout.steps) {
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
    fn add_squares(&mut self, layout: &FilmLayout, blocks: &[f64], finished: &[bool]) {
        let Some([direct, indirect]) = layout.square_planes() else { return };
        let pixels = self.counts.len();
        let step = layout.scale.square_step();
        for (axis, totals) in self.sums_of_squares.chunks_exact_mut(pixels).enumerate() {
            let plane = |first: usize| &blocks[(first + axis) * pixels..][..pixels];
            let radiance = plane(direct).iter().zip(plane(indirect)).zip(finished);
            let squares = radiance.map(|((a, b), &finished)| {
                let radiance = if finished { a + b } else { 0.0 };
                radiance * radiance
            });
            add_each(squares, totals, step);
        }
    }

    /// Recomputes the running sums without the non-finite samples; returns their number for each
    /// pixel.
    fn resum_finite(
        &self,
        layout: &FilmLayout,
        running: &mut [f64],
        runs: &[SampleRun<'_>],
    ) -> Vec<u32> {
        running.fill(0.0);
        running[..self.partial_blocks.len()].copy_from_slice(&self.partial_blocks);
        let finite = |run: &SampleRun<'_>| -> (Vec<PathRadiance>, Vec<VisibleSurface>) {
            let (radiance, surfaces) = (run.radiance, run.visible_surfaces);
            let is_finite_sample =
                |&index: &usize| layout.is_finite(&radiance[index], surfaces.get(index));
            let finite: Vec<usize> = (0..run.len()).filter(is_finite_sample).collect();
            let surfaces = finite.iter().filter_map(|&index| surfaces.get(index).copied());
            (finite.iter().map(|&index| radiance[index]).collect(), surfaces.collect())
        };
        let finite: Vec<_> = runs.iter().map(finite).collect();
        let finite: Vec<SampleRun<'_>> = finite
            .iter()
            .map(|(radiance, surfaces)| SampleRun { radiance, visible_surfaces: surfaces })
            .collect();
        layout.accumulate(running, &finite);
        runs.iter().zip(finite).map(|(run, finite)| (run.len() - finite.len()) as u32).collect()
    }

    fn check_limits(
        &self,
        layout: &FilmLayout,
        running: &[f64],
    ) -> std::result::Result<(), BlockOverflow> {
        let pixels = self.counts.len();
        for (plane, &limit) in running.chunks_exact(pixels).zip(&layout.limits) {
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
        layout: &FilmLayout,
        pixel: usize,
        other: &Self,
        other_pixel: usize,
    ) -> Result<()> {
        let (pixels, other_pixels) = (self.counts.len(), other.counts.len());
        let index = |plane: usize| (plane * pixels + pixel, plane * other_pixels + other_pixel);
        if other.counts[other_pixel] == 0 {
            return Ok(());
        }
        let unfinished = other.counts[other_pixel] % BLOCK_SIZE != 0;
        if unfinished && self.counts[pixel] % BLOCK_SIZE != 0 {
            return Err(Error::input("both films have a partial block of the same pixel"));
        }
        self.allocate(layout);
        let mut overflows = false;
        for plane in 0..layout.sum_count() {
            let (target, source) = index(plane);
            let (sum, overflow) = self.sums[target].add_overflowing(other.sums[source]);
            self.sums[target] = sum;
            overflows |= overflow;
        }
        for plane in 0..layout.square_count() {
            let (target, source) = index(plane);
            let (sum, overflow) =
                self.sums_of_squares[target].add_overflowing(other.sums_of_squares[source]);
            self.sums_of_squares[target] = sum;
            overflows |= overflow;
        }
        if unfinished {
            self.partial_blocks.resize(pixels * layout.sum_count(), 0.0);
            for plane in 0..layout.sum_count() {
                let (target, source) = index(plane);
                self.partial_blocks[target] = other.partial_blocks[source];
            }
        }
        for &(row, count) in other.coverage.get(other_pixel).into_iter().flatten() {
            add_coverage(&mut self.coverage[pixel], row, count);
        }
        let non_finite = other.non_finite_counts.get(other_pixel).copied().unwrap_or(0);
        if non_finite > 0 {
            self.non_finite_counts.resize(pixels, 0);
            self.non_finite_counts[pixel] += non_finite;
        }
        let (count, overflow) = self.counts[pixel].overflowing_add(other.counts[other_pixel]);
        self.counts[pixel] = count;
        match overflows || overflow {
            true => Err(Error::input("the sums of these films are too large to be merged")),
            false => Ok(()),
        }
    }

    /// Returns the number of samples of a pixel that its sums contain.
    pub(super) fn finite_samples(&self, pixel: usize) -> u32 {
        self.counts[pixel] - self.non_finite_counts.get(pixel).copied().unwrap_or(0)
    }

    /// Returns the sum of one channel of a layer over a pixel's samples.
    pub(super) fn sum(&self, layout: &FilmLayout, plane: usize, pixel: usize) -> f64 {
        let index = plane * self.counts.len() + pixel;
        self.finished_sum(layout, plane, pixel)
            + self.partial_blocks.get(index).copied().unwrap_or(0.0)
    }

    /// Returns the sum of one channel of a layer over a pixel's finished blocks.
    pub(super) fn finished_sum(&self, layout: &FilmLayout, plane: usize, pixel: usize) -> f64 {
        let index = plane * self.counts.len() + pixel;
        self.sums.get(index).map_or(0.0, |sum| sum.to_f64(layout.steps[plane]))
    }

    /// Returns the sum of squares of a pixel's finished blocks, for one channel of the beauty.
    pub(super) fn sum_of_squares(&self, layout: &FilmLayout, axis: usize, pixel: usize) -> f64 {
        let pixels = self.counts.len();
        let finished = self.sums_of_squares.get(axis * pixels + pixel);
        finished.map_or(0.0, |sum| sum.to_f64(layout.scale.square_step()))
    }
}

/// Adds to the sample count of a row.
fn add_coverage(rows: &mut Vec<(u32, u32)>, row: u32, count: u32) {
    match rows.binary_search_by_key(&row, |(row, _)| *row) {
        Ok(index) => rows[index].1 = rows[index].1.saturating_add(count),
        Err(index) => rows.insert(index, (row, count)),
    }
}

/// Adds the blocks of one plane to its sums.
fn add_all<S: ExactSum>(blocks: &[f64], totals: &mut [S], step: i32) {
    add_each(blocks.iter().copied(), totals, step);
}

/// Moves the finished blocks of one plane to its sums, leaving zeros in their place.
fn move_finished<S: ExactSum>(blocks: &mut [f64], totals: &mut [S], finished: &[bool], step: i32) {
    let finished_blocks = blocks
        .iter_mut()
        .zip(finished)
        .map(|(block, &finished)| if finished { std::mem::take(block) } else { 0.0 });
    add_each(finished_blocks, totals, step);
}

fn add_each<S: ExactSum>(values: impl Iterator<Item = f64>, totals: &mut [S], step: i32) {
    let mut overflows = false;
    for (total, value) in totals.iter_mut().zip(values) {
        let (sum, overflow) = total.add_overflowing(S::quantize(value, step));
        *total = sum;
        overflows |= overflow;
    }
    // The limits exclude overflow, and reading rejects larger sums.
    debug_assert!(!overflows, "the limits leave room for every block");
}
