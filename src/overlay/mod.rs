//! What is drawn over a finished picture: a colour bar or legend, a scale bar and the axes. It is
//! an image of its own, and never touches radiance.
//!
//! An [`OverlaySpec`] says in numbers what is drawn, so that a picture can record it;
//! [`OverlaySpec::draw`] draws it, in the same bits everywhere.

mod bar;
mod canvas;
mod categories;
mod draw;
mod scale_bar;
mod spec;
mod text;
mod text_size;
mod tripod;

pub use spec::{LegendSpec, OverlayChoice, OverlaySpec, ScaleBarSpec};
pub use text_size::font_pixels;
