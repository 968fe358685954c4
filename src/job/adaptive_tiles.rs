//! The tiles of 16 x 16 pixels, on the grid of the full picture, that adaptive sampling decides on.
//! Each consists of several film tiles.

use crate::film::{Film, FilmFrame, PixelEstimate, TILE_SIZE};

use super::display_scale::DisplayScale;
use super::noise::TileNoise;

/// Side of an adaptive tile in pixels.
const TILE_SIDE: u32 = 16;

/// Film tiles per adaptive tile, stacked vertically.
const FILM_TILES: usize = (TILE_SIDE / TILE_SIZE[1]) as usize;

const _: () = assert!(
    TILE_SIZE[0] == TILE_SIDE && TILE_SIDE % TILE_SIZE[1] == 0,
    "film tiles fill adaptive tiles"
);

/// Maps film tiles to adaptive tiles. Tiles at the edges may be smaller.
#[derive(Debug)]
pub(super) struct AdaptiveTiles {
    /// Film tiles, and therefore adaptive tiles, per row.
    across: usize,
    /// Rows of film tiles.
    rows: usize,
    /// Number of film tile rows that the crop window cuts off the top of the first row of tiles.
    first_row_offset: usize,
}

impl AdaptiveTiles {
    pub(super) fn new(frame: &FilmFrame) -> Self {
        let across = frame.tiles_across();
        let first_row_offset = (frame.window.y / TILE_SIZE[1]) as usize % FILM_TILES;
        Self { across, rows: frame.tile_count() / across, first_row_offset }
    }

    pub(super) fn len(&self) -> usize {
        (self.first_row_offset + self.rows).div_ceil(FILM_TILES) * self.across
    }

    /// Index of the tile that contains a film tile.
    pub(super) fn containing(&self, film_tile: usize) -> usize {
        let (row, column) = (film_tile / self.across, film_tile % self.across);
        (self.first_row_offset + row) / FILM_TILES * self.across + column
    }

    /// The film tiles of a tile.
    fn film_tiles(&self, tile: usize) -> impl Iterator<Item = usize> + use<> {
        let Self { across, rows, first_row_offset } = *self;
        let (first, column) = (tile / across * FILM_TILES, tile % across);
        let rows = first.saturating_sub(first_row_offset)
            ..(first + FILM_TILES - first_row_offset).min(rows);
        rows.map(move |row| row * across + column)
    }

    /// Number of pixels in a tile.
    pub(super) fn pixels(&self, film: &Film, tile: usize) -> u64 {
        self.film_tiles(tile)
            .map(|film_tile| film.frame().tile(film_tile).pixel_count() as u64)
            .sum()
    }

    /// Returns true if every pixel of a tile has exactly `samples` samples.
    pub(super) fn has_samples(&self, film: &Film, tile: usize, samples: u32) -> bool {
        let mut counts = Vec::new();
        self.film_tiles(tile).for_each(|film_tile| film.tile_counts(film_tile, &mut counts));
        counts.iter().all(|&count| count == samples)
    }

    /// Noise statistics of a tile.
    pub(super) fn noise(
        &self,
        film: &Film,
        tile: usize,
        scale: Option<&DisplayScale>,
    ) -> TileNoise {
        TileNoise::new(&self.estimates(film, tile), scale)
    }

    /// Estimates of a tile's pixels, film tile by film tile.
    pub(super) fn estimates(&self, film: &Film, tile: usize) -> Vec<PixelEstimate> {
        let mut pixels = Vec::new();
        self.film_tiles(tile).for_each(|film_tile| film.tile_estimates(film_tile, &mut pixels));
        pixels
    }

    /// Coordinates of a tile's pixels in the full picture, in the order of [`Self::estimates`].
    pub(super) fn pixels_of(&self, film: &Film, tile: usize) -> impl Iterator<Item = [u32; 2]> {
        self.film_tiles(tile).flat_map(|film_tile| film.frame().tile(film_tile).pixel_coords())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Rect;

    #[test]
    fn every_tile_is_in_the_square_of_its_pixels() {
        for window in [
            Rect { x: 0, y: 0, width: 50, height: 37 },
            Rect { x: 5, y: 13, width: 40, height: 20 },
            Rect { x: 16, y: 20, width: 1, height: 1 },
            Rect { x: 33, y: 31, width: 3, height: 2 },
        ] {
            let frame = FilmFrame { full_size: [50, 37], window };
            let tiles = AdaptiveTiles::new(&frame);
            let mut seen = vec![0; frame.tile_count()];
            for tile in 0..tiles.len() {
                let film_tiles: Vec<usize> = tiles.film_tiles(tile).collect();
                let position = |film_tile: &usize| {
                    let rect = frame.tile(*film_tile);
                    [rect.x / TILE_SIDE, rect.y / TILE_SIDE]
                };
                assert!(
                    film_tiles
                        .iter()
                        .all(|film_tile| position(film_tile) == position(&film_tiles[0])),
                    "{window:?}"
                );
                film_tiles.iter().for_each(|&film_tile| seen[film_tile] += 1);
                assert!(film_tiles.iter().all(|&film_tile| tiles.containing(film_tile) == tile));
            }
            assert!(seen.iter().all(|&times| times == 1), "{window:?}: {seen:?}");
        }
    }
}
