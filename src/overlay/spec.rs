//! What is drawn, as plain values.

use serde::{Deserialize, Serialize};

use crate::appearance::ColorMap;

/// What a user wants to see over a picture.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OverlayChoice {
    /// True for a colour bar or legend, where colours mean something.
    pub legend: bool,
    /// The title of the colour bar or legend; `None` is the name of the column.
    pub title: Option<String>,
    /// True for a scale bar.
    pub scale_bar: bool,
    /// The unit of length at the scale bar; `None` is that of the file.
    pub unit: Option<String>,
    /// True for the axes.
    pub tripod: bool,
    /// Size of texts in points.
    pub font_size: Option<f64>,
}

impl Default for OverlayChoice {
    /// A legend, where colours mean something.
    fn default() -> Self {
        Self {
            legend: true,
            title: None,
            scale_bar: false,
            unit: None,
            tripod: false,
            font_size: None,
        }
    }
}

/// What is drawn over a picture.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OverlaySpec {
    /// Width and height of the full picture, in pixels.
    pub size: [u32; 2],
    /// Size of texts (the em) in pixels.
    pub font_pixels: f64,
    /// True for light ink, on a dark picture.
    pub light_ink: bool,
    /// The legend.
    pub legend: LegendSpec,
    /// The scale bar.
    pub scale_bar: Option<ScaleBarSpec>,
    /// Each axis as it appears in the picture: to the right and up, at most 1 long.
    pub tripod: Option<[[f64; 2]; 3]>,
}

/// A legend.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum LegendSpec {
    /// Nothing.
    #[default]
    Nothing,
    /// A colour bar.
    Bar {
        /// What the numbers are, with their unit.
        title: String,
        /// The map.
        map: ColorMap,
        /// The numbers at its ends.
        ends: [f64; 2],
        /// True if it goes with the logarithm.
        log: bool,
        /// True for each end that is pointed, because there are numbers beyond it, which have its
        /// colour.
        #[serde(default, skip_serializing_if = "is_within")]
        exceeded: [bool; 2],
    },
    /// Names with colours.
    Categories {
        /// What they are; may be empty.
        title: String,
        /// Each name with its 8-bit sRGB colour.
        entries: Vec<(String, [u8; 3])>,
    },
}

fn is_within(exceeded: &[bool; 2]) -> bool {
    *exceeded == [false; 2]
}

/// A scale bar.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ScaleBarSpec {
    /// Pixels that a unit of length takes, where the camera looks at.
    pub pixels_per_unit: f64,
    /// The unit; may be empty.
    pub unit: String,
}
