//! A finished picture, ready to be written to files.

use glam::DVec3;

use crate::color::Rgb;

/// Linear Rec. 709 radiance of every pixel, split into direct and indirect light.
///
/// Rows run from top to bottom, pixels from left to right. Both layers hold `width * height`
/// pixels.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Picture {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// Emission and background seen by the camera, and light scattered once.
    pub direct: Vec<Rgb>,
    /// Light scattered more than once.
    pub indirect: Vec<Rgb>,
    /// Opacity of each pixel in [0, 1], if the scene requests alpha; the layers are then
    /// premultiplied.
    pub alpha: Option<Vec<f32>>,
    /// Layers among `beauty`, `direct` and `indirect` that files with layers omit.
    pub hidden_layers: Vec<&'static str>,
    /// Additional channels, for formats that support them.
    pub channels: Vec<ImageChannel>,
    /// Attributes (name, text) that describe those channels.
    pub attributes: Vec<(String, String)>,
}

/// A channel in a file.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageChannel {
    /// Full name, such as `normal.X`.
    pub name: String,
    /// One value per pixel.
    pub values: ChannelValues,
}

/// The values of a channel.
#[derive(Clone, Debug, PartialEq)]
pub enum ChannelValues {
    /// 32-bit floats.
    Float(Vec<f32>),
    /// 32-bit unsigned integers.
    Uint(Vec<u32>),
}

impl ImageChannel {
    /// Creates a channel.
    pub fn new(name: &str, values: ChannelValues) -> Self {
        Self { name: name.to_owned(), values }
    }
}

impl Picture {
    /// Number of pixels.
    pub fn len(&self) -> usize {
        self.direct.len()
    }

    /// Returns true if there are no pixels.
    pub fn is_empty(&self) -> bool {
        self.direct.is_empty()
    }

    /// The full radiance of a pixel: the sum of both layers, rounded to f32 once.
    pub fn beauty(&self, pixel: usize) -> Rgb {
        self.direct[pixel] + self.indirect[pixel]
    }

    /// The beauty of a pixel, for formats without infinity and NaN.
    pub(crate) fn finite_beauty(&self, pixel: usize) -> Rgb {
        let beauty = self.beauty(pixel);
        if beauty.is_nan() {
            return Rgb::new(1.0, 0.0, 1.0);
        }
        beauty.clamp(Rgb::splat(f32::MIN), Rgb::splat(f32::MAX))
    }

    /// Number of pixels whose beauty is infinite or NaN in any channel.
    pub fn non_finite(&self) -> usize {
        (0..self.len()).filter(|&pixel| !self.beauty(pixel).is_finite()).count()
    }

    /// The mean beauty over all pixels; not finite if any pixel is not.
    pub fn mean(&self) -> DVec3 {
        let sum: DVec3 = (0..self.len()).map(|pixel| self.beauty(pixel).as_dvec3()).sum();
        sum / self.len() as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn beauty_mean_and_bad_pixels_are_those_of_the_sum() {
        let picture = Picture {
            width: 2,
            height: 1,
            direct: vec![Rgb::new(1.0, 2.0, 3.0), Rgb::ZERO],
            indirect: vec![Rgb::ONE, Rgb::new(0.0, 1.0, 2.0)],
            ..Picture::default()
        };
        assert_eq!(picture.beauty(0), Rgb::new(2.0, 3.0, 4.0));
        assert_eq!(picture.mean(), DVec3::new(1.0, 2.0, 3.0));
        assert_eq!(picture.non_finite(), 0);
        let indirect = vec![Rgb::splat(f32::NAN), Rgb::splat(f32::INFINITY)];
        assert_eq!(Picture { indirect, ..picture }.non_finite(), 2);
    }
}
