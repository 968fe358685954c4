//! Refuses to read pictures from anything but ordinary files. A pipe may have no writer and a device
//! no end, and a picture is read more than once.

use std::fs;
use std::path::Path;

/// Returns the length of an ordinary file in bytes.
///
/// # Errors
/// If there is no file, or it is a folder, a pipe, a device or a socket; the message is the reason.
pub(in crate::image_io) fn ordinary_length(path: &Path) -> Result<u64, String> {
    let metadata = fs::metadata(path).map_err(|e| e.to_string())?;
    match metadata {
        _ if metadata.is_dir() => Err("it is a folder".to_owned()),
        _ if !metadata.is_file() => Err("it is not an ordinary file".to_owned()),
        _ => Ok(metadata.len()),
    }
}
