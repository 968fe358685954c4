//! The squares of 16 x 16 pixels, on the grid of the full picture, that adaptive sampling decides
//! on.

use crate::film::{Film, FilmFrame, PixelEstimate, TILE_SIZE};

use super::noise::TileNoise;

/// Side of a square in pixels.
const TILE_SIDE: u32 = 16;

/// Film tiles per square, stacked vertically.
const FILM_TILES: usize = (TILE_SIDE / TILE_SIZE[1]) as usize;

const _: () =
    assert!(TILE_SIZE[0] == TILE_SIDE && TILE_SIDE % TILE_SIZE[1] == 0, "tiles make up squares");

/// Maps film tiles to squares. Squares at the edges may be smaller.
#[derive(Debug)]
pub(super) struct AdaptiveTiles {
    /// Film tiles, and therefore squares, per row.
    across: usize,
    /// Rows of film tiles.
    rows: usize,
    /// Number of tile rows that the crop window cuts off the top of the first row of squares.
    first_row_offset: usize,
}

impl AdaptiveTiles {
    pub(super) fn new(frame: &FilmFrame) -> Self {
        let across = frame.tiles_across();
        let cut_off = (frame.window.y / TILE_SIZE[1]) as usize % FILM_TILES;
        Self { across, rows: frame.tile_count() / across, first_row_offset: cut_off }
    }

    pub(super) fn len(&self) -> usize {
        (self.first_row_offset + self.rows).div_ceil(FILM_TILES) * self.across
    }

    /// Index of the square that contains a film tile.
    pub(super) fn containing(&self, tile: usize) -> usize {
        let (row, column) = (tile / self.across, tile % self.across);
        (self.first_row_offset + row) / FILM_TILES * self.across + column
    }

    /// The film tiles of a square.
    fn film_tiles(&self, square: usize) -> impl Iterator<Item = usize> + use<> {
        let Self { across, rows, first_row_offset: cut_off } = *self;
        let (first, column) = (square / across * FILM_TILES, square % across);
        let rows = first.saturating_sub(cut_off)..(first + FILM_TILES - cut_off).min(rows);
        rows.map(move |row| row * across + column)
    }

    /// Number of pixels in a square.
    pub(super) fn pixels(&self, film: &Film, square: usize) -> u64 {
        self.film_tiles(square).map(|tile| film.frame().tile(tile).pixel_count() as u64).sum()
    }

    /// Returns true if every pixel of a square has exactly `samples` samples.
    pub(super) fn has_samples(&self, film: &Film, square: usize, samples: u32) -> bool {
        let mut counts = Vec::new();
        self.film_tiles(square).for_each(|tile| film.tile_counts(tile, &mut counts));
        counts.iter().all(|&count| count == samples)
    }

    /// Noise statistics of a square.
    pub(super) fn noise(&self, film: &Film, square: usize) -> TileNoise {
        TileNoise::new(&self.estimates(film, square))
    }

    /// Estimates of a square's pixels, tile by tile.
    pub(super) fn estimates(&self, film: &Film, square: usize) -> Vec<PixelEstimate> {
        let mut pixels = Vec::new();
        self.film_tiles(square).for_each(|tile| film.tile_estimates(tile, &mut pixels));
        pixels
    }

    /// Coordinates of a square's pixels in the full picture, in the order of [`Self::estimates`].
    pub(super) fn pixels_of(&self, film: &Film, square: usize) -> impl Iterator<Item = [u32; 2]> {
        self.film_tiles(square).flat_map(|tile| film.frame().tile(tile).pixel_coords())
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
            let squares = AdaptiveTiles::new(&frame);
            let mut seen = vec![0; frame.tile_count()];
            for square in 0..squares.len() {
                let tiles: Vec<usize> = squares.film_tiles(square).collect();
                let of = |tile: &usize| {
                    let place = frame.tile(*tile);
                    [place.x / TILE_SIDE, place.y / TILE_SIDE]
                };
                assert!(tiles.iter().all(|tile| of(tile) == of(&tiles[0])), "{window:?}");
                tiles.iter().for_each(|&tile| seen[tile] += 1);
                assert!(tiles.iter().all(|&tile| squares.containing(tile) == square));
            }
            assert!(seen.iter().all(|&times| times == 1), "{window:?}: {seen:?}");
        }
    }
}
