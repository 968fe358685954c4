//! The scene format: TOML becomes values, and mistakes keep their place in the text. Nothing else of
//! the program knows TOML.

mod diagnostics;
mod document;
mod load;
mod overrides;
mod read;

pub use load::{SceneFile, read_file, read_text};
pub use overrides::Override;
