//! From a scene file to an immutable [`Scene`].

mod assemble;
pub mod description;
mod document;
mod import;
mod load;
mod overrides;
mod read;
mod report;
mod values;

pub use assemble::{Scene, Surface};
pub use import::RowGroup;
pub use load::{Loaded, read_file, read_text};
pub use overrides::Override;
