//! Exact per-pixel sums of samples, so that order and grouping cannot change a bit of a picture.
//!
//! Sixteen consecutive samples of a pixel form a block and are added in index order, in f64.
//! Finished blocks are rounded once, to steps that the scene fixes ([`RadianceScale`]), and added
//! as integers: threads, passes, interruptions, sample ranges and windows of the picture may come
//! in any order. The last, partial block of a pixel is kept as a running sum, which the next sample
//! continues.
//!
//! Non-finite samples are left out and counted; a mean is over the others. A block that is too
//! bright for the sums is an error, never a wraparound.
//!
//! A film is shared by threads: every tile has its own lock, so a picture or a checkpoint can be
//! made while other threads add samples. Each pixel of a tile then reflects only complete calls of
//! [`Film::add`].

mod aov;
mod encoding;
mod estimate;
mod exact_sum;
mod frame;
mod layer;
mod means;
#[cfg(test)]
mod tests;
mod tile;

pub use aov::{AOVS, Aov, CryptomatteKind, MergeRule, required_layers};
pub use estimate::PixelEstimate;
pub use frame::{FilmFrame, TILE_SIZE};
pub use layer::{Layer, RadianceScale, SampleRun};
pub use tile::BLOCK_SIZE;

use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::error::{Error, Result, Suggestion};

use tile::{BlockOverflow, FilmLayout, Tile};

/// The format of a film.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FilmFormat {
    /// The pixels.
    pub frame: FilmFrame,
    /// Index of the first sample of every pixel, a multiple of [`BLOCK_SIZE`].
    pub first_sample: u32,
    /// Magnitude of the scene's radiance.
    pub scale: RadianceScale,
    /// The summed layers.
    pub layers: Vec<Layer>,
    /// True if squares are summed too, for error estimates.
    pub sums_squares: bool,
}

/// The sums of a picture.
#[derive(Debug)]
pub struct Film {
    frame: FilmFrame,
    first_sample: u32,
    layout: FilmLayout,
    tiles: Vec<Mutex<Tile>>,
}

impl Film {
    /// Creates an empty film.
    ///
    /// # Errors
    /// If there is not enough memory for it.
    pub fn new(format: &FilmFormat) -> Result<Self> {
        let FilmFormat { frame, first_sample, scale, ref layers, sums_squares } = *format;
        debug_assert!(first_sample % BLOCK_SIZE == 0);
        let layout = FilmLayout::new(scale, layers, sums_squares);
        let no_memory = || {
            let bytes = Self::bytes(format);
            Error::input(format!("not enough memory for a film of {bytes} bytes"))
                .with_help("render a smaller picture")
        };
        let mut tiles = Vec::new();
        tiles.try_reserve_exact(frame.tile_count()).map_err(|_| no_memory())?;
        for tile in 0..frame.tile_count() {
            let tile = Tile::new(&layout, frame.tile(tile).pixel_count()).ok_or_else(no_memory)?;
            tiles.push(Mutex::new(tile));
        }
        Ok(Self { frame, first_sample, layout, tiles })
    }

    /// Creates an empty film that allocates memory for sums on demand. Its frame must fit its full
    /// size.
    pub fn new_lazy(format: &FilmFormat) -> Self {
        let FilmFormat { frame, first_sample, scale, ref layers, sums_squares } = *format;
        let layout = FilmLayout::new(scale, layers, sums_squares);
        let tile = |tile| Mutex::new(Tile::new_lazy(frame.tile(tile).pixel_count()));
        Self { frame, first_sample, layout, tiles: (0..frame.tile_count()).map(tile).collect() }
    }

    /// Returns the bytes that such a film holds, except for partial blocks.
    pub fn bytes(format: &FilmFormat) -> usize {
        let layout = FilmLayout::new(format.scale, &format.layers, format.sums_squares);
        format.frame.pixel_count() * layout.bytes_per_pixel()
            + format.frame.tile_count() * size_of::<Tile>()
    }

    /// Returns a copy of the current state, in which every tile reflects only complete calls of
    /// [`Self::add`].
    #[must_use]
    pub fn snapshot(&self) -> Self {
        let tiles = (0..self.tiles.len()).map(|tile| Mutex::new(self.lock(tile).clone())).collect();
        let Self { frame, first_sample, ref layout, .. } = *self;
        Self { frame, first_sample, layout: layout.clone(), tiles }
    }

    /// Returns the format.
    pub fn format(&self) -> FilmFormat {
        FilmFormat {
            frame: self.frame,
            first_sample: self.first_sample,
            scale: self.layout.scale,
            layers: self.layout.layers.clone(),
            sums_squares: self.layout.sums_squares,
        }
    }

    /// Returns the pixels, divided into tiles.
    pub fn frame(&self) -> &FilmFrame {
        &self.frame
    }

    /// Returns the index of the first sample of every pixel.
    pub fn first_sample(&self) -> u32 {
        self.first_sample
    }

