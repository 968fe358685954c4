//! How particles look: radii and colours from their columns, selections, colour maps and palettes,
//! spacing, and where a camera sees all of them. Pure functions of numbers: nothing here reads a
//! file or knows a scene.

mod arrange;
mod cell_edges;
mod color_map;
mod colors;
mod dress;
mod element;
mod elements;
pub mod expression;
mod failure;
mod framing;
mod named_color;
mod options;
mod palette;
mod particle_columns;
mod radii;
mod spacing;
mod ticks;
mod value_range;

pub use self::colors::{Colors, Legend};
pub use color_map::ColorMap;
pub use dress::{Dressed, dress, needed_columns, range_text};
pub use element::Element;
pub use failure::AppearanceError;
pub use framing::{FramedCamera, Framing, Projection, ViewDirection, frame, parse_up};
pub use named_color::named_color;
pub use options::{Appearance, ColorChoice, RadiusChoice};
pub use palette::palette;
pub use radii::Radii;
pub use spacing::median_spacing;
pub use ticks::{Ticks, label};
pub use value_range::{RangeChoice, RangeEnd, ValueRange};
