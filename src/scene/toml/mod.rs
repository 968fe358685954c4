//! The TOML scene format: parses scene files into values, with the position of every error. No
//! other module depends on TOML.

mod diagnostics;
mod document;
mod load;
mod missing_file;
mod nesting;
mod not_toml;
mod overrides;
mod read;

pub use load::{
    SceneFile, TableInput, read_file, read_stream, read_text, read_text_reusing, read_text_with,
};
pub use overrides::Override;
