//! PNG and Radiance HDR, decoded by the `image` crate.

use std::path::Path;

use image::{DynamicImage, ImageFormat, ImageReader};

use crate::color::{Rgb, linear_from_srgb};

use super::layered::{BEAUTY, ImageLayer, LayeredImage, check_samples};

pub(super) fn read_png(path: &Path) -> Result<LayeredImage, String> {
    let image = decode(path, ImageFormat::Png)?;
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

pub(super) fn read_hdr(path: &Path) -> Result<LayeredImage, String> {
    let image = decode(path, ImageFormat::Hdr)?.into_rgb32f();
    let (width, height) = (image.width() as usize, image.height() as usize);
    let pixels = image.pixels().map(|pixel| Rgb::from_array(pixel.0)).collect();
    let layers = vec![ImageLayer { name: BEAUTY.to_owned(), pixels }];
    Ok(LayeredImage { width, height, layers, is_display_referred: false })
}

pub(super) fn decode(path: &Path, format: ImageFormat) -> Result<DynamicImage, String> {
    let open = || -> Result<_, String> {
        let mut reader = ImageReader::open(path).map_err(|e| e.to_string())?;
        reader.set_format(format);
        reader.no_limits(); // `check_samples` has our own
        Ok(reader)
    };
    let (width, height) = open()?.into_dimensions().map_err(|e| e.to_string())?;
    check_samples(width.into(), height.into(), 4)?;
    open()?.decode().map_err(|e| e.to_string())
}
