//! How particles look: radii and colours from their columns, selections, colour maps and palettes,
//! spacing, and where a camera sees all of them. Pure functions of numbers: nothing here reads a
//! file or knows a scene.

mod arrange;
mod cell_edges;
mod color_map;
mod colors;
mod doubts;
mod dress;
mod dressed;
mod element;
mod elements;
pub mod expression;
mod failure;
mod framing;
mod keep_rows;
mod more_spheres;
mod named_color;
mod needed_columns;
mod options;
mod palette;
mod particle_columns;
mod questions;
mod radii;
mod spacing;
mod ticks;
mod value_range;

pub use self::colors::{Colors, Legend};
pub use color_map::ColorMap;
pub use dress::{dress, range_text};
pub use dressed::Dressed;
pub use element::Element;
pub use failure::AppearanceError;
pub use framing::{FramedCamera, Framing, Projection, ViewDirection, frame, parse_up};
pub use named_color::named_color;
pub use needed_columns::needed_columns;
pub use options::{Appearance, ColorChoice, RadiusChoice};
pub use palette::palette;
pub use questions::{numbers_of, selected_rows};
pub use radii::Radii;
pub use spacing::median_spacing;
pub use ticks::{Ticks, label};
pub use value_range::{RangeChoice, RangeEnd, ValueRange};
