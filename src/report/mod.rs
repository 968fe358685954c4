//! Reports as text, JSON and drawings: the contents of a scene, how an image was made and how it
//! differs from another, the path of one sample, the results of checks and benchmarks. This module
//! computes no results and prints nothing.

pub mod checks;
pub mod citation;
pub mod compare;
pub mod convergence;
mod difference;
mod file;
pub mod path;
mod record_text;
mod scene;
pub mod speed;

pub use difference::{describe_in_standard_errors, describe_in_steps};
pub use file::{FileRecords, is_picture};
pub use scene::SceneSummary;
