//! What a film knows of the error of its means.

use super::{BLOCK_SIZE, Film};

/// What is known of one pixel from its finished blocks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PixelEstimate {
    /// The mean of the beauty, per channel.
    pub mean: [f64; 3],
    /// The variance of that mean, per channel, as the blocks differ: unbiased where blocks are
    /// independent of one another, too large where they are spread evenly together.
    pub variance: [f64; 3],
    /// Blocks behind both.
    pub blocks: u32,
}

impl PixelEstimate {
    /// Whether the error is known: there are blocks to compare, and numbers in them.
    pub fn is_known(&self) -> bool {
        self.blocks >= 2 && self.mean.iter().all(|mean| mean.is_finite())
    }
}

impl Film {
    /// What is known of the pixels of a tile, along the rows; added to `estimates`. Nothing where
    /// squares are not summed.
    pub fn tile_estimates(&self, tile: usize, estimates: &mut Vec<PixelEstimate>) {
        let Some([direct, indirect]) = self.plan.square_planes() else { return };
        let sums = self.lock(tile);
        estimates.extend((0..sums.counts.len()).map(|pixel| {
            let blocks = sums.counts[pixel] / BLOCK_SIZE;
            let [samples, count] = [f64::from(blocks * BLOCK_SIZE), f64::from(blocks)];
            let mut estimate = PixelEstimate { blocks, ..PixelEstimate::default() };
            for axis in 0..3 {
                let plane = |first: usize| sums.finished_sum(&self.plan, first + axis, pixel);
                let sum = plane(direct) + plane(indirect);
                let squares = sums.sum_of_squares(&self.plan, axis, pixel);
                // Of the sums of blocks; a mean over blocks has the mean over samples in it.
                let spread = (squares - sum * (sum / count)).max(0.0);
                estimate.mean[axis] = sum / samples;
                let block = f64::from(BLOCK_SIZE);
                estimate.variance[axis] = spread / (count - 1.0) / count / (block * block);
            }
            estimate
        }));
    }
}
