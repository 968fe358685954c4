//! The path of one sample: in words and in the letters of the rendering equation, drawn from the side,
//! and as JSON. What is told is a [`PathTrace`](crate::integrator::PathTrace), which the integrator keeps of the
//! path itself.

mod drawing;
mod json;
mod spheres;
mod words;

pub use drawing::svg;
pub use json::json;
pub use words::words;
