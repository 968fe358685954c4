//! Reads environment maps.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use image::{ImageFormat, ImageReader};

use crate::color::Rgb;

use super::ordinary::ordinary_length;

/// The pixels of an image: linear Rec. 709, rows from top to bottom, pixels from left to right.
#[derive(Clone, Debug)]
pub struct Image {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// `width * height` values, possibly negative or not finite.
    pub pixels: Vec<Rgb>,
}

/// Reads a `.exr` or `.hdr` file.
///
/// # Errors
/// When the file cannot be read; the message gives the reason.
pub fn read_light(path: &Path) -> Result<Image, String> {
    let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
    ordinary_length(path)?;
    let file = File::open(path).map_err(|error| error.to_string())?;
    match extension.to_str() {
        Some("exr") => read_exr(BufReader::new(file)),
        Some("hdr") => read_hdr(BufReader::new(file)),
        _ => Err("its name does not end in .exr or .hdr".into()),
    }
}

fn read_hdr(file: BufReader<File>) -> Result<Image, String> {
    let image = ImageReader::with_format(file, ImageFormat::Hdr);
    let image = image.decode().map_err(|error| error.to_string())?.into_rgb32f();
    let (width, height) = (image.width() as usize, image.height() as usize);
    let pixels = image.pixels().map(|pixel| Rgb::from_array(pixel.0)).collect();
    Ok(Image { width, height, pixels })
}

/// Reads `R`, `G` and `B` of the first readable layer, or `Y` for all three.
fn read_exr(file: BufReader<File>) -> Result<Image, String> {
    use exr::prelude::{ReadChannels, ReadLayers};
    let reader = exr::prelude::read().no_deep_data().largest_resolution_level();
    let reader = reader.all_channels().first_valid_layer().all_attributes().non_parallel();
    let layer = reader.from_buffered(file).map_err(|error| error.to_string())?.layer_data;
    let values = |name: &str| -> Option<Vec<f32>> {
        let channel = layer.channel_data.list.iter().find(|channel| channel.name.eq(name))?;
        Some(channel.sample_data.values_as_f32().collect())
    };
    let colored = || Some([values("R")?, values("G")?, values("B")?]);
    let grey = || values("Y").map(|y| [y.clone(), y.clone(), y]);
    let [r, g, b] = colored().or_else(grey).ok_or("it has no channels `R`, `G`, `B` or `Y`")?;
    let (width, height) = (layer.size.0, layer.size.1);
    if [&r, &g, &b].iter().any(|channel| channel.len() != width * height) {
        return Err("its channels differ in size".into());
    }
    let pixels = (0..r.len()).map(|i| Rgb::new(r[i], g[i], b[i])).collect();
    Ok(Image { width, height, pixels })
}
