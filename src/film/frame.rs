//! The pixels of a film, and their division into tiles.

use serde::{Deserialize, Serialize};

use crate::math::Rect;

/// A window of a picture, and the size of the full picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct FilmFrame {
    /// Width and height of the full picture, in pixels.
    pub full_size: [u32; 2],
    /// The window of the full picture that the film covers.
    pub window: Rect,
}

/// Width and height of a tile, in pixels. Tiles are aligned to the full picture, so the tiles of a
/// window are those of the full picture, and four of them make a square of 16 pixels.
pub const TILE_SIZE: [u32; 2] = [16, 4];

impl FilmFrame {
    /// Creates the frame of a full picture.
    pub fn full(width: u32, height: u32) -> Self {
        let full_size = [width, height];
        Self { full_size, window: Rect { x: 0, y: 0, width, height } }
    }

    /// Number of pixels in the window.
    pub fn pixel_count(&self) -> usize {
        self.window.pixel_count()
    }

    /// Number of tiles across and down.
    fn tile_grid(&self) -> [usize; 2] {
        let Rect { x, y, width, height } = self.window;
        let count = |first: u32, length: u32, tile: u32| {
            let end = u64::from(first) + u64::from(length);
            (end.div_ceil(tile.into()) - u64::from(first / tile)) as usize
        };
        [count(x, width, TILE_SIZE[0]), count(y, height, TILE_SIZE[1])]
    }

    /// Number of tiles in the window, counted row by row.
    pub fn tile_count(&self) -> usize {
        let [across, down] = self.tile_grid();
        across * down
    }

    /// Number of tiles in a row.
    pub fn tiles_across(&self) -> usize {
        self.tile_grid()[0]
    }

    /// Returns the tile that contains a pixel of the full picture; `None` outside of the window.
    pub fn tile_containing(&self, [column, row]: [u32; 2]) -> Option<usize> {
        let Rect { x, y, width, height } = self.window;
        let is_within = (x..x + width).contains(&column) && (y..y + height).contains(&row);
        let across = self.tile_grid()[0];
        let tile_offset =
            |position: u32, first: u32, tile: u32| (position / tile - first / tile) as usize;
        is_within.then(|| {
            tile_offset(row, y, TILE_SIZE[1]) * across + tile_offset(column, x, TILE_SIZE[0])
        })
    }

    /// Returns the rectangle of a tile. Tiles at the edges may be smaller.
    pub fn tile(&self, index: usize) -> Rect {
        let Rect { x, y, width, height } = self.window;
        let across = self.tile_grid()[0];
        let extent = |first: u32, length: u32, tile: u32, index: usize| {
            let begin = (first / tile + index as u32) * tile;
            let end = begin.saturating_add(tile).min(first + length);
            let begin = begin.max(first);
            (begin, end - begin)
        };
        let (x, width) = extent(x, width, TILE_SIZE[0], index % across);
        let (y, height) = extent(y, height, TILE_SIZE[1], index / across);
        Rect { x, y, width, height }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_cover_every_pixel_once_and_are_those_of_the_whole() {
        let whole = FilmFrame::full(50, 21);
        for window in [
            whole.window,
            Rect { x: 15, y: 3, width: 18, height: 2 },
            Rect { x: 49, y: 20, width: 1, height: 1 },
            Rect { x: 16, y: 4, width: 16, height: 4 },
        ] {
            let frame = FilmFrame { window, ..whole };
            let mut places: Vec<_> =
                (0..frame.tile_count()).flat_map(|tile| frame.tile(tile).pixel_coords()).collect();
            places.sort_by_key(|[x, y]| (*y, *x));
            assert_eq!(places, window.pixel_coords().collect::<Vec<_>>());
            for tile in 0..frame.tile_count() {
                let rect = frame.tile(tile);
                assert!(
                    rect.pixel_coords().all(|pixel| frame.tile_containing(pixel) == Some(tile))
                );
                let wholes = |of: &usize| whole.tile(*of).intersection(&rect).is_some();
                assert_eq!((0..whole.tile_count()).filter(wholes).count(), 1, "{rect:?}");
            }
        }
        assert_eq!(whole.tile_containing([50, 3]), None);
        assert_eq!(whole.tile(5), Rect { x: 16, y: 4, width: 16, height: 4 });
    }
}
