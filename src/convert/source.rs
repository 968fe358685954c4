//! A picture file as layers of channels with their types.

use std::path::Path;

use crate::color::Rgb;
use crate::error::Result;
use crate::image_io::{
    self, BEAUTY, ChannelValues, FileFormat, ImageChannel, MetadataEntry, PngDepth, StoredPicture,
    read_image, read_png_depth, read_stored,
};
use crate::job::Metadata;

/// The layer of opacities.
pub(super) const ALPHA: &str = "alpha";

/// A picture that was read.
#[derive(Debug)]
pub(super) struct Source {
    pub(super) format: FileFormat,
    /// How finely a PNG file stores its values.
    pub(super) png_depth: Option<PngDepth>,
    pub(super) size: [usize; 2],
    /// Column and row of the first pixel in the full picture.
    pub(super) offset: [usize; 2],
    pub(super) full_size: [usize; 2],
    pub(super) layers: Vec<SourceLayer>,
    /// Texts of the file that are not records of ours.
    pub(super) attributes: Vec<(String, String)>,
    /// How it was made, if the file says so in a way that this version understands.
    pub(super) metadata: Option<Metadata>,
    /// True if the file says at all how it was made.
    pub(super) has_records: bool,
}

/// A layer: its channels, in the order of the file.
#[derive(Debug)]
pub(super) struct SourceLayer {
    pub(super) name: String,
    pub(super) channels: Vec<ImageChannel>,
}

/// What the numbers of a layer are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LayerKind {
    /// Light, or colours of surfaces.
    Light,
    /// One number per pixel.
    Number,
    /// The number of something in each pixel.
    Id,
    /// Three coordinates.
    Vector,
}

impl Source {
    /// Reads a picture of any format.
    ///
    /// # Errors
    /// If it cannot be read.
    pub(super) fn read(path: &Path, format: FileFormat) -> Result<Self> {
        let source = match format {
            FileFormat::Exr => Self::of_stored(read_stored(path)?),
            FileFormat::Png | FileFormat::Hdr | FileFormat::Pfm => Self::of_pixels(path, format)?,
        };
        let records = match format {
            FileFormat::Exr | FileFormat::Png => image_io::read_metadata(path)?,
            FileFormat::Hdr | FileFormat::Pfm => Vec::new(),
        };
        let metadata = Metadata::from_records(path, &records).ok();
        let is_foreign = |name: &str| !MetadataEntry::is_ours(name);
        let attributes = source.attributes.into_iter().filter(|(name, _)| is_foreign(name));
        let has_records = !records.is_empty();
        let png_depth = match format {
            FileFormat::Png => Some(read_png_depth(path)?),
            FileFormat::Exr | FileFormat::Hdr | FileFormat::Pfm => None,
        };
        let attributes = attributes.collect();
        Ok(Self { png_depth, attributes, metadata, has_records, ..source })
    }

    fn of_stored(stored: StoredPicture) -> Self {
        let mut layers: Vec<SourceLayer> = Vec::new();
        for (name, channel) in stored.channels {
            match layers.iter_mut().find(|layer| layer.name == name) {
                Some(layer) => layer.channels.push(channel),
                None => layers.push(SourceLayer { name, channels: vec![channel] }),
            }
        }
        Self {
            format: FileFormat::Exr,
            png_depth: None,
            size: stored.size,
            // A picture beyond its display window is one of its own.
            offset: stored.offset.map(|first| usize::try_from(first).unwrap_or(0)),
            full_size: stored.full_size,
            layers,
            attributes: stored.attributes,
            metadata: None,
            has_records: false,
        }
    }

    fn of_pixels(path: &Path, format: FileFormat) -> Result<Self> {
        let image = read_image(path)?;
        let layers = image.layers.iter().map(|layer| {
            let names: &[&str] = if layer.name == ALPHA { &["A"] } else { &["R", "G", "B"] };
            let channel = |(axis, name): (usize, &&str)| {
                let values = layer.pixels.iter().map(|pixel| pixel[axis]).collect();
                ImageChannel::new(name, ChannelValues::Float(values))
            };
            let channels = names.iter().enumerate().map(channel).collect();
            SourceLayer { name: layer.name.clone(), channels }
        });
        let size = [image.width, image.height];
        Ok(Self {
            format,
            png_depth: None,
            size,
            offset: [0; 2],
            full_size: size,
            layers: layers.collect(),
            attributes: Vec::new(),
            metadata: None,
            has_records: false,
        })
    }

    pub(super) fn layer(&self, name: &str) -> Option<&SourceLayer> {
        self.layers.iter().find(|layer| layer.name == name)
    }

    /// Names of the layers, with the picture itself first.
    pub(super) fn layer_names(&self) -> String {
        let mut names: Vec<&str> = self.layers.iter().map(|layer| &*layer.name).collect();
        names.sort_by_key(|name| *name != BEAUTY);
        names.join(", ")
    }
}

impl SourceLayer {
    pub(super) fn kind(&self) -> LayerKind {
        let ends = |end: &str| self.channels.iter().any(|channel| channel.name.ends_with(end));
        match self.name.as_str() {
            BEAUTY | ALPHA => LayerKind::Light,
            "sphere_id" | "material_id" => LayerKind::Id,
            _ if self.channels.len() == 1 => LayerKind::Number,
            _ if [".X", ".Y", ".Z"].into_iter().all(ends) => LayerKind::Vector,
            _ => LayerKind::Light,
        }
    }

    /// The colours of each pixel, or the one number three times.
    pub(super) fn pixels(&self) -> Vec<Rgb> {
        let count = self.channels.first().map_or(0, |channel| length(&channel.values));
        let mut pixels = vec![Rgb::ZERO; count];
        for channel in &self.channels {
            let axis = match channel.name.rsplit('.').next() {
                _ if self.channels.len() == 1 => None,
                Some("R" | "X" | "r" | "red") => Some(0),
                Some("G" | "Y" | "g" | "green") => Some(1),
                Some("B" | "Z" | "b" | "blue") => Some(2),
                _ => continue,
            };
            for (at, pixel) in pixels.iter_mut().enumerate() {
                let value = get(&channel.values, at) as f32;
                match axis {
                    Some(axis) => pixel[axis] = value,
                    None => *pixel = Rgb::splat(value),
                }
            }
        }
        pixels
    }

    /// The numbers of the first channel; NaN where an id says that there is nothing.
    pub(super) fn numbers(&self) -> Vec<f64> {
        let Some(channel) = self.channels.first() else { return Vec::new() };
        (0..length(&channel.values)).map(|at| get(&channel.values, at)).collect()
    }
}

fn length(values: &ChannelValues) -> usize {
    match values {
        ChannelValues::Float(values) => values.len(),
        ChannelValues::Uint(values) => values.len(),
    }
}

/// A value of a channel; the largest whole number, which names nothing, is NaN.
fn get(values: &ChannelValues, at: usize) -> f64 {
    match values {
        ChannelValues::Float(values) => f64::from(values[at]),
        ChannelValues::Uint(values) if values[at] == u32::MAX => f64::NAN,
        ChannelValues::Uint(values) => f64::from(values[at]),
    }
}
