//! How large the texts over a picture are.

use super::spec::OverlayChoice;

/// Size of texts in heights of the picture, where no size for print is known.
const TEXT_SHARE: f64 = 0.026;

/// Size of texts in points, where the picture's resolution for print is known.
const TEXT_POINTS: f64 = 8.0;

/// Largest size of texts in heights of the picture.
const MAX_TEXT_SHARE: f64 = 0.1;

/// Size of texts in pixels, in a picture of this height in pixels and this resolution for print.
pub fn font_pixels(choice: &OverlayChoice, height: u32, dpi: Option<u32>) -> f64 {
    let height = f64::from(height);
    let per_point = dpi.map_or(height * TEXT_SHARE / TEXT_POINTS, |dpi| f64::from(dpi) / 72.0);
    let font_pixels = per_point * choice.font_size.unwrap_or(TEXT_POINTS);
    font_pixels.clamp(1.0, (MAX_TEXT_SHARE * height).max(1.0))
}
