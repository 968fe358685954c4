//! Reads particles from files of other programs: columns of numbers and words, positions, cells.
//!
//! [`survey`] tells what is in a file, [`read`] reads one frame of it with the columns that are
//! asked for. Both recognise the format by its content, also within gzip and Zstandard. Nothing
//! here knows radii, colours or light: a column keeps the name and the numbers that its file gives.
//!
//! Memory follows the bytes that a file has, never the number of particles that it promises.

mod binary;
mod budget;
mod column;
mod detect;
mod elements;
mod format;
mod formats;
mod frames;
mod model;
mod read;
mod request;
mod source;
mod text;
mod trouble;
mod zstd;

pub use column::{Categories, Column, ColumnData, Role};
pub use format::Format;
pub(crate) use formats::npy;
pub use model::{Cell, LengthUnit, Particles, Positions};
pub use read::{count_frames, read, read_bytes, survey, survey_bytes};
pub use request::{ColumnInfo, ColumnKind, ReadRequest, Survey, Wanted};
