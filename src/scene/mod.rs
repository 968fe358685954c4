//! From a scene file to an immutable [`Scene`].

mod assemble;
mod biases;
mod colors;
pub mod description;
mod document;
mod environment;
mod identity;
mod import;
mod load;
mod overrides;
mod read;
mod report;
mod rows;
mod surface;
mod values;

pub use assemble::Scene;
pub use colors::{Colors, Packed};
pub use environment::Pixels;
pub use identity::{Identity, Ingredient, Ingredients};
pub use import::RowGroup;
pub use load::{Loaded, Opened, open_file, open_text, read_file, read_text};
pub use overrides::Override;
pub use surface::Surface;
