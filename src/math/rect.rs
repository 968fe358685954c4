//! Rectangles of pixels.

use std::fmt;

use serde::{Deserialize, Serialize};

/// A rectangle of pixels of the whole picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Rect {
    /// Its first column.
    pub x: u32,
    /// Its first row.
    pub y: u32,
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
}

impl Rect {
    /// How many pixels it has.
    pub fn pixel_count(&self) -> usize {
        self.width as usize * self.height as usize
    }

    /// The columns and rows of its pixels, along the rows.
    pub fn pixel_coords(self) -> impl Iterator<Item = [u32; 2]> {
        let Self { x, y, width, height } = self;
        (y..y + height).flat_map(move |row| (x..x + width).map(move |column| [column, row]))
    }

    /// What it has in common with another, if anything.
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

    /// From the first column and row and the ones behind the last, as `--crop` and `image.crop` have
    /// them; `None` where nothing lies between.
    pub fn from_corners([left, top, right, bottom]: [u32; 4]) -> Option<Self> {
        let (width, height) = (right.checked_sub(left)?, bottom.checked_sub(top)?);
        (width > 0 && height > 0).then_some(Self { x: left, y: top, width, height })
    }

    /// The first column and row, and the ones behind the last.
    pub fn corners(&self) -> [u32; 4] {
        [self.x, self.y, self.x + self.width, self.y + self.height]
    }
}

/// The corners, as in `0,0,640,480`.
impl fmt::Display for Rect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [left, top, right, bottom] = self.corners();
        write!(f, "{left},{top},{right},{bottom}")
    }
}
