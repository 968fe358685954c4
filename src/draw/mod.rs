//! Drawing: figures in; SVG, HTML and tables of text out. It knows numbers, words and colours, but nothing of light.
//!
//! [`bars`], [`lines`](lines()) and [`panels`] are whole charts. A [`Canvas`] takes lines, circles and
//! words one by one, and a [`SideView`] says where points of space lie on it. A [`page`] holds text,
//! tables, charts and pictures of [`Cells`] in one file that needs nothing beside it.

mod axes;
mod bars;
mod canvas;
mod cells;
mod heat;
mod lines;
pub mod page;
mod side;
pub mod text;

pub use axes::{Axes, Value};
pub use bars::{Bar, BarGroup, bars};
pub use canvas::Canvas;
pub use cells::{CellColors, Cells};
pub use heat::heat_color;
pub use lines::{Course, Line, Mark, Panel, Panels, lines, panels};
pub use side::SideView;
