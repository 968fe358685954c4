//! Drawing: numbers in; SVG, HTML and text tables out. This module knows nothing about rendering.
//!
//! [`bars`], [`lines`](lines()) and [`panels`] are complete charts. [`Canvas`] draws lines, circles
//! and text one by one, and [`SideView`] projects points in space onto it. [`page`] combines text,
//! tables, charts and images ([`Cells`]) in one self-contained file.

mod axes;
mod bars;
mod canvas;
mod cells;
mod heat;
mod lines;
pub mod page;
pub mod printable;
mod side;
pub mod text;

pub use axes::{Axes, Value};
pub use bars::{Bar, BarGroup, bars};
pub use canvas::Canvas;
pub use cells::{CellColors, Cells};
pub use heat::heat_color;
pub use lines::{Course, Line, Mark, Panel, Panels, lines, panels};
pub use side::SideView;
