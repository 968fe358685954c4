//! What a file becomes that is read.

use crate::color::Rgb;

/// The name of the layer that is the picture itself.
pub const BEAUTY: &str = "beauty";
/// More samples than this are no picture that we could hold in memory twice.
pub(super) const MAX_SAMPLES: u64 = 1 << 30;

/// A picture file: layers of one size.
#[derive(Clone, Debug, PartialEq)]
pub struct LayeredImage {
    /// Pixels across.
    pub width: usize,
    /// Pixels down.
    pub height: usize,
    /// The layers in the order of the file, [`BEAUTY`] first where there is one.
    pub layers: Vec<ImageLayer>,
    /// Whether the file holds values for the screen (sRGB, cut off at 1) and not light.
    pub is_display_referred: bool,
}

/// One layer: linear Rec. 709, rows from the top, pixels of a row from the left.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageLayer {
    /// Its name; [`BEAUTY`] for the picture itself.
    pub name: String,
    /// `width * height` values.
    pub pixels: Vec<Rgb>,
}

impl LayeredImage {
    /// The layer of that name.
    pub fn layer(&self, name: &str) -> Option<&ImageLayer> {
        self.layers.iter().find(|layer| layer.name == name)
    }
}

impl ImageLayer {
    /// How many pixels are infinite or not a number, and the index of the first of them.
    pub fn count_non_finite(&self) -> Option<(usize, usize)> {
        let mut bad = (0..self.pixels.len()).filter(|&i| !self.pixels[i].is_finite());
        let first = bad.next()?;
        Some((1 + bad.count(), first))
    }
}

/// Refuses a header whose samples (f32) would not fit into memory.
pub(super) fn check_samples(width: u64, height: u64, channels: u64) -> Result<(), String> {
    if width == 0 || height == 0 {
        return Err("it has no pixels".to_owned());
    }
    match width.checked_mul(height).and_then(|pixels| pixels.checked_mul(channels)) {
        Some(samples) if samples <= MAX_SAMPLES => Ok(()),
        _ => Err(format!("{width} x {height} pixels are more than can be held")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_that_are_not_finite_are_counted() {
        let mut layer = ImageLayer { name: BEAUTY.into(), pixels: vec![Rgb::ONE; 4] };
        assert_eq!(layer.count_non_finite(), None);
        layer.pixels[2].y = f32::NAN;
        layer.pixels[3].x = f32::INFINITY;
        assert_eq!(layer.count_non_finite(), Some((2, 2)));
    }
}
