//! Radiance RGBE: linear light in 32 bits per pixel, three mantissas and one exponent (Ward 1991,
//! "Real Pixels"). Mantissas are truncated, not rounded, as Ward defined; readers add half a step.

use std::io;

use image::Rgb as ImageRgb;
use image::codecs::hdr::HdrEncoder;

use crate::color::Rgb;

use super::atomic_file::Sink;
use super::picture::Picture;

/// The largest RGBE value.
const MAX_RGBE: f32 = 255.0 / 256.0 * 1.701_411_8e38;
/// Below this, the exponent does not fit into its byte.
const MIN_RGBE: f32 = f32::MIN_POSITIVE;

/// Writes the linear beauty; negative and tiny values become 0.
pub(super) fn write(picture: &Picture, to: &mut Sink) -> io::Result<()> {
    let pixels: Vec<_> =
        (0..picture.len()).map(|pixel| to_rgbe_range(picture.finite_beauty(pixel))).collect();
    HdrEncoder::new(to).encode(&pixels, picture.width, picture.height).map_err(io::Error::other)
}

fn to_rgbe_range(color: Rgb) -> ImageRgb<f32> {
    let fit = |value: f32| if value < MIN_RGBE { 0.0 } else { value.min(MAX_RGBE) };
    ImageRgb(color.to_array().map(fit))
}

#[cfg(test)]
mod tests {
    use super::super::tests::{picture, written};
    use super::*;

    fn read_back(picture: &Picture) -> Vec<[f32; 3]> {
        let (_folder, path) = written(picture, "a.hdr");
        image::open(path).unwrap().into_rgb32f().pixels().map(|pixel| pixel.0).collect()
    }

    #[test]
    fn pixels_come_back_to_one_step_of_the_brightest_channel() {
        let picture = picture();
        for (pixel, read) in read_back(&picture).into_iter().enumerate() {
            let exact = picture.beauty(pixel);
            let step = exact.max_element() / 128.0;
            assert!((exact - Rgb::from_array(read)).abs().max_element() <= step);
        }
    }

    #[test]
    fn extreme_values_stay_extreme() {
        let mut picture = picture();
        let extremes = [f32::INFINITY, f32::MAX, -1.0, 1e-45, f32::MIN_POSITIVE];
        for (pixel, value) in extremes.into_iter().enumerate() {
            picture.direct[pixel] = Rgb::splat(value);
            picture.indirect[pixel] = Rgb::ZERO;
        }
        picture.direct[5] = Rgb::splat(f32::NAN);
        let read = read_back(&picture);
        assert!(read[0][0] > 1e38 && read[1][0] > 1e38);
        assert!(read[2..5].iter().all(|pixel| pixel[0] < 1e-37));
        assert_eq!(read[5], [1.0, 0.0, 1.0]);
    }
}
