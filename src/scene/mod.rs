//! From a scene file to an immutable scene.

pub mod description;
mod document;
mod import;
mod load;
mod overrides;
mod read;
mod report;
mod values;

pub use import::RowGroup;
pub use load::{Loaded, read_file, read_text};
pub use overrides::Override;

mod stand_in;
pub use stand_in::Scene;
