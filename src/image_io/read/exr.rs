//! OpenEXR: every part and channel, grouped into layers by name; or the colors alone, in their
//! display window.

use std::fs::File;
use std::io::{BufReader, Seek};
use std::path::Path;

use exr::compression::Compression;
use exr::meta::MetaData;
use exr::meta::header::Header;
use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, FlatSamples, IntegerBounds, ReadChannels, ReadLayers,
    Vec2, read,
};

use crate::color::Rgb;
use crate::image_io::picture::{ChannelValues, ImageChannel};

use super::image::Image;
use super::layered::{BEAUTY, ImageLayer, LayeredImage};
use super::limits::{self, Announced, DEFLATE_RATIO};
use super::stored::StoredPicture;

/// Ratio of DWA, whose blocks of 64 equal pixels, or runs of bytes, are then deflated.
const DWA_RATIO: u64 = 64 * DEFLATE_RATIO;

/// Bytes of a pixel in memory.
const COLOR_BYTES: u64 = size_of::<Rgb>() as u64;

/// A picture with all its parts as stored.
type FlatParts = exr::prelude::FlatImage;

/// The role of a channel in its layer.
#[derive(Clone, Copy, PartialEq, Eq)]
enum ChannelRole {
    Color(usize),
    Grey,
}

/// Reads all layers.
pub(super) fn read_layers(path: &Path) -> Result<LayeredImage, String> {
    let image = read_parts(path)?;
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

/// Reads all channels of the parts that are as large as the first, with the layer of each, and the
/// texts beside the pixels, in the order of their names.
pub(super) fn read_channels(path: &Path) -> Result<StoredPicture, String> {
    let image = read_parts(path)?;
    let first = image.layer_data.first().ok_or("it has no parts")?;
    let (size, position) = (first.size, first.attributes.layer_position);
    let display = image.attributes.display_window;
    let mut stored = StoredPicture {
        size: [size.0, size.1],
        offset: [position.0 - display.position.0, position.1 - display.position.1],
        full_size: [display.size.0, display.size.1],
        channels: Vec::new(),
        attributes: Vec::new(),
    };
    for part in image.layer_data.iter().filter(|part| part.size == size) {
        let part_name = part.attributes.layer_name.as_ref().map(ToString::to_string);
        let part_name = part_name.as_deref().unwrap_or("");
        let channels = &part.channel_data.list;
        let has = |name: &str| channels.iter().any(|channel| channel.name.eq(name));
        for channel in channels {
            let own = channel.name.to_string();
            let (layer, _) = layer_of(&own, &has, part_name);
            let name = if image.layer_data.len() > 1 && !part_name.is_empty() {
                format!("{part_name}.{own}")
            } else {
                own
            };
            let values = match &channel.sample_data {
                FlatSamples::U32(values) => ChannelValues::Uint(values.clone()),
                other => ChannelValues::Float(other.values_as_f32().collect()),
            };
            stored.channels.push((layer, ImageChannel { name, values }));
        }
        for (name, value) in &part.attributes.other {
            if let AttributeValue::Text(text) = value {
                stored.attributes.push((name.to_string(), text.to_string()));
            }
        }
    }
    stored.attributes.sort();
    Ok(stored)
}

/// Reads all parts as stored.
pub(super) fn read_parts(path: &Path) -> Result<FlatParts, String> {
    let (file, _) = open(path, u64::MAX)?;
    let reader = read().no_deep_data().largest_resolution_level();
    let reader = reader.all_channels().all_layers().all_attributes();
    reader.from_buffered(file).map_err(|e| e.to_string())
}

/// Reads `R`, `G` and `B` of the first readable part, or `Y` for all three, into the display
/// window. Outside the data window it is black, as OpenEXR defines.
pub(super) fn read_light(path: &Path) -> Result<Image, String> {
    let (file, length) = open(path, 1)?;
    let reader = read().no_deep_data().largest_resolution_level();
    let reader = reader.all_channels().first_valid_layer().all_attributes().non_parallel();
    let image = reader.from_buffered(file).map_err(|error| error.to_string())?;
    let part = image.layer_data;
    let stored = Image {
        width: part.size.0,
        height: part.size.1,
        pixels: colors(&part.channel_data, part.size.area())?,
    };
    let display = image.attributes.display_window;
    let data = IntegerBounds::new(part.attributes.layer_position, part.size);
    if display == data {
        return Ok(stored);
    }
    let announced = Announced {
        width: display.size.0 as u64,
        height: display.size.1 as u64,
        // What is outside takes no bytes, but no file is believed to be mostly outside.
        bits: 8 * COLOR_BYTES,
        held: COLOR_BYTES,
        max_ratio: DWA_RATIO,
    };
    limits::check(&[announced], length)?;
    place(&stored, data.position, display)
}

/// Places a picture whose first pixel is at `position` into a window.
fn place(stored: &Image, position: Vec2<i32>, window: IntegerBounds) -> Result<Image, String> {
    let (width, height) = (window.size.0, window.size.1);
    // Columns and rows of the window that a stored extent covers, and the first of those stored.
    let overlap = |position: i32, extent: usize, from: i32, length: usize| {
        let offset = i64::from(position) - i64::from(from);
        let begin = offset.clamp(0, length as i64);
        let end = (offset + extent as i64).clamp(0, length as i64);
        (begin as usize..end as usize, (begin - offset) as usize)
    };
    let (columns, left) = overlap(position.0, stored.width, window.position.0, width);
    let (rows, top) = overlap(position.1, stored.height, window.position.1, height);
    if columns.is_empty() || rows.is_empty() {
        return Err("its pixels lie outside its display window".to_owned());
    }
    let mut pixels = vec![Rgb::ZERO; width * height];
    for (row, source) in rows.zip(top..) {
        let from = source * stored.width + left;
        let to = row * width;
        pixels[to + columns.start..to + columns.end]
            .copy_from_slice(&stored.pixels[from..from + columns.len()]);
    }
    Ok(Image { width, height, pixels })
}

/// Returns the pixels of `R`, `G` and `B`, or of `Y`.
fn colors(channels: &AnyChannels<FlatSamples>, count: usize) -> Result<Vec<Rgb>, String> {
    let channel = |name: &str| channels.list.iter().find(|channel| channel.name.eq(name));
    let mut pixels = vec![Rgb::ZERO; count];
    let mut set = |channel: &AnyChannel<FlatSamples>, role| {
        let values = channel.sample_data.values_as_f32();
        values.zip(&mut pixels).for_each(|(value, pixel)| assign(pixel, role, value));
    };
    match ([channel("R"), channel("G"), channel("B")], channel("Y")) {
        ([Some(r), Some(g), Some(b)], _) => {
            [r, g, b].into_iter().enumerate().for_each(|(c, x)| set(x, ChannelRole::Color(c)));
        }
        (_, Some(y)) => set(y, ChannelRole::Grey),
        _ => return Err("it has no channels `R`, `G`, `B` or `Y`".to_owned()),
    }
    Ok(pixels)
}

/// Opens a file whose header is believed; at most `colors` will be made of a part's channels.
fn open(path: &Path, colors: u64) -> Result<(BufReader<File>, u64), String> {
    let (file, length) = limits::open(path)?;
    let mut file = BufReader::new(file);
    let meta = MetaData::read_from_buffered(&mut file, false).map_err(|e| e.to_string())?;
    let parts: Result<Vec<_>, String> =
        meta.headers.iter().map(|header| announced(header, colors)).collect();
    limits::check(&parts?, length)?;
    file.rewind().map_err(|e| e.to_string())?;
    Ok((file, length))
}

/// Returns what a part's header announces if at most `colors` are made of its channels; refuses
/// parts that cannot be read.
fn announced(header: &Header, colors: u64) -> Result<Announced, String> {
    if header.deep {
        return Err("it has deep data, which is not supported".to_owned());
    }
    let channels = &header.channels.list;
    let is_chroma = |name: &str| matches!(name.rsplit('.').next(), Some("RY" | "BY"));
    if channels.iter().any(|channel| is_chroma(&channel.name.to_string())) {
        return Err(
            "its colors are stored as luminance and chroma (Y, RY, BY), which is not supported; \
                    convert it to R, G, B first"
                .to_owned(),
        );
    }
    if channels.iter().any(|channel| channel.sampling != Vec2(1, 1)) {
        return Err("it has subsampled channels, which are not supported".to_owned());
    }
    // Smaller versions of the picture, which tiles may hold, are not read and not counted.
    let sizes = channels.iter().map(|channel| channel.sample_type.bytes_per_sample() as u64);
    let bytes = sizes.sum::<u64>();
    Ok(Announced {
        width: header.layer_size.0 as u64,
        height: header.layer_size.1 as u64,
        bits: 8 * bytes,
        held: bytes + colors.min(channels.len() as u64) * COLOR_BYTES,
        max_ratio: max_ratio(header.compression),
    })
}

/// Returns the most bytes that a byte of a block can stand for.
fn max_ratio(compression: Compression) -> u64 {
    match compression {
        Compression::Uncompressed => 1,
        // A run of 128 bytes takes two.
        Compression::RLE => 64,
        Compression::ZIP1 | Compression::ZIP16 => DEFLATE_RATIO,
        // Huffman coding: 255 repetitions of two bytes take at least 9 bits.
        Compression::PIZ => 454,
        // Three of an f32's four bytes are deflated.
        Compression::PXR24 => DEFLATE_RATIO * 4 / 3,
        // 32 bytes take at least three.
        Compression::B44 | Compression::B44A => 11,
        _ => DWA_RATIO,
    }
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
    let (name, role) = layer_of(&channel.name.to_string(), has, part);
    let at = layers.iter().position(|layer| layer.name == name).unwrap_or_else(|| {
        layers.push(ImageLayer { name, pixels: vec![Rgb::ZERO; count] });
        layers.len() - 1
    });
    for (pixel, value) in layers[at].pixels.iter_mut().zip(channel.sample_data.values_as_f32()) {
        assign(pixel, role, value);
    }
}

/// The layer of a channel, and its role there. `has` says which channels the part has.
fn layer_of(full: &str, has: &dyn Fn(&str) -> bool, part: &str) -> (String, ChannelRole) {
    let (prefix, last) = full.rsplit_once('.').unwrap_or(("", full));
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
    (layer_name([part, prefix, suffix]), role)
}

fn assign(pixel: &mut Rgb, role: ChannelRole, value: f32) {
    match role {
        ChannelRole::Color(axis) => pixel[axis] = value,
        ChannelRole::Grey => *pixel = Rgb::splat(value),
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

    use std::path::PathBuf;

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

    /// A file of 2 x 1 pixels with some bytes after an attribute's name and type replaced in all of
    /// its parts.
    fn patched(parts: usize, attribute: &str, value: &[u8]) -> (tempfile::TempDir, PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        let parts = (0..parts).map(|i| part(&format!("p{i}"), &[("R", 1.0), ("Y", 2.0)])).collect();
        let image = Image::from_layers(
            ImageAttributes::new(IntegerBounds::from_dimensions((2, 1))),
            parts_of(parts),
        );
        image.write().to_file(&path).unwrap();
        let mut bytes = std::fs::read(&path).unwrap();
        let name = attribute.as_bytes();
        let places: Vec<usize> =
            (0..bytes.len()).filter(|&i| bytes[i..].starts_with(name)).collect();
        for place in places {
            // The size of the value, four bytes, stands between.
            let at = place + name.len() + 4;
            bytes[at..at + value.len()].copy_from_slice(value);
        }
        std::fs::write(&path, bytes).unwrap();
        (folder, path)
    }

    fn parts_of(
        parts: Vec<Part<AnyChannels<FlatSamples>>>,
    ) -> SmallVec<[Part<AnyChannels<FlatSamples>>; 2]> {
        parts.into_iter().collect()
    }

    /// Bytes of a window from (0, 0).
    fn window(width: i32, height: i32) -> Vec<u8> {
        [0, 0, width - 1, height - 1].into_iter().flat_map(i32::to_le_bytes).collect()
    }

    const DATA_WINDOW: &str = "dataWindow\0box2i\0";

    #[track_caller]
    fn is_refused(path: &Path) {
        let errors =
            [read_light(path).map(drop), read_layers(path).map(drop), read_parts(path).map(drop)];
        for error in errors {
            let error = error.expect_err("a lie");
            assert!(error.contains("shorter than its header says"), "{error}");
        }
    }

    #[test]
    fn a_size_beyond_any_compression_is_refused() {
        let (_folder, path) = patched(1, DATA_WINDOW, &window(1 << 29, 8));
        let stored = std::fs::read(&path).unwrap();
        let name = b"compression\0compression\0";
        let at =
            (0..stored.len()).find(|&i| stored[i..].starts_with(name)).unwrap() + name.len() + 4;
        for compression in 0..10 {
            let mut bytes = stored.clone();
            bytes[at] = compression;
            std::fs::write(&path, bytes).unwrap();
            is_refused(&path);
        }
    }

    /// Without compression, a part as long as the file could be in it, but not one hundred.
    #[test]
    fn parts_share_the_bytes_of_the_file() {
        for (parts, is_good) in [(1, true), (100, false)] {
            let (_folder, path) = patched(parts, DATA_WINDOW, &window(1, 1));
            let length = i32::try_from(std::fs::metadata(&path).unwrap().len()).unwrap();
            let (_folder, path) = patched(parts, DATA_WINDOW, &window(length / 8, 1));
            match is_good {
                true => assert!(!read_layers(&path).unwrap_err().contains("shorter")),
                false => is_refused(&path),
            }
        }
    }

    #[test]
    fn a_crop_is_placed_in_its_display_window() {
        use crate::image_io::{CropWindow, ImageWriter, WriteOptions, tests::picture};
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        let picture = picture();
        // Whole, cut off at the right and at the bottom, and outside.
        for (offset, [columns, rows]) in
            [([31, 17], [13, 5]), ([30, 18], [10, 2]), ([50, 0], [0, 0])]
        {
            let full_size = [40, 20];
            let crop_window = Some(CropWindow { full_size, offset });
            let full_size = if rows == 5 { [44, 22] } else { full_size };
            let crop_window = crop_window.map(|crop| CropWindow { full_size, ..crop });
            let notes = WriteOptions { crop_window, ..WriteOptions::default() };
            ImageWriter::new(&path).unwrap().write_with(&picture, &notes).unwrap();
            let read = read_light(&path);
            if rows == 0 {
                assert!(read.unwrap_err().contains("outside its display window"));
                continue;
            }
            let read = read.unwrap();
            assert_eq!([read.width, read.height], full_size);
            for (i, &pixel) in read.pixels.iter().enumerate() {
                let (x, y) = (
                    (i % read.width).wrapping_sub(offset[0]),
                    (i / read.width).wrapping_sub(offset[1]),
                );
                let is_inside = x < columns && y < rows;
                let expected = if is_inside { picture.beauty(13 * y + x) } else { Rgb::ZERO };
                assert_eq!(pixel, expected, "{x} {y}");
            }
        }
        // A window that no picture would be so small a part of.
        let crop_window = Some(CropWindow { full_size: [1 << 20, 1 << 19], offset: [0, 0] });
        let notes = WriteOptions { crop_window, ..WriteOptions::default() };
        ImageWriter::new(&path).unwrap().write_with(&picture, &notes).unwrap();
        assert!(read_light(&path).unwrap_err().contains("shorter than its header says"));
    }

    #[test]
    fn luminance_and_chroma_are_refused_and_not_read_as_grey() {
        let parts = parts_of(vec![part("p", &[("BY", 0.0), ("RY", 0.5), ("Y", 1.0)])]);
        let bounds = IntegerBounds::from_dimensions((2, 1));
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        Image::from_layers(ImageAttributes::new(bounds), parts).write().to_file(&path).unwrap();
        let errors = [read_light(&path).unwrap_err(), read_layers(&path).unwrap_err()];
        assert!(errors.iter().all(|error| error.contains("luminance and chroma")), "{errors:?}");
    }
}
