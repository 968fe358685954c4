//! What a film's sums make: means, their variance, and counts, for every pixel of the window.

use crate::color::Rgb;
use crate::fault::fault;
use crate::image_io::Picture;
use crate::math::Rect;
use crate::task::parallel;

use super::tile::Tile;
use super::{BLOCK_SIZE, Film, Layer};

impl Film {
    /// The mean of every pixel. A pixel without samples is black; one whose samples were all left out
    /// is not a number.
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

    /// The mean of a layer over every pixel's samples, along the rows; `None` for a layer that is not
    /// summed. Channels that the layer has not are 0.
    ///
    /// Of what is seen, depth and position are means over the samples that see something, for which
    /// alpha must be summed too; where none does, depth is infinite and the position 0.
    pub fn mean(&self, layer: Layer) -> Option<Vec<[f32; 3]>> {
        let plane = self.plan.first_plane(layer)?;
        let hits = match layer.is_hit_mean() {
            true => Some(self.plan.first_plane(Layer::Alpha)?),
            false => None,
        };
        Some(self.map_pixels(|sums, pixel| {
            let count = match hits {
                Some(hits) => sums.sum(&self.plan, hits, pixel),
                None => f64::from(divisor(sums.finite_samples(pixel))),
            };
            if count == 0.0 {
                let nowhere = if layer == Layer::Depth { f32::INFINITY } else { 0.0 };
                return [nowhere, 0.0, 0.0];
            }
            let mut mean = [0.0; 3];
            for (channel, mean) in mean.iter_mut().take(layer.channels()).enumerate() {
                *mean = (sums.sum(&self.plan, plane + channel, pixel) / count) as f32;
            }
            let lost = sums.finite_samples(pixel) == 0 && sums.counts[pixel] > 0;
            if lost { [f32::NAN; 3] } else { mean }
        }))
    }

    /// The variance of the mean of the beauty, per channel, from what finished blocks differ by. It is
    /// that of independent blocks; where those are spread evenly together, the error is smaller.
    /// Infinite for fewer than two finished blocks; `None` where squares are not summed.
    pub fn variance(&self) -> Option<Vec<[f32; 3]>> {
        let direct = self.plan.first_plane(Layer::Direct)?;
        let indirect = self.plan.first_plane(Layer::Indirect)?;
        let of_pixel = |sums: &Tile, pixel: usize| {
            let blocks = f64::from(sums.counts[pixel] / BLOCK_SIZE);
            let samples = f64::from(sums.finite_samples(pixel));
            std::array::from_fn(|axis| {
                if blocks < 2.0 {
                    return f32::INFINITY;
                }
                let plane = |first: usize| sums.finished_sum(&self.plan, first + axis, pixel);
                let sum = plane(direct) + plane(indirect);
                let squares = sums.sum_of_squares(&self.plan, axis, pixel);
                // Of the sum of a block, 16 times the variance of a sample.
                let of_block = (squares - sum * (sum / blocks)).max(0.0) / (blocks - 1.0);
                (of_block / f64::from(BLOCK_SIZE) / samples) as f32
            })
        };
        self.plan.squares.then(|| self.map_pixels(of_pixel))
    }

    /// How many samples of every pixel, along the rows, see which row of the scene first, in the order of
    /// the rows; `None` where that is not counted.
    pub fn coverage(&self) -> Option<Vec<Vec<(u32, u32)>>> {
        let of_pixel = |sums: &Tile, pixel: usize| sums.coverage.get(pixel).cloned();
        let is_counted = self.plan.layers.contains(&Layer::Coverage);
        is_counted.then(|| self.map_pixels(|sums, pixel| of_pixel(sums, pixel).unwrap_or_default()))
    }

    /// How many samples every pixel has, along the rows; those left out are among them.
    pub fn counts(&self) -> Vec<u32> {
        self.map_pixels(|sums, pixel| sums.counts[pixel])
    }

    /// Something of every pixel, along the rows of the window.
    fn map_pixels<T: Clone + Default + Send>(
        &self,
        of: impl Fn(&Tile, usize) -> T + Send + Sync,
    ) -> Vec<T> {
        let mut all = vec![T::default(); self.frame.pixel_count()];
        let width = self.frame.window.width as usize;
        let across = self.frame.tiles_across();
        // The pixels of each row of tiles lie together.
        let mut rest = all.as_mut_slice();
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
                let place = self.frame.tile(tile);
                let sums = self.lock(tile);
                let mut pixel = 0;
                for line in
                    row.chunks_exact_mut(width).take((place.y + place.height - top) as usize)
                {
                    let begin = (place.x - left) as usize;
                    for value in &mut line[begin..begin + place.width as usize] {
                        *value = of(&sums, pixel);
                        pixel += 1;
                    }
                }
            }
        });
        all
    }
}

/// What the sum of so many samples is divided by.
fn divisor(samples: u32) -> u32 {
    let samples = if fault!(DividedByWrongCount) { samples / 4 } else { samples };
    samples.max(1)
}
