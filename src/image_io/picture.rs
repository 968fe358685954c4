//! A finished picture: what goes into files.

use glam::DVec3;

use crate::color::Rgb;

/// Linear Rec. 709 radiance of every pixel, split by how the light came.
///
/// Rows run from the top, pixels of a row from the left. Both layers hold `width * height` pixels.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Picture {
    /// Pixels across.
    pub width: usize,
    /// Pixels down.
    pub height: usize,
    /// Emission and background seen by the camera, and light scattered once.
    pub direct: Vec<Rgb>,
    /// All other light.
    pub indirect: Vec<Rgb>,
    /// The share of each pixel that something covers, where the scene asks for it; the layers are
    /// then light over nothing (premultiplied).
    pub alpha: Option<Vec<f32>>,
    /// Of direct and indirect light, the names of what files do not show apart.
    pub hidden_layers: Vec<&'static str>,
    /// Further channels, for files that have a place for them.
    pub channels: Vec<ImageChannel>,
    /// What readers of those channels need to know: names and texts of attributes.
    pub attributes: Vec<(String, String)>,
}

/// A channel of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageChannel {
    /// Its whole name, such as `normal.X`.
    pub name: String,
    /// A value for each pixel.
    pub values: ChannelValues,
}

/// The values of a channel.
#[derive(Clone, Debug, PartialEq)]
pub enum ChannelValues {
    /// 32-bit floats.
    Float(Vec<f32>),
    /// 32-bit whole numbers.
    Uint(Vec<u32>),
}

impl ImageChannel {
    /// A channel.
    pub fn new(name: &str, values: ChannelValues) -> Self {
        Self { name: name.to_owned(), values }
    }
}

impl Picture {
    /// Number of pixels.
    pub fn len(&self) -> usize {
        self.direct.len()
    }

    /// Whether there is no pixel at all.
    pub fn is_empty(&self) -> bool {
        self.direct.is_empty()
    }

    /// All the light of a pixel: the sum of the layers, rounded to f32 once.
    pub fn beauty(&self, pixel: usize) -> Rgb {
        self.direct[pixel] + self.indirect[pixel]
    }

    /// The beauty of a pixel for a format that knows no infinity and no not-a-number.
    pub(super) fn finite_beauty(&self, pixel: usize) -> Rgb {
        let beauty = self.beauty(pixel);
        if beauty.is_nan() {
            return Rgb::new(1.0, 0.0, 1.0);
        }
        beauty.clamp(Rgb::splat(f32::MIN), Rgb::splat(f32::MAX))
    }

    /// How many pixels are infinite or not a number in any channel of their beauty.
    pub fn non_finite(&self) -> usize {
        (0..self.len()).filter(|&pixel| !self.beauty(pixel).is_finite()).count()
    }

    /// The mean of the beauty over all pixels; not finite if any pixel is not.
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
