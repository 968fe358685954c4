//! OpenEXR: linear 32-bit float, the beauty as `R G B` and the layers `direct.*` and `indirect.*`
//! beside it in one part, where every viewer finds them. A picture with alpha
//! has that as the channel `A`, with which the colours are multiplied, as OpenEXR has it. ZIP loses nothing, and neither time nor
//! machine enter the file: equal pictures have equal bytes.
//!
//! The `exr` crate is generic to its core; this file asks it for one concrete kind of image only,
//! because every other kind would be compiled anew.

use std::io;

use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Encoding, FlatSamples, Image, IntegerBounds, Layer,
    LayerAttributes, SmallVec, Text, Vec2, WritableImage,
};

use crate::color::Rgb;
use crate::film::Picture;

use super::{BIASED, Crop, Notes, Sink};

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
        add(format!("direct.{name}"), &|pixel| picture.direct[pixel]);
        add(format!("indirect.{name}"), &|pixel| picture.indirect[pixel]);
    }
    if let Some(alpha) = &picture.alpha {
        channels.push(AnyChannel::new(Text::from("A"), FlatSamples::F32(alpha.clone())));
    }
    let mut attributes = LayerAttributes {
        software_name: Some(Text::from(concat!("photosphere ", env!("CARGO_PKG_VERSION")))),
        ..LayerAttributes::default()
    };
    if let Some(biased) = notes.biased() {
        let value = AttributeValue::Text(Text::from(biased.as_str()));
        attributes.other.insert(Text::from(BIASED), value);
    }
    if let Some(Crop { corner: [x, y], .. }) = notes.cropped_from {
        attributes.layer_position = Vec2(x as i32, y as i32);
    }
    let size = (picture.width, picture.height);
    let layer = Layer::new(size, attributes, Encoding::SMALL_LOSSLESS, AnyChannels::sort(channels));
    let mut image = Image::from_layer(layer);
    if let Some(Crop { full_size: [width, height], .. }) = notes.cropped_from {
        image.attributes.display_window = IntegerBounds::from_dimensions((width, height));
    }
    image.write().non_parallel().to_buffered(to).map_err(|e| match e {
        exr::error::Error::Io(e) => e,
        other => io::Error::other(other),
    })
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
    fn a_crop_lies_in_the_whole_picture_and_bias_has_a_name() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        let cropped_from = Some(Crop { full_size: [640, 480], corner: [31, 17] });
        let notes = Notes { cropped_from, biased_by: vec!["max_depth = 5".to_owned()] };
        Target::new(&path).unwrap().write_with(&picture(), &notes).unwrap();
        let image = exr::prelude::read_first_flat_layer_from_file(&path).unwrap();
        assert_eq!(image.attributes.display_window.size, Vec2(640, 480));
        let attributes = &image.layer_data.attributes;
        assert_eq!(attributes.layer_position, Vec2(31, 17));
        let biased = attributes.other.get(&Text::from(BIASED)).unwrap();
        assert_eq!(*biased, AttributeValue::Text(Text::from("max_depth = 5")));
    }

    #[test]
    fn equal_pictures_have_equal_bytes() {
        let (a, b) = (written(&picture(), "a.exr"), written(&picture(), "b.exr"));
        assert_eq!(std::fs::read(a.1).unwrap(), std::fs::read(b.1).unwrap());
    }
}
