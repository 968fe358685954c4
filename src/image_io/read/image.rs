//! Linear pixels.

use crate::color::Rgb;

/// The pixels of an image: linear Rec. 709, rows from top to bottom, pixels from left to right.
#[derive(Clone, Debug)]
pub struct Image {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// `width * height` values, possibly negative or not finite.
    pub pixels: Vec<Rgb>,
}
