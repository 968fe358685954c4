//! Reports the path of one sample: as text with the symbols of the rendering equation, as a drawing
//! from the side, and as JSON. The input is a [`PathTrace`](crate::integrator::PathTrace), which
//! the integrator records from the path itself.

mod blocker;
mod drawing;
mod fold;
mod json;
mod lights;
mod numbers;
mod sketch;
mod spheres;
mod text;

pub use drawing::svg;
pub use json::json;
pub use text::text;
