//! Reads the scene that a command names: a file, or the standard input.

use std::io::{Cursor, Read, stdin};
use std::path::Path;

use crate::error::{Error, Result};
use crate::particles::{ReadRequest, survey_bytes};
use crate::scene::{Override, SceneFile, read_file, read_stream};

use super::print;

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
    let file = read_silently(path, overrides)?;
    file.notes.iter().for_each(print::note);
    file.warnings.iter().for_each(print::warning);
    Ok(file)
}

/// Reads a scene file like [`read`], without printing what there is to know of the overrides.
///
/// # Errors
/// As for [`read`].
pub(super) fn read_silently(path: &Path, overrides: &[Override]) -> Result<SceneFile> {
    match is_stdin(path) {
        true => read_stdin(overrides),
        false => read_file(path, overrides),
    }
}

fn read_stdin(overrides: &[Override]) -> Result<SceneFile> {
    const HEAD_BYTES: u64 = 1 << 16;
    let name = Path::new(STANDARD_INPUT);
    let mut head = Vec::new();
    let read = stdin().take(HEAD_BYTES).read_to_end(&mut head);
    read.map_err(|error| Error::file("read", name, error))?;
    let stream = Cursor::new(&head).chain(stdin());
    read_stream(STANDARD_INPUT, stream, Path::new(""), overrides).map_err(
        |error| match survey_bytes(name, &head, &ReadRequest::default()) {
            Ok(found) => {
                let format = found.format.name();
                Error::input("the standard input is no scene, but a particle file")
                    .with_help(format!("name its format: --input-format {format}"))
            }
            Err(_) => error,
        },
    )
}
