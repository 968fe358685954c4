//! What a user may choose of the look of particles.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::color_map::ColorMap;
use super::value_range::RangeChoice;

/// The look of particles, as plain values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Appearance {
    /// A condition: other particles are left out, as if the file lacked them.
    pub select: Option<String>,
    /// A condition: particles that fulfil it are hidden, and everything else stays as it was.
    pub slice: Option<String>,
    /// The radii.
    pub radius: RadiusChoice,
    /// Multiplies all radii.
    pub radius_scale: f64,
    /// The colours.
    pub color: ColorChoice,
    /// The colour map for numbers.
    pub colormap: ColorMap,
    /// The range of numbers that the map covers.
    pub range: RangeChoice,
    /// True if the map goes with the logarithm of the numbers.
    pub log: bool,
    /// True if particles outside of the cell move to their periodic images inside.
    pub wrap: bool,
    /// True if image flags move particles to where they went without periodic boundaries.
    pub unwrap: bool,
    /// True if the particles move so that their middle is that of the cell, or the origin.
    pub center: bool,
    /// Periodic copies along each edge of the cell.
    pub replicate: [u32; 3],
    /// Emitted radiance of a white particle, in W/(sr m^2).
    pub glow: f64,
    /// Share of the colours that is reflected.
    pub shade: f64,
    /// True if the edges of the cell are drawn.
    pub cell: bool,
}

impl Default for Appearance {
    /// Everything as the file suggests.
    fn default() -> Self {
        Self {
            select: None,
            slice: None,
            radius: RadiusChoice::Auto,
            radius_scale: 1.0,
            color: ColorChoice::Auto,
            colormap: ColorMap::default(),
            range: RangeChoice::default(),
            log: false,
            wrap: false,
            unwrap: false,
            center: false,
            replicate: [1; 3],
            glow: 0.0,
            shade: 1.0,
            cell: false,
        }
    }
}

/// How radii are chosen.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(from = "String", into = "String")]
pub enum RadiusChoice {
    /// What the file says; otherwise those of the elements; otherwise half the typical distance
    /// between neighbours.
    #[default]
    Auto,
    /// Half the typical distance between neighbours.
    Spacing,
    /// One for all.
    Number(f64),
    /// Van der Waals radii of the elements.
    Vdw,
    /// Covalent radii of the elements.
    Covalent,
    /// A column or an expression.
    Expression(String),
}

/// How colours are chosen.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(from = "String", into = "String")]
pub enum ColorChoice {
    /// What the file says; otherwise those of the elements or types; otherwise one colour.
    #[default]
    Auto,
    /// Likewise, with the choice where the file says nothing.
    AutoOr(String),
    /// Red, green and blue columns of the file.
    Rgb,
    /// Jmol's colours of the elements.
    Element,
    /// One colour for each type.
    Type,
    /// The position in the bounding box as red, green and blue.
    Position,
    /// A colour, a column or an expression.
    Named(String),
}

impl From<String> for RadiusChoice {
    fn from(text: String) -> Self {
        match (&*text, text.parse::<f64>()) {
            ("auto", _) => Self::Auto,
            ("spacing", _) => Self::Spacing,
            ("vdw", _) => Self::Vdw,
            ("covalent", _) => Self::Covalent,
            (_, Ok(number)) => Self::Number(number),
            _ => Self::Expression(text),
        }
    }
}

impl fmt::Display for RadiusChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::Spacing => f.write_str("spacing"),
            Self::Number(number) => write!(f, "{number}"),
            Self::Vdw => f.write_str("vdw"),
            Self::Covalent => f.write_str("covalent"),
            Self::Expression(text) => f.write_str(text),
        }
    }
}

impl From<RadiusChoice> for String {
    fn from(choice: RadiusChoice) -> Self {
        choice.to_string()
    }
}

impl From<String> for ColorChoice {
    fn from(text: String) -> Self {
        match &*text {
            "auto" => Self::Auto,
            "rgb" => Self::Rgb,
            "element" => Self::Element,
            "type" => Self::Type,
            "position" => Self::Position,
            other => match other.strip_prefix("auto:") {
                Some(otherwise) => Self::AutoOr(otherwise.to_owned()),
                None => Self::Named(text),
            },
        }
    }
}

impl fmt::Display for ColorChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::AutoOr(otherwise) => return write!(f, "auto:{otherwise}"),
            Self::Auto => "auto",
            Self::Rgb => "rgb",
            Self::Element => "element",
            Self::Type => "type",
            Self::Position => "position",
            Self::Named(text) => text,
        })
    }
}

impl From<ColorChoice> for String {
    fn from(choice: ColorChoice) -> Self {
        choice.to_string()
    }
}
