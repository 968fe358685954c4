//! OpenEXR: every part and channel, grouped into layers by name.

use std::path::Path;

use exr::meta::MetaData;
use exr::prelude::{AnyChannel, FlatSamples, read_all_flat_layers_from_file};

use crate::color::Rgb;

use super::layered::{BEAUTY, ImageLayer, LayeredImage, check_samples};

/// Maximum compression ratio of ZIP (1032), and of every other supported method.
const MAX_ZIP_RATIO: u64 = 1032;

/// The role of a channel in its layer.
#[derive(Clone, Copy, PartialEq, Eq)]
enum ChannelRole {
    Color(usize),
    Grey,
}

pub(super) fn read(path: &Path, length: u64) -> Result<LayeredImage, String> {
    check_header(path, length)?;
    let image = read_all_flat_layers_from_file(path).map_err(|e| e.to_string())?;
    let size = image.layer_data.first().ok_or("it has no parts")?.size;
    let mut layers = Vec::new();
    for part in &image.layer_data {
        // A part of a different size is a separate picture, such as a preview.
        if part.size != size {
            continue;
        }
        let part_name = part.attributes.layer_name.as_ref().map(ToString::to_string);
        let channels = &part.channel_data.list;
        let has = |name: &str| channels.iter().any(|channel| channel.name.eq(name));
        for channel in channels {
            add(channel, &has, part_name.as_deref().unwrap_or(""), size.area(), &mut layers);
        }
    }
    if layers.is_empty() {
        return Err("it has no channels".to_owned());
    }
    layers.sort_by_key(|layer| layer.name != BEAUTY);
    Ok(LayeredImage { width: size.0, height: size.1, layers, is_display_referred: false })
}

/// Rejects headers for which the exr crate would allocate too much memory.
fn check_header(path: &Path, length: u64) -> Result<(), String> {
    let meta = MetaData::read_from_file(path, false).map_err(|e| e.to_string())?;
    for header in &meta.headers {
        let size = header.layer_size;
        let channels = &header.channels.list;
        check_samples(size.0 as u64, size.1 as u64, channels.len() as u64)?;
        if channels.iter().any(|channel| channel.sampling.0 != 1 || channel.sampling.1 != 1) {
            return Err("it has subsampled channels, which are not supported".to_owned());
        }
        if header.total_pixel_bytes() as u64 / MAX_ZIP_RATIO > length {
            return Err("it is shorter than its header says".to_owned());
        }
    }
    Ok(())
}

/// Adds a channel to its layer: `direct.R` is the red of layer `direct`, and `normal.X` the first
/// component of `normal`. `has` returns true for channels that exist in this part.
fn add(
    channel: &AnyChannel<FlatSamples>,
    has: &dyn Fn(&str) -> bool,
    part: &str,
    count: usize,
    layers: &mut Vec<ImageLayer>,
) {
    let full = channel.name.to_string();
    let (prefix, last) = full.rsplit_once('.').unwrap_or(("", &full));
    // A single `Y` is a grey picture, and a single `Z` a depth.
    let is_vector = ["X", "Y", "Z"].iter().all(|axis| has(&format!("{prefix}.{axis}")));
    let (suffix, role) = match last.to_ascii_uppercase().as_str() {
        "X" if is_vector => ("", ChannelRole::Color(0)),
        "Y" if is_vector => ("", ChannelRole::Color(1)),
        "Z" if is_vector => ("", ChannelRole::Color(2)),
        "R" | "RED" => ("", ChannelRole::Color(0)),
        "G" | "GREEN" => ("", ChannelRole::Color(1)),
        "B" | "BLUE" => ("", ChannelRole::Color(2)),
        "Y" => ("", ChannelRole::Grey),
        "A" => ("alpha", ChannelRole::Grey),
        _ => (last, ChannelRole::Grey),
    };
    let name = layer_name([part, prefix, suffix]);
    let at = layers.iter().position(|layer| layer.name == name).unwrap_or_else(|| {
        layers.push(ImageLayer { name, pixels: vec![Rgb::ZERO; count] });
        layers.len() - 1
    });
    for (pixel, value) in layers[at].pixels.iter_mut().zip(channel.sample_data.values_as_f32()) {
        match role {
            ChannelRole::Color(axis) => pixel[axis] = value,
            ChannelRole::Grey => *pixel = Rgb::splat(value),
        }
    }
}

/// Joins the nonempty parts by dots. Other programs use several names for the beauty.
fn layer_name(parts: [&str; 3]) -> String {
    let is_beauty = |part: &str| matches!(part, "" | "rgb" | "rgba" | "RGB" | "RGBA" | "beauty");
    let said: Vec<&str> = parts.into_iter().filter(|part| !is_beauty(part)).collect();
    if said.is_empty() { BEAUTY.to_owned() } else { said.join(".") }
}

#[cfg(test)]
mod tests {
    use exr::prelude::{
        AnyChannels, Encoding, Image, ImageAttributes, IntegerBounds, Layer as Part,
        LayerAttributes, SmallVec, Text, WritableImage,
    };

    use super::*;

    /// One part with the given channels, of 2 x 1 pixels with values `value` and `2 value`.
    fn part(name: &str, channels: &[(&str, f32)]) -> Part<AnyChannels<FlatSamples>> {
        let channel = |&(name, value): &(&str, f32)| {
            AnyChannel::new(Text::from(name), FlatSamples::F32(vec![value, 2.0 * value]))
        };
        let channels: SmallVec<_> = channels.iter().map(channel).collect();
        let attributes =
            LayerAttributes { layer_name: Some(Text::from(name)), ..LayerAttributes::default() };
        Part::new((2, 1), attributes, Encoding::UNCOMPRESSED, AnyChannels::sort(channels))
    }

    fn read_back(image: &Image<SmallVec<[Part<AnyChannels<FlatSamples>>; 2]>>) -> LayeredImage {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        image.write().to_file(&path).unwrap();
        super::super::read_image(&path).unwrap()
    }

    #[test]
    fn the_channels_of_others_find_their_layers() {
        let first = part(
            "rgba",
            &[
                ("R", 1.0),
                ("G", 2.0),
                ("B", 3.0),
                ("A", 0.5),
                ("depth", 7.0),
                ("spec.Y", 4.0),
                ("n.X", 1.0),
                ("n.Y", 2.0),
                ("n.Z", 3.0),
            ],
        );
        let second = part("light", &[("R", 5.0), ("G", 6.0), ("B", 7.0)]);
        let bounds = IntegerBounds::from_dimensions((2, 1));
        let parts: SmallVec<_> = [first, second].into_iter().collect();
        let image = Image::from_layers(ImageAttributes::new(bounds), parts);
        let read = read_back(&image);
        let value = |name: &str| read.layer(name).map(|layer| layer.pixels.clone());
        assert_eq!(read.layers[0].name, BEAUTY);
        assert_eq!(value(BEAUTY).unwrap()[1], Rgb::new(2.0, 4.0, 6.0));
        assert_eq!(value("alpha").unwrap()[0], Rgb::splat(0.5));
        assert_eq!(value("depth").unwrap()[0], Rgb::splat(7.0));
        assert_eq!(value("spec").unwrap()[1], Rgb::splat(8.0));
        assert_eq!(value("light").unwrap()[0], Rgb::new(5.0, 6.0, 7.0));
        assert_eq!(value("n").unwrap()[0], Rgb::new(1.0, 2.0, 3.0));
        assert_eq!(read.layers.len(), 6);
    }
}
