//! A picture read from a file, as named layers.

use crate::color::Rgb;

use super::image::Image;

/// The name of the layer with the picture itself.
pub const BEAUTY: &str = "beauty";

/// A picture file: named layers of equal size.
#[derive(Clone, Debug, PartialEq)]
pub struct LayeredImage {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// The layers in file order, with [`BEAUTY`] first if present.
    pub layers: Vec<ImageLayer>,
    /// True if the file holds display values (sRGB, clipped at 1) rather than linear light.
    pub is_display_referred: bool,
}

/// A layer: linear Rec. 709, rows from top to bottom, pixels from left to right.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageLayer {
    /// Name; [`BEAUTY`] for the picture itself.
    pub name: String,
    /// `width * height` values.
    pub pixels: Vec<Rgb>,
}

impl LayeredImage {
    /// Returns the layer with this name.
    pub fn layer(&self, name: &str) -> Option<&ImageLayer> {
        self.layers.iter().find(|layer| layer.name == name)
    }
}

impl From<Image> for LayeredImage {
    /// Creates a picture of linear light with one layer.
    fn from(Image { width, height, pixels }: Image) -> Self {
        let layers = vec![ImageLayer { name: BEAUTY.to_owned(), pixels }];
        Self { width, height, layers, is_display_referred: false }
    }
}

impl ImageLayer {
    /// Number of infinite or NaN pixels and the index of the first; `None` if all are finite.
    pub fn count_non_finite(&self) -> Option<(usize, usize)> {
        let mut bad = (0..self.pixels.len()).filter(|&i| !self.pixels[i].is_finite());
        let first = bad.next()?;
        Some((1 + bad.count(), first))
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
