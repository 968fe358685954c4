//! Explanations in words, as JSON and as drawings: what is in a scene, how a picture was made and by how
//! much it differs from another of the same render, and what happened on the path of one sample.

mod difference;
mod drawing;
mod file;
mod json;
mod scene;
mod spheres;
mod words;

pub use difference::{in_standard_errors, in_steps};
pub use drawing::svg;
pub use file::{FileRecords, is_picture};
pub use json::json;
pub use scene::SceneSummary;
pub use words::words;
