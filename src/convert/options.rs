//! What a conversion is asked for, as plain values.

use std::sync::Arc;

use crate::appearance::{ColorMap, RangeChoice};
use crate::color::ViewTransform;
use crate::denoise::Denoiser;
use crate::image_io::PngDepth;
use crate::math::Rect;
use crate::overlay::OverlayChoice;

/// How a picture is converted.
#[derive(Clone, Debug, Default)]
pub struct ConvertOptions {
    /// The layers to keep, by name; none for all of them, or for the picture itself in a format
    /// without layers.
    pub layers: Vec<String>,
    /// The pixels to keep, in the full picture.
    pub crop: Option<Rect>,
    /// Denoises the picture first: its layer `denoised` is added, and shown where one layer is.
    pub denoiser: Option<Arc<Denoiser>>,
    /// The view transform of a file for the screen; the usual one shows a picture that is already
    /// for the screen unchanged.
    pub look: ViewTransform,
    /// Bits per channel of a PNG file.
    pub png_depth: PngDepth,
    /// The resolution for print that a PNG file records, in pixels per inch.
    pub dpi: Option<u32>,
    /// The colours of numbers.
    pub false_colors: FalseColors,
    /// What is drawn over a picture of numbers: a colour bar. What was over the picture stays
    /// unless no legend is wanted.
    pub overlay: OverlayChoice,
}

/// How numbers become colours.
#[derive(Clone, Copy, Debug, Default)]
pub struct FalseColors {
    /// The colour map, also for layers of light, whose luminance it then shows; `None` is viridis
    /// for layers of numbers alone.
    pub map: Option<ColorMap>,
    /// The range of numbers that the map covers.
    pub range: RangeChoice,
    /// True if the map goes with the logarithm.
    pub log: bool,
}

impl ConvertOptions {
    /// Returns true if a layer with this name is to be kept.
    pub(super) fn keeps(&self, layer: &str) -> bool {
        self.layers.is_empty() || self.layers.iter().any(|name| is_meant(name, layer))
    }
}

/// Returns true if the name of a layer, as a user gives it, means this layer. A Cryptomatte has
/// several, and an opacity goes with its layer.
pub(super) fn is_meant(name: &str, layer: &str) -> bool {
    let Some(rest) = layer.strip_prefix(name) else { return false };
    let is_rank = rest.len() == 2 && rest.bytes().all(|byte| byte.is_ascii_digit());
    rest.is_empty() || is_rank || rest == ".alpha" || is_rank_alpha(rest)
}

fn is_rank_alpha(rest: &str) -> bool {
    rest.strip_suffix(".alpha").is_some_and(|rank| rank.len() == 2 && rank.parse::<u8>().is_ok())
}
