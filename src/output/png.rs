//! PNG: 8-bit sRGB for the screen. Brighter than 1 is white, there is no exposure.

use std::io;

use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};

use crate::color::srgb_from_linear;
use crate::film::Picture;

use super::{Sink, finite_beauty};

/// Writes beauty through the sRGB curve, rounded to the nearest of 256 steps.
pub(super) fn write(picture: &Picture, to: &mut Sink) -> io::Result<()> {
    let step = |linear: f32| (srgb_from_linear(linear) * 255.0).round() as u8;
    let bytes: Vec<u8> = (0..picture.len())
        .flat_map(|pixel| finite_beauty(picture, pixel).to_array().map(step))
        .collect();
    let (width, height) = (picture.width as u32, picture.height as u32);
    PngEncoder::new(to)
        .write_image(&bytes, width, height, ExtendedColorType::Rgb8)
        .map_err(io::Error::other)
}

#[cfg(test)]
mod tests {
    use super::super::tests::{picture, written};
    use crate::color::{Rgb, srgb_from_linear};

    #[test]
    fn pixels_come_back_in_place_and_rounded() {
        let picture = picture();
        let (_folder, path) = written(&picture, "a.PNG");
        let image = image::ImageReader::open(path).unwrap().with_guessed_format().unwrap();
        let image = image.decode().unwrap().into_rgb8();
        assert_eq!(image.dimensions(), (13, 5));
        for (pixel, read) in image.pixels().enumerate() {
            for (value, read) in picture.beauty(pixel).to_array().into_iter().zip(read.0) {
                let exact = srgb_from_linear(value) * 255.0;
                assert!((exact - f32::from(read)).abs() <= 0.5);
            }
        }
    }

    #[test]
    fn values_that_are_not_finite_are_seen() {
        let mut picture = picture();
        picture.direct[0] = Rgb::new(0.0, f32::NAN, 0.0);
        picture.direct[1] = Rgb::new(f32::INFINITY, 0.0, f32::NEG_INFINITY);
        picture.indirect[..2].fill(Rgb::ZERO);
        let (_folder, path) = written(&picture, "a.png");
        let image = image::open(path).unwrap().into_rgb8();
        assert_eq!(image.get_pixel(0, 0).0, [255, 0, 255]);
        assert_eq!(image.get_pixel(1, 0).0, [255, 0, 0]);
    }
}
