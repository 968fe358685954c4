//! Reads environment maps.

use std::path::Path;

use super::image::Image;
use super::{exr, hdr};

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
