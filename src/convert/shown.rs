//! How a layer becomes one picture.

use crate::color::{Rgb, ViewTransform, luminance};
use crate::error::{Error, Result};
use crate::image_io::FileFormat;

use super::false_color::{self, FalseColorPicture};
use super::options::ConvertOptions;
use super::source::{LayerKind, Source, SourceLayer};

/// A layer as the only picture of a file.
pub(super) enum Shown {
    /// Values that the format stores as they are, or light for the screen.
    Values(Vec<Rgb>),
    /// Numbers as colours.
    FalseColors(Box<FalseColorPicture>),
}

impl Shown {
    /// Shows a layer in a file of this format.
    ///
    /// # Errors
    /// If the options suit the layer or the format no more, or no pixel has a number.
    pub(super) fn new(
        source: &Source,
        layer: &SourceLayer,
        to: FileFormat,
        options: &ConvertOptions,
    ) -> Result<Self> {
        let (kind, map) = (layer.kind(), options.false_colors.map);
        if !to.is_display_referred() {
            return Ok(Self::Values(layer.pixels()));
        }
        if kind == LayerKind::Light && map.is_none() {
            return Ok(Self::Values(layer.pixels()));
        }
        if options.look != ViewTransform::default() {
            let message = format!(
                "tone, exposure and dithering are for light, but the layer `{}` is shown in false \
                 colours",
                layer.name
            );
            return Err(Error::input(message).with_help("leave them out"));
        }
        Ok(Self::FalseColors(Box::new(match kind {
            LayerKind::Number => {
                false_color::numbers(&layer.name, &layer.numbers(), source.size, options)?
            }
            LayerKind::Id => false_color::ids(&layer.numbers()),
            LayerKind::Vector => false_color::vectors(&layer.pixels(), layer.name == "normal"),
            LayerKind::Light => {
                let light = layer.pixels();
                let values: Vec<f64> = light.iter().map(|c| f64::from(luminance(*c))).collect();
                let name = format!("luminance of {}", layer.name);
                false_color::numbers(&name, &values, source.size, options)?
            }
        })))
    }
}
