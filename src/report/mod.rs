//! Reports, in words, as JSON and as drawings: what is in a scene, how a picture was made and by how much
//! it differs from another, what happened on the path of one sample, what checks and measurements came
//! to. Nothing is found out here, and nothing printed.

pub mod checks;
pub mod compare;
pub mod convergence;
mod difference;
mod file;
pub mod path;
mod scene;
pub mod speed;

pub use difference::{in_standard_errors, in_steps};
pub use file::{FileRecords, is_picture};
pub use scene::SceneSummary;
