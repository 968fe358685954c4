//! OpenEXR: linear 32-bit float. The beauty is `R G B`, and the other layers (`direct.*`,
//! `albedo.*`, ...) are in the same part, where every viewer finds them. A picture with alpha has
//! the channel `A` and premultiplied colors, as OpenEXR specifies. ZIP is lossless, and the file
//! contains only the picture and its metadata: equal pictures give equal bytes.
//!
//! Blocks of rows are encoded and compressed in parallel ([`parallel`]) and written in order.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom, Write};
use std::ops::Range;
use std::path::Path;

use exr::block::writer::ChunksWriter;
use exr::block::{UncompressedBlock, enumerate_ordered_header_block_indices};
use exr::compression::Compression;
use exr::meta::attribute::{ChannelDescription, LineOrder, SampleType};
use exr::meta::header::{Header, ImageAttributes, LayerAttributes};
use exr::meta::{BlockDescription, MetaData};
use exr::prelude::{AttributeValue, IntegerBounds, Text, Vec2};

use crate::color::Rgb;
use crate::task::parallel;

use super::atomic_file::Sink;
use super::notes::{CropWindow, WriteOptions};
use super::picture::{ChannelValues, ImageChannel, Picture};
use super::read::BEAUTY;
use super::record::MetadataEntry;

/// Files with more bytes of pixels than this are compressed less if `fast` is set.
const LARGE_IMAGE: usize = 32 << 20;

/// Blocks that each thread encodes before they are written.
const BLOCKS_PER_THREAD: usize = 4;

/// Bytes of the magic number and the version; the attributes follow.
const HEADER_BYTES: u64 = 8;

/// A channel in the file.
struct Channel<'a> {
    name: String,
    values: ChannelData<'a>,
}

/// Where a channel's values come from.
#[derive(Clone, Copy)]
enum ChannelData<'a> {
    Beauty(usize),
    Color(&'a [Rgb], usize),
    Float(&'a [f32]),
    Uint(&'a [u32]),
}

/// Writes the beauty and all layers. A crop is placed within the full picture's display window.
pub(super) fn write(picture: &Picture, notes: &WriteOptions, to: &mut Sink) -> io::Result<()> {
    let size = [picture.width, picture.height];
    let corner = notes.crop_window.map_or([0; 2], |crop| crop.offset);
    let overlay = notes.overlay.as_ref().map(|overlay| overlay.linear_channels(size, corner));
    let overlay = overlay.as_ref().map_or(&[][..], |channels| channels);
    let channels = channels(picture, overlay);
    let headers = vec![header(picture, &channels, notes)];
    exr::block::write(&mut *to, headers.into(), true, |meta, file| {
        let blocks: Vec<_> = enumerate_ordered_header_block_indices(&meta.headers).collect();
        for some in blocks.chunks(BLOCKS_PER_THREAD * parallel::thread_count()) {
            let compressed = parallel::map(some.to_vec(), |(at, index)| {
                let rows = index.pixel_position.1..index.pixel_position.1 + index.pixel_size.1;
                let data = encode_rows(picture, &channels, rows);
                (at, UncompressedBlock { index, data }.compress_to_chunk(&meta.headers))
            });
            for (at, chunk) in compressed {
                file.write_chunk(at, chunk?)?;
            }
        }
        Ok(())
    })
    .map_err(|e| match e {
        exr::error::Error::Io(e) => e,
        other => io::Error::other(other),
    })?;
    to.flush()?;
    sort_attributes(to.get_mut())
}

/// All channels, sorted by name as OpenEXR requires.
fn channels<'a>(picture: &'a Picture, overlay: &'a [(&'static str, Vec<f32>)]) -> Vec<Channel<'a>> {
    let mut channels = Vec::new();
    let mut add = |name: String, values| channels.push(Channel { name, values });
    for (axis, name) in ["R", "G", "B"].into_iter().enumerate() {
        if !picture.hidden_layers.contains(&BEAUTY) {
            add(name.to_owned(), ChannelData::Beauty(axis));
        }
        let layers = [("direct", &picture.direct), ("indirect", &picture.indirect)];
        for (layer, values) in
            layers.into_iter().filter(|(layer, _)| !picture.hidden_layers.contains(layer))
        {
            add(format!("{layer}.{name}"), ChannelData::Color(values, axis));
        }
    }
    for ImageChannel { name, values } in &picture.channels {
        let values = match values {
            ChannelValues::Float(values) => ChannelData::Float(values),
            ChannelValues::Uint(values) => ChannelData::Uint(values),
        };
        add(name.clone(), values);
    }
    for (name, values) in overlay {
        add((*name).to_owned(), ChannelData::Float(values));
    }
    if let Some(alpha) = &picture.alpha {
        add("A".to_owned(), ChannelData::Float(alpha));
    }
    channels.sort_by(|a, b| a.name.cmp(&b.name));
    channels
}

