//! The squares of 16 x 16 pixels, on the grid of the full picture, that decide when they are done.

use crate::film::{Estimate, Film, Frame};

use super::noise::Square;

/// Side of a square in pixels.
const SIDE: u32 = 16;

/// Which tiles make up which square of a film. At the edges squares may be smaller.
#[derive(Debug)]
pub(super) struct Squares {
    tiles: Vec<Vec<usize>>,
    of_tile: Vec<usize>,
}

impl Squares {
    pub(super) fn of(frame: &Frame) -> Self {
        let window = frame.window;
        let across = ((window.x + window.width).div_ceil(SIDE) - window.x / SIDE) as usize;
        let square = |tile: usize| {
            let place = frame.tile(tile);
            let [column, row] =
                [place.x / SIDE - window.x / SIDE, place.y / SIDE - window.y / SIDE];
            row as usize * across + column as usize
        };
        let of_tile: Vec<usize> = (0..frame.tiles()).map(square).collect();
        let mut tiles = vec![Vec::new(); of_tile.iter().max().map_or(0, |last| last + 1)];
        for (tile, &square) in of_tile.iter().enumerate() {
            tiles[square].push(tile);
        }
        Self { tiles, of_tile }
    }

    pub(super) fn len(&self) -> usize {
        self.tiles.len()
    }

    /// The square that a tile belongs to.
    pub(super) fn of_tile(&self, tile: usize) -> usize {
        self.of_tile[tile]
    }

    /// Pixels of a square.
    pub(super) fn pixels(&self, film: &Film, square: usize) -> u64 {
        let pixels = |tile: &usize| film.frame().tile(*tile).pixels() as u64;
        self.tiles[square].iter().map(pixels).sum()
    }

    /// Whether every pixel of a square has exactly so many samples.
    pub(super) fn is_at(&self, film: &Film, square: usize, samples: u32) -> bool {
        let mut counts = Vec::new();
        self.tiles[square].iter().for_each(|&tile| film.counts_of_tile(tile, &mut counts));
        counts.iter().all(|&count| count == samples)
    }

    /// What is known of a square's values.
    pub(super) fn read(&self, film: &Film, square: usize) -> Square {
        Square::new(&self.estimates(film, square))
    }

    /// What is known of its pixels, tile after tile.
    pub(super) fn estimates(&self, film: &Film, square: usize) -> Vec<Estimate> {
        let mut pixels = Vec::new();
        self.tiles[square].iter().for_each(|&tile| film.estimates_of_tile(tile, &mut pixels));
        pixels
    }

    /// The columns and rows of its pixels in the full picture, in the same order.
    pub(super) fn places(&self, film: &Film, square: usize) -> impl Iterator<Item = [u32; 2]> {
        self.tiles[square].iter().flat_map(|&tile| film.frame().tile(tile).places())
    }
}
