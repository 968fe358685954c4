//! Reads the scene that a command names: a file, or the standard input.

use std::path::Path;

use crate::error::Result;
use crate::scene::{Override, SceneFile, read_file, read_stream};

/// The name of a scene from the standard input.
pub(super) const STANDARD_INPUT: &str = "standard input";

/// Returns true if the path stands for the standard input.
pub(super) fn is_stdin(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// Reads a scene file. Relative names of files in the standard input start at the working folder.
///
/// # Errors
/// If the scene cannot be read, or has mistakes.
pub(super) fn read(path: &Path, overrides: &[Override]) -> Result<SceneFile> {
    match is_stdin(path) {
        true => read_stream(STANDARD_INPUT, std::io::stdin(), Path::new(""), overrides),
        false => read_file(path, overrides),
    }
}