fn header(picture: &Picture, channels: &[Channel<'_>], notes: &WriteOptions) -> Header {
    let mut attributes = LayerAttributes {
        software_name: Some(Text::from(concat!("photosphere ", env!("CARGO_PKG_VERSION")))),
        ..LayerAttributes::default()
    };
    let mut add = |name: &str, text: &str| {
        let text = Text::from_slice_unchecked(text.as_bytes());
        attributes.other.insert(Text::from(name), AttributeValue::Text(text));
    };
    picture.attributes.iter().for_each(|(name, text)| add(name, text));
    notes.metadata.iter().for_each(|record| add(&record.key(), &record.text));
    let size = Vec2(picture.width, picture.height);
    let mut shared = ImageAttributes::with_size(size);
    if let Some(CropWindow { full_size: [width, height], offset: [x, y] }) = notes.crop_window {
        attributes.layer_position = Vec2(x as i32, y as i32);
        shared.display_window = IntegerBounds::from_dimensions((width, height));
    }
    let is_large = picture.len() * channels.len() * size_of::<f32>() > LARGE_IMAGE;
    let compression = match notes.fast && is_large {
        true => Compression::RLE,
        false => Compression::ZIP16,
    };
    let description = |channel: &Channel<'_>| {
        let kind = match channel.values {
            ChannelData::Uint(_) => SampleType::U32,
            _ => SampleType::F32,
        };
        ChannelDescription::named(channel.name.as_str(), kind)
    };
    Header::new(Text::from(""), size, channels.iter().map(description).collect())
        .with_encoding(compression, BlockDescription::ScanLines, LineOrder::Increasing)
        .with_attributes(attributes)
        .with_shared_attributes(shared)
}

