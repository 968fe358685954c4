//! How a picture was made, as its file says it: enough to render it again, and to tell what differs
//! where the result does.
//!
//! There are two groups of records. The first, [`Made`], is all that decides the pixels: whoever
//! renders the same thing again gets the same records. The second, [`Run`], is about one run: the
//! command, the time, the machine. Files in which it is left out are equal to the byte where the
//! pictures are.

mod again;
mod counts;
mod difference;
mod look;
mod made;
mod run;
mod shares;

pub use counts::Counts;
pub use look::{look_in_words, look_of_words};
pub use made::{Made, Samples, Source};
pub use run::{INTERSECTOR_CHOICE, Run};
pub use shares::{Share, Shares};

use crate::output::Record;

/// The records in the order in which people read them.
const ORDER: [&str; 27] = [
    "version",
    "commit",
    "identity",
    "intersector",
    "size",
    "crop",
    "samples",
    "counts",
    "parts",
    "spread-over",
    "seed",
    "noise",
    "error",
    "biased",
    "look",
    "layers",
    "options",
    "files",
    "command",
    "scene-file",
    "rays",
    "seconds",
    "threads",
    "intersector-choice",
    "embree",
    "scene-hash",
    "scene",
];

/// The version of this program.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// The commit that this program was built from, and whether it was changed; `unknown` where the build
/// found no repository.
pub const COMMIT: &str = env!("PHOTOSPHERE_COMMIT");

/// Sorts records for reading; those of other versions come last.
pub fn sort(records: &mut [Record]) {
    let place = |record: &Record| ORDER.iter().position(|name| *name == record.name);
    records.sort_by_key(|record| (place(record).unwrap_or(ORDER.len()), record.name.clone()));
}
