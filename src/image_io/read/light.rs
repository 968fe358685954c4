//! Reads environment maps.

use std::path::Path;

use crate::color::Rgb;

use super::{exr, hdr};

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

/// Reads a `.exr` or `.hdr` file. An OpenEXR file whose data window differs from its display window
/// gives the display window, black where there are no data.
///
/// # Errors
/// When the file cannot be read; the message gives the reason.
pub fn read_light(path: &Path) -> Result<Image, String> {
    let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
    match extension.to_str() {
        Some("exr") => exr::read_light(path),
        Some("hdr") => hdr::read(path),
        _ => Err("its name does not end in .exr or .hdr".into()),
    }
}