/// Encodes some rows; within a row, channel after channel.
fn encode_rows(picture: &Picture, channels: &[Channel<'_>], rows: Range<usize>) -> Vec<u8> {
    let mut bytes =
        Vec::with_capacity(rows.len() * picture.width * channels.len() * size_of::<f32>());
    for row in rows {
        let pixels = row * picture.width..(row + 1) * picture.width;
        for channel in channels {
            match channel.values {
                ChannelData::Beauty(axis) => pixels
                    .clone()
                    .for_each(|pixel| bytes.extend(picture.beauty(pixel)[axis].to_ne_bytes())),
                ChannelData::Color(values, axis) => values[pixels.clone()]
                    .iter()
                    .for_each(|value| bytes.extend(value[axis].to_ne_bytes())),
                ChannelData::Float(values) => {
                    values[pixels.clone()].iter().for_each(|v| bytes.extend(v.to_ne_bytes()));
                }
                ChannelData::Uint(values) => {
                    values[pixels.clone()].iter().for_each(|v| bytes.extend(v.to_ne_bytes()));
                }
            }
        }
    }
    bytes
}

/// Sorts the attributes of a finished single-part file by name, as the OpenEXR library does. The
/// crate writes them in hash map order, which is random.
fn sort_attributes(file: &mut File) -> io::Result<()> {
    file.seek(SeekFrom::Start(HEADER_BYTES))?;
    let mut attributes = Vec::new();
    let mut from = BufReader::new(&mut *file);
    loop {
        // Name and type, each zero-terminated; then the size in bytes and the data.
        let mut attribute = Vec::new();
        from.read_until(0, &mut attribute)?;
        if attribute.len() <= 1 {
            break;
        }
        from.read_until(0, &mut attribute)?;
        let mut size = [0; 4];
        from.read_exact(&mut size)?;
        attribute.extend(size);
        from.by_ref().take(u32::from_le_bytes(size).into()).read_to_end(&mut attribute)?;
        attributes.push(attribute);
    }
    attributes.sort();
    file.seek(SeekFrom::Start(HEADER_BYTES))?;
    file.write_all(&attributes.concat())?;
    file.seek(SeekFrom::End(0)).map(|_| ())
}

/// Reads the metadata of a file.
pub(super) fn read_metadata(path: &Path) -> Result<Vec<MetadataEntry>, String> {
    let meta = MetaData::read_from_file(path, false).map_err(|e| e.to_string())?;
    let header = meta.headers.first().ok_or("it has no parts")?;
    let shared = header.shared_attributes.other.iter();
    let record = |(name, value): (&Text, &AttributeValue)| match value {
        AttributeValue::Text(text) => {
            let text = String::from_utf8_lossy(text.as_slice()).into_owned();
            MetadataEntry::from_key(&name.to_string(), text)
        }
        _ => None,
    };
    Ok(header.own_attributes.other.iter().chain(shared).filter_map(record).collect())
}

#[cfg(test)]
mod tests {
    use super::super::ImageWriter;
    use super::super::tests::{picture, written};
    use super::*;

    #[test]
    fn layers_come_back_to_the_bit_and_add_up_to_the_beauty() {
        let picture = picture();
        let (_folder, path) = written(&picture, "a.exr");
        let image = exr::prelude::read_first_flat_layer_from_file(&path).unwrap();
        assert_eq!((image.layer_data.size.0, image.layer_data.size.1), (13, 5));
        let channels = &image.layer_data.channel_data.list;
        let read = |name: &str| -> Vec<f32> {
            let channel = channels.iter().find(|channel| channel.name.eq(name)).unwrap();
            channel.sample_data.values_as_f32().collect()
        };
        for (axis, name) in ["R", "G", "B"].into_iter().enumerate() {
            let beauty = read(name);
            let direct = read(&format!("direct.{name}"));
            let indirect = read(&format!("indirect.{name}"));
            for pixel in 0..picture.len() {
                assert_eq!(direct[pixel], picture.direct[pixel][axis]);
                assert_eq!(indirect[pixel], picture.indirect[pixel][axis]);
                let sum = f64::from(direct[pixel]) + f64::from(indirect[pixel]);
                let ulp = f64::from(beauty[pixel]) * f64::from(f32::EPSILON);
                assert!((f64::from(beauty[pixel]) - sum).abs() <= ulp);
            }
        }
        assert_eq!(channels.len(), 9);
    }

    #[test]
    fn alpha_stands_beside_the_colours_as_they_are() {
        let mut picture = picture();
        let alpha: Vec<f32> = (0..picture.len()).map(|i| i as f32 / 64.0).collect();
        picture.alpha = Some(alpha.clone());
        let (_folder, path) = written(&picture, "a.exr");
        let image = exr::prelude::read_first_flat_layer_from_file(&path).unwrap();
        let channels = &image.layer_data.channel_data.list;
        let read = |name: &str| -> Vec<f32> {
            let channel = channels.iter().find(|channel| channel.name.eq(name)).unwrap();
            channel.sample_data.values_as_f32().collect()
        };
        assert_eq!(read("A"), alpha);
        assert_eq!(read("R")[3], picture.beauty(3).x);
    }

    #[test]
    fn a_crop_lies_in_the_whole_picture() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        let cropped_from = Some(CropWindow { full_size: [640, 480], offset: [31, 17] });
        let notes = WriteOptions { crop_window: cropped_from, ..WriteOptions::default() };
        ImageWriter::new(&path).unwrap().write_with(&picture(), &notes).unwrap();
        let image = exr::prelude::read_first_flat_layer_from_file(&path).unwrap();
        assert_eq!(image.attributes.display_window.size, Vec2(640, 480));
        let attributes = &image.layer_data.attributes;
        assert_eq!(attributes.layer_position, Vec2(31, 17));
    }

    /// A large file has equal values with fast compression, and equal bytes on several threads.
    #[test]
    fn a_large_picture_is_the_same_however_it_is_written() {
        let (width, height) = (2048, 700);
        let layer = |scale: f32| -> Vec<Rgb> {
            let value = |i: usize| Rgb::new((i % 191) as f32, 0.3, (i / 7) as f32) * scale;
            (0..width * height).map(value).collect()
        };
        let (direct, indirect) = (layer(0.01), layer(0.3));
        let large = Picture { width, height, direct, indirect, ..Picture::default() };
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, quickly: bool| {
            let path = folder.path().join(name);
            let notes = WriteOptions { fast: quickly, ..WriteOptions::default() };
            ImageWriter::new(&path).unwrap().write_with(&large, &notes).unwrap();
            path
        };
        let small = write("small.exr", false);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().unwrap();
        let (quick, again) = pool.install(|| (write("quick.exr", true), write("again.exr", false)));
        assert!(std::fs::read(&small).unwrap() == std::fs::read(again).unwrap());
        let values = |path: &Path| crate::image_io::read_raw_channels(path).unwrap();
        assert!(values(&small) == values(&quick));
        let bytes = |path: &Path| std::fs::metadata(path).unwrap().len();
        assert!(bytes(&quick) > bytes(&small));
    }

    #[test]
    fn equal_pictures_have_equal_bytes() {
        let (a, b) = (written(&picture(), "a.exr"), written(&picture(), "b.exr"));
        assert_eq!(std::fs::read(a.1).unwrap(), std::fs::read(b.1).unwrap());
    }
}