    /// Appends the sample counts of a tile's pixels, row by row, to `counts`.
    pub fn tile_counts(&self, tile: usize, counts: &mut Vec<u32>) {
        counts.extend_from_slice(&self.lock(tile).counts);
    }

    /// Returns the smallest sample count of a tile's pixels.
    pub fn min_tile_samples(&self, tile: usize) -> u32 {
        self.lock(tile).counts.iter().copied().min().unwrap_or(0)
    }

    /// Returns the sample count of a tile's pixels if all are equal.
    pub fn uniform_tile_samples(&self, tile: usize) -> Option<u32> {
        let counts = &self.lock(tile).counts;
        let first = counts.first().copied().unwrap_or(0);
        counts.iter().all(|count| *count == first).then_some(first)
    }

    /// Returns the smallest and the largest sample count of all pixels.
    pub fn sample_count_range(&self) -> (u32, u32) {
        (0..self.tiles.len()).fold((u32::MAX, 0), |(min, max), tile| {
            let counts = &self.lock(tile).counts;
            let all = || counts.iter().copied();
            (min.min(all().min().unwrap_or(min)), max.max(all().max().unwrap_or(0)))
        })
    }

    /// Adds the next samples of a tile's pixels: `counts` of each pixel, row by row, and `samples`
    /// in the same order.
    ///
    /// # Errors
    /// If a block is too bright for the sums. That block and later ones are not added.
    pub fn add(&self, tile: usize, counts: &[u32], samples: SampleRun<'_>) -> Result<()> {
        let added = self.lock(tile).add(&self.layout, counts, samples);
        added.map_err(|overflow| self.overflow_error(tile, overflow))
    }

    /// Adds another film of the same format, with other samples of some of these pixels.
    ///
    /// # Errors
    /// If `other` has pixels outside this film, if both have a partial block of the same pixel,
    /// or on overflow, which films of one scene cannot cause. This film is unusable afterwards.
    pub fn merge(&mut self, other: &Self) -> Result<()> {
        let window = self.frame.window;
        if other.layout != self.layout
            || other.frame.window.intersection(&window) != Some(other.frame.window)
        {
            return Err(Error::input("films of different formats cannot be merged"));
        }
        for other_tile in 0..other.tiles.len() {
            let other_rect = other.frame.tile(other_tile);
            // Tiles are aligned, so no tile of the other film overlaps two tiles of this one.
            let Some(own_tile) = self.frame.tile_containing([other_rect.x, other_rect.y]) else {
                continue;
            };
            let rect = self.frame.tile(own_tile);
            let (mut sums, other_sums) = (self.lock(own_tile), other.lock(other_tile));
            for (other_pixel, [x, y]) in other_rect.pixel_coords().enumerate() {
                let pixel = (y - rect.y) * rect.width + (x - rect.x);
                sums.merge_pixel(&self.layout, pixel as usize, &other_sums, other_pixel)?;
            }
        }
        Ok(())
    }

    /// Returns the total number of samples.
    pub fn sample_count(&self) -> u64 {
        let tile_samples =
            |tile| self.lock(tile).counts.iter().map(|&count| u64::from(count)).sum();
        (0..self.tiles.len()).map(|tile| -> u64 { tile_samples(tile) }).sum()
    }

    /// Returns the number of non-finite samples, which were left out, and one of their pixels.
    pub fn non_finite_samples(&self) -> Option<(u64, [u32; 2])> {
        let mut found = None;
        for tile in 0..self.tiles.len() {
            let sums = self.lock(tile);
            for (&count, pixel) in
                sums.non_finite_counts.iter().zip(self.frame.tile(tile).pixel_coords())
            {
                if count > 0 {
                    let (total, first) = found.unwrap_or((0, pixel));
                    found = Some((total + u64::from(count), first));
                }
            }
        }
        found
    }

    /// Locks a tile. Poisoning is ignored: a panic leaves the sums between two blocks, which is a
    /// valid state.
    fn lock(&self, tile: usize) -> MutexGuard<'_, Tile> {
        self.tiles[tile].lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn overflow_error(&self, tile: usize, overflow: BlockOverflow) -> Error {
        let BlockOverflow { pixel, first_sample, value, limit } = overflow;
        let [x, y] = self.frame.tile(tile).pixel_coords().nth(pixel).unwrap_or_default();
        let first = self.first_sample + first_sample;
        Error::input(format!(
            "samples {first} to {} of the pixel in column {x}, row {y} add up to {value:.1e}; the \
             film's limit is {limit:.1e}, 2^{} times the brightest light of the scene",
            first + BLOCK_SIZE - 1,
            layer::HEADROOM,
        ))
        .with_help(
            "a light may have been sampled with a tiny probability: use `estimator = \"mis\"`, or limit the \
             contribution of a path with `clamp_indirect`. Or a material may create energy, as classic \
             Phong (`normalized = false`) does: use another, or limit paths with `max_depth`. `max_depth` \
             and `clamp_indirect` bias the picture. To see which materials create energy",
        )
        .with_suggestion(Suggestion::Info, "")
    }
}
