//! PNG, decoded by the `image` crate.

use std::io::{BufReader, Seek};
use std::path::Path;

use image::codecs::png::PngDecoder;
use image::{DynamicImage, Limits};

use crate::color::{Rgb, linear_from_srgb};
use crate::image_io::png_depth::PngDepth;

use super::layered::{BEAUTY, ImageLayer, LayeredImage};
use super::limits::{self, Announced, DEFLATE_RATIO};

/// Memory for everything beside the pixels: texts, and color profiles, which may be compressed.
const MAX_EXTRA_BYTES: usize = 64 << 20;
/// Bytes of a pixel while it is read: four f32, and two colors made of them.
const HELD: u64 = 16 + 2 * size_of::<Rgb>() as u64;

pub(super) fn read(path: &Path) -> Result<LayeredImage, String> {
    let image = decode(path)?;
    let (width, height) = (image.width() as usize, image.height() as usize);
    let has_alpha = image.color().has_alpha();
    let image = image.into_rgba32f();
    let color = |p: &image::Rgba<f32>| Rgb::new(p[0], p[1], p[2]).map(linear_from_srgb);
    let mut layers =
        vec![ImageLayer { name: BEAUTY.to_owned(), pixels: image.pixels().map(color).collect() }];
    if has_alpha {
        let pixels = image.pixels().map(|p| Rgb::splat(p[3])).collect();
        layers.push(ImageLayer { name: "alpha".to_owned(), pixels });
    }
    Ok(LayeredImage { width, height, layers, is_display_referred: true })
}

/// Reads how finely the file stores its values: fewer than 16 bits are 8.
pub(super) fn read_depth(path: &Path) -> Result<PngDepth, String> {
    let (file, _) = limits::open(path)?;
    let extra = png::Limits { bytes: MAX_EXTRA_BYTES };
    let mut header = png::Decoder::new_with_limits(BufReader::new(file), extra);
    let header = header.read_header_info().map_err(|e| e.to_string())?;
    Ok(match header.bit_depth {
        png::BitDepth::Sixteen => PngDepth::Sixteen,
        _ => PngDepth::Eight,
    })
}

pub(super) fn decode(path: &Path) -> Result<DynamicImage, String> {
    let (file, length) = limits::open(path)?;
    let mut file = BufReader::new(file);
    let extra = png::Limits { bytes: MAX_EXTRA_BYTES };
    let mut header = png::Decoder::new_with_limits(&mut file, extra);
    let header = header.read_header_info().map_err(|e| e.to_string())?;
    let announced = Announced {
        width: header.width.into(),
        height: header.height.into(),
        bits: header.bits_per_pixel() as u64,
        held: HELD,
        max_ratio: DEFLATE_RATIO,
    };
    limits::check(&[announced], length)?;

    file.rewind().map_err(|e| e.to_string())?;
    let mut extra = Limits::no_limits();
    extra.max_alloc = Some(MAX_EXTRA_BYTES as u64);
    let decoder = PngDecoder::with_limits(file, extra).map_err(|e| e.to_string())?;
    DynamicImage::from_decoder(decoder).map_err(|e| e.to_string())
}
