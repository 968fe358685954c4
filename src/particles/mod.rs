//! Reads particles from files of other programs: columns of numbers and words, positions, cells.
//!
//! [`survey`] tells what is in a file, [`read`] reads one frame of it with the columns that are
//! asked for. Both recognise the format by its content, also within gzip and Zstandard. Nothing
//! here knows radii, colours or light: a column keeps the name and the numbers that its file gives.
//!
//! Memory follows the bytes that a file has, never the number of particles that it promises.

mod column;
mod format;
mod model;
mod request;

pub use column::{Categories, Column, ColumnData, Role};
pub use format::Format;
pub use model::{Cell, LengthUnit, Particles, Positions};
pub use request::{ColumnInfo, ColumnKind, ReadRequest, Survey, Wanted};

use std::path::Path;

use crate::error::{Error, Result};

/// Reads one frame of a file; `-` is standard input.
///
/// # Errors
/// If the file cannot be read, is damaged, lacks a column that is asked for, or does not fit into
/// memory. A message about contents begins with the path and the line, as in `a.xyz:12: ...`.
pub fn read(path: &Path, request: &ReadRequest) -> Result<Particles> {
    let _ = request;
    Err(Error::input(format!("`{}` cannot be read yet", path.display())))
}

/// Tells what is in a file: its format, the columns of a frame, its number of particles and its
/// cell, without reading what the format lets it skip.
///
/// # Errors
/// Like those of [`read`]; standard input cannot be surveyed, because it can be read only once.
pub fn survey(path: &Path, request: &ReadRequest) -> Result<Survey> {
    let _ = request;
    Err(Error::input(format!("`{}` cannot be read yet", path.display())))
}

/// Counts the frames of a file. Where the format has no index, this reads the whole file.
///
/// # Errors
/// Like those of [`survey`].
pub fn count_frames(path: &Path, request: &ReadRequest) -> Result<u64> {
    let _ = request;
    Err(Error::input(format!("`{}` cannot be read yet", path.display())))
}
