//! From a particle file to a scene that can be rendered: frames the particles, lights them, and
//! writes the scene as text in the scene format, with every automatic choice spelled out.

mod compose;
mod import;
mod options;
mod overlay_spec;
mod style;

pub use crate::overlay::font_pixels;
pub use import::{Import, import, import_particles};
pub use options::{Background, StudioOptions};
pub use overlay_spec::{overlay_spec, overlay_warnings};
pub use style::{MATERIALS, Style};
