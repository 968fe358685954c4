//! Error estimates of a film's means.

use super::{BLOCK_SIZE, Film};

/// Mean and variance of one pixel, from its finished blocks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PixelEstimate {
    /// Mean of the beauty, per channel.
    pub mean: [f64; 3],
    /// Variance of that mean, per channel, from the differences between blocks: unbiased for
    /// independent blocks, too large for jointly stratified ones.
    pub variance: [f64; 3],
    /// Number of blocks used.
    pub blocks: u32,
}

impl PixelEstimate {
    /// Returns true if the error is known: there are enough blocks to compare, and their values are
    /// finite.
    pub fn is_known(&self) -> bool {
        self.blocks >= 2 && self.mean.iter().all(|mean| mean.is_finite())
    }
}

impl Film {
    /// Appends the estimates of a tile's pixels, row by row, to `estimates`. Appends nothing if
    /// squares are not summed.
    pub fn tile_estimates(&self, tile: usize, estimates: &mut Vec<PixelEstimate>) {
        let Some([direct, indirect]) = self.layout.square_planes() else { return };
        let sums = self.lock(tile);
        estimates.extend((0..sums.counts.len()).map(|pixel| {
            let blocks = sums.counts[pixel] / BLOCK_SIZE;
            let [samples, count] = [f64::from(blocks * BLOCK_SIZE), f64::from(blocks)];
            let mut estimate = PixelEstimate { blocks, ..PixelEstimate::default() };
            for axis in 0..3 {
                let channel_sum =
                    |first: usize| sums.finished_sum(&self.layout, first + axis, pixel);
                let sum = channel_sum(direct) + channel_sum(indirect);
                let sum_of_squares = sums.sum_of_squares(&self.layout, axis, pixel);
                // Deviations of the block sums; dividing by the block size turns sums into means.
                let squared_deviations = (sum_of_squares - sum * (sum / count)).max(0.0);
                estimate.mean[axis] = sum / samples;
                let block = f64::from(BLOCK_SIZE);
                estimate.variance[axis] =
                    squared_deviations / (count - 1.0) / count / (block * block);
            }
            estimate
        }));
    }
}
