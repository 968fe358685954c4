//! What a user may choose of view, light and surroundings.

use crate::appearance::{ViewDirection, named_color};
use crate::color::Rgb;
use crate::math::DVec3;

use super::style::Style;

/// View, light and surroundings of particles.
#[derive(Clone, Debug, PartialEq)]
pub struct StudioOptions {
    /// Where the camera stands.
    pub view: Option<ViewDirection>,
    /// The axis that points up.
    pub up: DVec3,
    /// Enlarges the picture about its centre.
    pub zoom: f64,
    /// True for parallel rays.
    pub orthographic: bool,
    /// Light, material and surroundings.
    pub style: Style,
    /// The name of a material that replaces that of the style; see [`super::style::MATERIALS`].
    pub material: Option<String>,
    /// True if the particles lie on a ground; `None` lets style and view decide.
    pub ground: Option<bool>,
    /// What is behind the particles; `None` is that of the style.
    pub background: Option<Background>,
    /// Shares of the picture that stay free: left, right, top, bottom.
    pub margins: [f64; 4],
}

/// What is behind the particles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Background {
    /// Nothing: pictures have an alpha channel.
    Transparent,
    /// This linear colour.
    Color(Rgb),
}

impl Default for StudioOptions {
    /// The studio, seen from the front, right and above; z up.
    fn default() -> Self {
        Self {
            view: None,
            up: DVec3::Z,
            zoom: 1.0,
            orthographic: false,
            style: Style::default(),
            material: None,
            ground: None,
            background: None,
            margins: [0.07; 4],
        }
    }
}

impl Background {
    /// Parses `none`, or a colour by name or as `#rrggbb`.
    pub fn parse(text: &str) -> Option<Self> {
        match text {
            "none" => Some(Self::Transparent),
            _ => named_color(text).map(Self::Color),
        }
    }
}
