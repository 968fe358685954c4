//! The squares of 16 x 16 pixels, on the grid of the full picture, that decide when they are done.

use crate::film::{Film, FilmFrame, PixelEstimate, TILE_SIZE};

use super::noise::TileNoise;

/// Side of a square in pixels.
const TILE_SIDE: u32 = 16;

/// Tiles of a square, one below the other.
const FILM_TILES: usize = (TILE_SIDE / TILE_SIZE[1]) as usize;

const _: () =
    assert!(TILE_SIZE[0] == TILE_SIDE && TILE_SIDE % TILE_SIZE[1] == 0, "tiles make up squares");

/// Which tiles make up which square of a film. At the edges squares may be smaller.
#[derive(Debug)]
pub(super) struct AdaptiveTiles {
    /// Tiles across, and so squares.
    across: usize,
    /// Rows of tiles.
    rows: usize,
    /// Rows of tiles that are missing above the first one, of the squares that it is in.
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

    /// The square that a tile belongs to.
    pub(super) fn containing(&self, tile: usize) -> usize {
        let (row, column) = (tile / self.across, tile % self.across);
        (self.first_row_offset + row) / FILM_TILES * self.across + column
    }

    /// The tiles of a square.
    fn film_tiles(&self, square: usize) -> impl Iterator<Item = usize> + use<> {
        let Self { across, rows, first_row_offset: cut_off } = *self;
        let (first, column) = (square / across * FILM_TILES, square % across);
        let rows = first.saturating_sub(cut_off)..(first + FILM_TILES - cut_off).min(rows);
        rows.map(move |row| row * across + column)
    }

    /// Pixels of a square.
    pub(super) fn pixels(&self, film: &Film, square: usize) -> u64 {
        self.film_tiles(square).map(|tile| film.frame().tile(tile).pixel_count() as u64).sum()
    }

    /// Whether every pixel of a square has exactly so many samples.
    pub(super) fn has_samples(&self, film: &Film, square: usize, samples: u32) -> bool {
        let mut counts = Vec::new();
        self.film_tiles(square).for_each(|tile| film.tile_counts(tile, &mut counts));
        counts.iter().all(|&count| count == samples)
    }

    /// What is known of a square's values.
    pub(super) fn noise(&self, film: &Film, square: usize) -> TileNoise {
        TileNoise::new(&self.estimates(film, square))
    }

    /// What is known of its pixels, tile after tile.
    pub(super) fn estimates(&self, film: &Film, square: usize) -> Vec<PixelEstimate> {
        let mut pixels = Vec::new();
        self.film_tiles(square).for_each(|tile| film.tile_estimates(tile, &mut pixels));
        pixels
    }

    /// The columns and rows of its pixels in the full picture, in the same order.
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
