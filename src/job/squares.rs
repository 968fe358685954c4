//! The squares of 16 x 16 pixels, on the grid of the full picture, that decide when they are done.

use crate::film::{Estimate, Film, Frame, TILE};

use super::noise::Square;

/// Side of a square in pixels.
const SIDE: u32 = 16;

/// Tiles of a square, one below the other.
const TILES: usize = (SIDE / TILE[1]) as usize;

const _: () = assert!(TILE[0] == SIDE && SIDE % TILE[1] == 0, "tiles make up squares");

/// Which tiles make up which square of a film. At the edges squares may be smaller.
#[derive(Debug)]
pub(super) struct Squares {
    /// Tiles across, and so squares.
    across: usize,
    /// Rows of tiles.
    rows: usize,
    /// Rows of tiles that are missing above the first one, of the squares that it is in.
    cut_off: usize,
}

impl Squares {
    pub(super) fn of(frame: &Frame) -> Self {
        let across = frame.tiles_across();
        let cut_off = (frame.window.y / TILE[1]) as usize % TILES;
        Self { across, rows: frame.tiles() / across, cut_off }
    }

    pub(super) fn len(&self) -> usize {
        (self.cut_off + self.rows).div_ceil(TILES) * self.across
    }

    /// The square that a tile belongs to.
    pub(super) fn of_tile(&self, tile: usize) -> usize {
        let (row, column) = (tile / self.across, tile % self.across);
        (self.cut_off + row) / TILES * self.across + column
    }

    /// The tiles of a square.
    fn tiles(&self, square: usize) -> impl Iterator<Item = usize> + use<> {
        let Self { across, rows, cut_off } = *self;
        let (first, column) = (square / across * TILES, square % across);
        let rows = first.saturating_sub(cut_off)..(first + TILES - cut_off).min(rows);
        rows.map(move |row| row * across + column)
    }

    /// Pixels of a square.
    pub(super) fn pixels(&self, film: &Film, square: usize) -> u64 {
        self.tiles(square).map(|tile| film.frame().tile(tile).pixels() as u64).sum()
    }

    /// Whether every pixel of a square has exactly so many samples.
    pub(super) fn is_at(&self, film: &Film, square: usize, samples: u32) -> bool {
        let mut counts = Vec::new();
        self.tiles(square).for_each(|tile| film.counts_of_tile(tile, &mut counts));
        counts.iter().all(|&count| count == samples)
    }

    /// What is known of a square's values.
    pub(super) fn read(&self, film: &Film, square: usize) -> Square {
        Square::new(&self.estimates(film, square))
    }

    /// What is known of its pixels, tile after tile.
    pub(super) fn estimates(&self, film: &Film, square: usize) -> Vec<Estimate> {
        let mut pixels = Vec::new();
        self.tiles(square).for_each(|tile| film.estimates_of_tile(tile, &mut pixels));
        pixels
    }

    /// The columns and rows of its pixels in the full picture, in the same order.
    pub(super) fn places(&self, film: &Film, square: usize) -> impl Iterator<Item = [u32; 2]> {
        self.tiles(square).flat_map(|tile| film.frame().tile(tile).places())
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
            let frame = Frame { full_size: [50, 37], window };
            let squares = Squares::of(&frame);
            let mut seen = vec![0; frame.tiles()];
            for square in 0..squares.len() {
                let tiles: Vec<usize> = squares.tiles(square).collect();
                let of = |tile: &usize| {
                    let place = frame.tile(*tile);
                    [place.x / SIDE, place.y / SIDE]
                };
                assert!(tiles.iter().all(|tile| of(tile) == of(&tiles[0])), "{window:?}");
                tiles.iter().for_each(|&tile| seen[tile] += 1);
                assert!(tiles.iter().all(|&tile| squares.of_tile(tile) == square));
            }
            assert!(seen.iter().all(|&times| times == 1), "{window:?}: {seen:?}");
        }
    }
}
