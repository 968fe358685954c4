//! Reads the stored values of a picture file, for bitwise comparison.

use std::path::Path;

use exr::prelude::FlatSamples;

use crate::error::{Error, Result};

use crate::image_io::format::FileFormat;

/// A channel as stored in the file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RawChannel {
    /// Name in the file; `R`, `G`, `B` and `A` for formats without channel names.
    pub name: String,
    /// Values, row by row: integers, or the bits of floats.
    pub bits: Vec<u32>,
}

/// Reads all channels of a `.exr` or `.png` file, sorted by name.
///
/// # Errors
/// When the file cannot be read or has another format.
pub fn read_raw_channels(path: &Path) -> Result<Vec<RawChannel>> {
    let trouble = |reason: String| Error::file("read", path, reason);
    match FileFormat::from_path(path)? {
        FileFormat::Exr => read_exr(path).map_err(trouble),
        FileFormat::Png => read_png(path).map_err(trouble),
        _ => Err(trouble("it is neither .exr nor .png".to_owned())),
    }
}

fn read_exr(path: &Path) -> std::result::Result<Vec<RawChannel>, String> {
    let image = super::exr::read_parts(path)?;
    let channels = image.layer_data.iter().flat_map(|part| &part.channel_data.list);
    let raw = channels.map(|channel| {
        let bits = match &channel.sample_data {
            FlatSamples::F32(values) => values.iter().map(|value| value.to_bits()).collect(),
            FlatSamples::U32(values) => values.clone(),
            FlatSamples::F16(values) => values.iter().map(|v| u32::from(v.to_bits())).collect(),
        };
        RawChannel { name: channel.name.to_string(), bits }
    });
    let mut raw: Vec<RawChannel> = raw.collect();
    raw.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(raw)
}

fn read_png(path: &Path) -> std::result::Result<Vec<RawChannel>, String> {
    let image = super::png::decode(path)?;
    let count = if image.color().has_alpha() { 4 } else { 3 };
    let image = image.into_rgba16();
    let channel = |(at, name): (usize, &str)| RawChannel {
        name: name.to_owned(),
        bits: image.pixels().map(|pixel| u32::from(pixel.0[at])).collect(),
    };
    let mut raw: Vec<RawChannel> =
        ["R", "G", "B", "A"].into_iter().take(count).enumerate().map(channel).collect();
    raw.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(raw)
}
