//! PNG: 8-bit sRGB for the screen. Brighter than 1 is white, there is no exposure.
//!
//! A picture with alpha becomes RGBA whose colours are not multiplied with it, as the specification
//! has it (PNG third edition, section 6.2).

use std::io::{self, Write};

use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};

use crate::color::srgb_from_linear;
use crate::film::Picture;

use super::{BIASED, Notes, Sink, finite_beauty};

/// Bytes of the signature and the header chunk, behind which others may stand.
const HEAD: usize = 8 + 25;

/// Writes beauty through the sRGB curve, rounded to the nearest of 256 steps.
pub(super) fn write(picture: &Picture, notes: &Notes, to: &mut Sink) -> io::Result<()> {
    let step = |linear: f32| (srgb_from_linear(linear) * 255.0).round() as u8;
    let pixels = 0..picture.len();
    let (bytes, kind): (Vec<u8>, _) = match &picture.alpha {
        None => {
            let rgb = |pixel| finite_beauty(picture, pixel).to_array().map(step);
            (pixels.flat_map(rgb).collect(), ExtendedColorType::Rgb8)
        }
        Some(alpha) => {
            let rgba = |pixel: usize| {
                let alpha = alpha[pixel];
                let covered = if alpha > 0.0 { 1.0 / alpha } else { 0.0 };
                let [r, g, b] = (finite_beauty(picture, pixel) * covered).to_array().map(step);
                [r, g, b, (alpha * 255.0).round() as u8]
            };
            (pixels.flat_map(rgba).collect(), ExtendedColorType::Rgba8)
        }
    };
    let (width, height) = (picture.width as u32, picture.height as u32);
    let mut file = Vec::new();
    PngEncoder::new(&mut file)
        .write_image(&bytes, width, height, kind)
        .map_err(io::Error::other)?;
    let (head, rest) = file.split_at(HEAD);
    to.write_all(head)?;
    if let Some(biased) = notes.biased() {
        to.write_all(&text_chunk(BIASED, &biased))?;
    }
    to.write_all(rest)
}

/// A chunk of text under a keyword (PNG specification, section 11.3.3.2): Latin-1, which is what
/// our options are written in.
fn text_chunk(keyword: &str, text: &str) -> Vec<u8> {
    let body = [b"tEXt", keyword.as_bytes(), &[0], text.as_bytes()].concat();
    let length = body.len() as u32 - 4;
    [&length.to_be_bytes(), &body[..], &crc(&body).to_be_bytes()].concat()
}

/// The checksum of a chunk (PNG specification, annex D).
fn crc(bytes: &[u8]) -> u32 {
    let shift = |crc: u32, _| if crc & 1 == 1 { 0xedb8_8320 ^ (crc >> 1) } else { crc >> 1 };
    !bytes.iter().fold(!0, |crc, &byte| (0..8).fold(crc ^ u32::from(byte), shift))
}

#[cfg(test)]
mod tests {
    use super::super::tests::{picture, written};
    use super::super::{Notes, Target};
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
    fn colours_are_not_multiplied_with_alpha() {
        let mut picture = picture();
        picture.direct[0] = Rgb::splat(0.25);
        picture.indirect[0] = Rgb::ZERO;
        let mut alpha = vec![1.0; picture.len()];
        alpha[..2].copy_from_slice(&[0.5, 0.0]);
        picture.alpha = Some(alpha);
        let (_folder, path) = written(&picture, "a.png");
        let image = image::open(path).unwrap();
        assert_eq!(image.color(), image::ColorType::Rgba8);
        let half = (srgb_from_linear(0.5) * 255.0).round() as u8;
        assert_eq!(image.to_rgba8().get_pixel(0, 0).0, [half, half, half, 128]);
        assert_eq!(image.to_rgba8().get_pixel(1, 0).0, [0; 4]);
        assert_eq!(image.to_rgba8().get_pixel(2, 0).0[3], 255);
    }

    #[test]
    fn options_that_bias_stand_in_the_file() {
        // The checksum of the empty chunk that ends every file.
        assert_eq!(super::crc(b"IEND"), 0xae42_6082);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let biased_by = vec!["clamp_indirect = 10".to_owned(), "max_depth = 5".to_owned()];
        let notes = Notes { biased_by, ..Notes::default() };
        Target::new(&path).unwrap().write_with(&picture(), &notes).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        let text = b"tEXtphotosphere:biased\0clamp_indirect = 10, max_depth = 5";
        assert!(bytes.windows(text.len()).any(|part| part == text));
        // Readers check the checksum.
        assert_eq!(image::open(&path).unwrap().into_rgb8().dimensions(), (13, 5));
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
