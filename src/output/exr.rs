//! OpenEXR: linear 32-bit float, the beauty as `R G B` and the other layers (`direct.*`, `albedo.*`, ...)
//! beside it in one part, where every viewer finds them. A picture with alpha
//! has that as the channel `A`, with which the colours are multiplied, as OpenEXR has it. ZIP loses nothing, and
//! nothing but the picture and its records enters the file: equal ones have equal bytes.
//!
//! The `exr` crate is generic to its core; this file asks it for one concrete kind of image only,
//! because every other kind would be compiled anew.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom, Write};
use std::path::Path;

use exr::meta::MetaData;
use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Encoding, FlatSamples, Image, IntegerBounds,
    Layer as Part, LayerAttributes, SmallVec, Text, Vec2, WritableImage,
};

use crate::color::Rgb;
use crate::film::{Layer, Picture, Plane, Values};

use super::{Crop, Notes, Record, Sink};

/// Bytes of the magic number and the version, which the attributes follow.
const HEAD: u64 = 8;

/// Writes the beauty and both layers. A cropped picture lies in the window of the whole one.
pub(super) fn write(picture: &Picture, notes: &Notes, to: &mut Sink) -> io::Result<()> {
    let mut channels = SmallVec::new();
    let pixels = 0..picture.len();
    for (axis, name) in ["R", "G", "B"].into_iter().enumerate() {
        let mut add = |name: String, value: &dyn Fn(usize) -> Rgb| {
            let samples = pixels.clone().map(|pixel| value(pixel)[axis]).collect();
            channels.push(AnyChannel::new(Text::from(name.as_str()), FlatSamples::F32(samples)));
        };
        add(name.to_owned(), &|pixel| picture.beauty(pixel));
        for (layer, values) in
            [(Layer::Direct, &picture.direct), (Layer::Indirect, &picture.indirect)]
        {
            if !picture.left_out.contains(&layer) {
                add(format!("{}.{name}", layer.name()), &|pixel| values[pixel]);
            }
        }
    }
    for Plane { name, values } in &picture.planes {
        let samples = match values {
            Values::Float(values) => FlatSamples::F32(values.clone()),
            Values::Whole(values) => FlatSamples::U32(values.clone()),
        };
        channels.push(AnyChannel::new(Text::from(name.as_str()), samples));
    }
    if let Some(alpha) = &picture.alpha {
        channels.push(AnyChannel::new(Text::from("A"), FlatSamples::F32(alpha.clone())));
    }
    let mut attributes = LayerAttributes {
        software_name: Some(Text::from(concat!("photosphere ", env!("CARGO_PKG_VERSION")))),
        ..LayerAttributes::default()
    };
    for (name, text) in &picture.attributes {
        let text = Text::from_slice_unchecked(text.as_bytes());
        attributes.other.insert(Text::from(name.as_str()), AttributeValue::Text(text));
    }
    for record in &notes.records {
        let text = Text::from_slice_unchecked(record.text.as_bytes());
        attributes.other.insert(Text::from(record.key().as_str()), AttributeValue::Text(text));
    }
    if let Some(Crop { corner: [x, y], .. }) = notes.cropped_from {
        attributes.layer_position = Vec2(x as i32, y as i32);
    }
    let size = (picture.width, picture.height);
    let layer = Part::new(size, attributes, Encoding::SMALL_LOSSLESS, AnyChannels::sort(channels));
    let mut image = Image::from_layer(layer);
    if let Some(Crop { full_size: [width, height], .. }) = notes.cropped_from {
        image.attributes.display_window = IntegerBounds::from_dimensions((width, height));
    }
    image.write().non_parallel().to_buffered(&mut *to).map_err(|e| match e {
        exr::error::Error::Io(e) => e,
        other => io::Error::other(other),
    })?;
    to.flush()?;
    sort_attributes(to.get_mut())
}

/// Brings the attributes of a finished file with one part into the order of their names, as OpenEXR's
/// own library writes them: the crate's order is that of a hash map, which chance decides.
fn sort_attributes(file: &mut File) -> io::Result<()> {
    file.seek(SeekFrom::Start(HEAD))?;
    let mut attributes = Vec::new();
    let mut from = BufReader::new(&mut *file);
    loop {
        // The name, the type, both ended by a zero; the number of bytes, and they.
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
    file.seek(SeekFrom::Start(HEAD))?;
    file.write_all(&attributes.concat())?;
    file.seek(SeekFrom::End(0)).map(|_| ())
}

/// The records of a file.
pub(super) fn records(path: &Path) -> Result<Vec<Record>, String> {
    let meta = MetaData::read_from_file(path, false).map_err(|e| e.to_string())?;
    let header = meta.headers.first().ok_or("it has no parts")?;
    let shared = header.shared_attributes.other.iter();
    let record = |(name, value): (&Text, &AttributeValue)| match value {
        AttributeValue::Text(text) => {
            let text = String::from_utf8_lossy(text.as_slice()).into_owned();
            Record::of_file(&name.to_string(), text)
        }
        _ => None,
    };
    Ok(header.own_attributes.other.iter().chain(shared).filter_map(record).collect())
}

#[cfg(test)]
mod tests {
    use super::super::Target;
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
        let cropped_from = Some(Crop { full_size: [640, 480], corner: [31, 17] });
        let notes = Notes { cropped_from, ..Notes::default() };
        Target::new(&path).unwrap().write_with(&picture(), &notes).unwrap();
        let image = exr::prelude::read_first_flat_layer_from_file(&path).unwrap();
        assert_eq!(image.attributes.display_window.size, Vec2(640, 480));
        let attributes = &image.layer_data.attributes;
        assert_eq!(attributes.layer_position, Vec2(31, 17));
    }

    #[test]
    fn equal_pictures_have_equal_bytes() {
        let (a, b) = (written(&picture(), "a.exr"), written(&picture(), "b.exr"));
        assert_eq!(std::fs::read(a.1).unwrap(), std::fs::read(b.1).unwrap());
    }
}
