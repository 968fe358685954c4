//! Rectangles of pixels.

use std::fmt;

use serde::{Deserialize, Serialize};

/// A rectangle of pixels of the full picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Rect {
    /// First column.
    pub x: u32,
    /// First row.
    pub y: u32,
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
}

impl Rect {
    /// Returns the number of pixels.
    pub fn pixel_count(&self) -> usize {
        self.width as usize * self.height as usize
    }

    /// Iterates over the columns and rows of its pixels, row by row.
    pub fn pixel_coords(self) -> impl Iterator<Item = [u32; 2]> {
        let Self { x, y, width, height } = self;
        (y..y + height).flat_map(move |row| (x..x + width).map(move |column| [column, row]))
    }

    /// Returns the intersection with another rectangle, if not empty.
    pub fn intersection(&self, other: &Self) -> Option<Self> {
        let overlap = |a: u32, a_length: u32, b: u32, b_length: u32| {
            let begin = a.max(b);
            let end = (a + a_length).min(b + b_length);
            (begin < end).then(|| (begin, end - begin))
        };
        let (x, width) = overlap(self.x, self.width, other.x, other.width)?;
        let (y, height) = overlap(self.y, self.height, other.y, other.height)?;
        Some(Self { x, y, width, height })
    }

    /// Creates a rectangle from its first column and row and its end column and row (exclusive), as
    /// in `--crop` and `image.crop`; `None` if it is empty.
    pub fn from_corners([left, top, right, bottom]: [u32; 4]) -> Option<Self> {
        let (width, height) = (right.checked_sub(left)?, bottom.checked_sub(top)?);
        (width > 0 && height > 0).then_some(Self { x: left, y: top, width, height })
    }

    /// Returns the first column and row, and the end column and row (exclusive).
    pub fn corners(&self) -> [u32; 4] {
        [self.x, self.y, self.x + self.width, self.y + self.height]
    }
}

/// Formats the corners, as in `0,0,640,480`.
impl fmt::Display for Rect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [left, top, right, bottom] = self.corners();
        write!(f, "{left},{top},{right},{bottom}")
    }
}
