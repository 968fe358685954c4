//! Results of a film's sums: means, variances and counts for every pixel of the window.

use crate::color::Rgb;
use crate::fault::fault;
use crate::image_io::Picture;
use crate::math::Rect;
use crate::task::parallel;

use super::tile::Tile;
use super::{BLOCK_SIZE, Film, Layer};

impl Film {
    /// Returns the mean of every pixel. A pixel without samples is black; one with only non-finite
    /// samples is NaN.
    pub fn picture(&self) -> Picture {
        let color =
            |layer| self.mean(layer).unwrap_or_else(|| vec![[0.0; 3]; self.frame.pixel_count()]);
        let colors = |layer| color(layer).into_iter().map(Rgb::from_array).collect();
        Picture {
            width: self.frame.window.width as usize,
            height: self.frame.window.height as usize,
            direct: colors(Layer::Direct),
            indirect: colors(Layer::Indirect),
            alpha: self.mean(Layer::Alpha).map(|alpha| alpha.iter().map(|[a, ..]| *a).collect()),
            ..Picture::default()
        }
    }

    /// Returns the mean of a layer for every pixel, row by row; `None` if the layer is not summed.
    /// Missing channels are 0.
    ///
    /// Depth and position are means over the samples that hit a surface, which requires alpha to be
    /// summed too; if none does, depth is infinite and position is 0.
    pub fn mean(&self, layer: Layer) -> Option<Vec<[f32; 3]>> {
        let plane = self.layout.first_plane(layer)?;
        let hits = match layer.is_hit_mean() {
            true => Some(self.layout.first_plane(Layer::Alpha)?),
            false => None,
        };
        Some(self.map_pixels(|sums, pixel| {
            let count = match hits {
                Some(hits) => sums.sum(&self.layout, hits, pixel),
                None => f64::from(divisor(sums.finite_samples(pixel))),
            };
            if count == 0.0 {
                let no_hit = if layer == Layer::Depth { f32::INFINITY } else { 0.0 };
                return [no_hit, 0.0, 0.0];
            }
            let mut mean = [0.0; 3];
            for (channel, mean) in mean.iter_mut().take(layer.channels()).enumerate() {
                *mean = (sums.sum(&self.layout, plane + channel, pixel) / count) as f32;
            }
            let all_non_finite = sums.finite_samples(pixel) == 0 && sums.counts[pixel] > 0;
            if all_non_finite { [f32::NAN; 3] } else { mean }
        }))
    }

    /// Returns the variance of the beauty's mean, per channel, from the differences between
    /// finished blocks. This is the variance for independent blocks; for jointly stratified ones
    /// the error is smaller. Infinite for fewer than two finished blocks; `None` if the film sums
    /// no squares.
    pub fn variance(&self) -> Option<Vec<[f32; 3]>> {
        let direct = self.layout.first_plane(Layer::Direct)?;
        let indirect = self.layout.first_plane(Layer::Indirect)?;
        let of_pixel = |sums: &Tile, pixel: usize| {
            let blocks = f64::from(sums.counts[pixel] / BLOCK_SIZE);
            let samples = f64::from(sums.finite_samples(pixel));
            std::array::from_fn(|axis| {
                if blocks < 2.0 {
                    return f32::INFINITY;
                }
                let channel_sum =
                    |first: usize| sums.finished_sum(&self.layout, first + axis, pixel);
                let sum = channel_sum(direct) + channel_sum(indirect);
                let sum_of_squares = sums.sum_of_squares(&self.layout, axis, pixel);
                // Variance of a block's sum: 16 times the variance of a sample.
                let block_variance =
                    (sum_of_squares - sum * (sum / blocks)).max(0.0) / (blocks - 1.0);
                (block_variance / f64::from(BLOCK_SIZE) / samples) as f32
            })
        };
        self.layout.sums_squares.then(|| self.map_pixels(of_pixel))
    }

    /// Returns, for every pixel, row by row, the number of samples whose first hit is each row of
    /// the scene, ordered by row; `None` if coverage is not counted.
    pub fn coverage(&self) -> Option<Vec<Vec<(u32, u32)>>> {
        let of_pixel = |sums: &Tile, pixel: usize| sums.coverage.get(pixel).cloned();
        let is_counted = self.layout.layers.contains(&Layer::Coverage);
        is_counted.then(|| self.map_pixels(|sums, pixel| of_pixel(sums, pixel).unwrap_or_default()))
    }

    /// Returns the number of samples of every pixel, row by row, including non-finite ones.
    pub fn counts(&self) -> Vec<u32> {
        self.map_pixels(|sums, pixel| sums.counts[pixel])
    }

    /// Maps every pixel of the window, row by row.
    fn map_pixels<T: Clone + Default + Send>(
        &self,
        f: impl Fn(&Tile, usize) -> T + Send + Sync,
    ) -> Vec<T> {
        let mut values = vec![T::default(); self.frame.pixel_count()];
        let width = self.frame.window.width as usize;
        let across = self.frame.tiles_across();
        // The pixels of each row of tiles are contiguous.
        let mut rest = values.as_mut_slice();
        let mut rows = Vec::new();
        for first in (0..self.tiles.len()).step_by(across) {
            let height = self.frame.tile(first).height as usize;
            let (row, others) = rest.split_at_mut(height * width);
            rows.push((first, row));
            rest = others;
        }
        parallel::map(rows, |(first, row): (usize, &mut [T])| {
            let Rect { x: left, y: top, .. } = self.frame.tile(first);
            for tile in first..first + across {
                let rect = self.frame.tile(tile);
                let sums = self.lock(tile);
                let mut pixel = 0;
                for pixel_row in
                    row.chunks_exact_mut(width).take((rect.y + rect.height - top) as usize)
                {
                    let begin = (rect.x - left) as usize;
                    for target in &mut pixel_row[begin..begin + rect.width as usize] {
                        *target = f(&sums, pixel);
                        pixel += 1;
                    }
                }
            }
        });
        values
    }
}

/// Returns the divisor for the sum of `samples` samples.
fn divisor(samples: u32) -> u32 {
    let samples = if fault!(DividedByWrongCount) { samples / 4 } else { samples };
    samples.max(1)
}
