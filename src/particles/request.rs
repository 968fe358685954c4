//! What is asked of a file, and what a survey answers.

use std::path::PathBuf;

use serde::Serialize;

use super::column::is_called;
use super::format::Format;
use super::model::{Cell, LengthUnit};
use super::source::Source;
use super::trouble::Trouble;

/// What to read.
#[derive(Clone, Debug)]
pub struct ReadRequest {
    /// The format; `None` recognises it by content. Standard input needs one.
    pub format: Option<Format>,
    /// The frame: 0 is the first, -1 the last.
    pub frame: i64,
    /// The columns to read besides the positions.
    pub columns: Wanted,
    /// Names of the columns where the file does not name them: `x`, `y`, `z` are the positions, `_`
    /// is left out. Empty lets the format decide.
    pub names: Vec<String>,
    /// The file with names and types for a trajectory that has none.
    pub topology: Option<PathBuf>,
    /// Bytes of memory that reading may take; `None` is the free memory of this machine.
    pub memory_limit: Option<u64>,
}

/// Which columns are read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Wanted {
    /// All of them.
    All,
    /// Those with these names, regardless of case. One that the file lacks is an error.
    Only(Vec<String>),
}

/// What a file contains.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Survey {
    /// The file; `-` is standard input.
    pub path: PathBuf,
    /// The format.
    pub format: Format,
    /// The compression around it: "gzip", "zstd", or none.
    pub compression: Option<&'static str>,
    /// Number of frames, if the format tells it without reading the whole file;
    /// [`super::count_frames`] always counts.
    pub frames: Option<u64>,
    /// Number of particles in the frame, if known without reading them.
    pub count: Option<u64>,
    /// The columns in the order of the file, without the positions.
    pub columns: Vec<ColumnInfo>,
    /// The simulation cell of the frame, if it is known without reading the particles.
    pub cell: Option<Cell>,
    /// Time step or time of the frame.
    pub time: Option<f64>,
    /// Title or comment.
    pub title: Option<String>,
    /// The unit of length, if the format or the file defines one.
    pub unit: Option<LengthUnit>,
    /// Bytes of a particle's position in memory: 12 in f32, 24 in f64.
    pub position_bytes: u64,
}

/// A column of a file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ColumnInfo {
    /// The name.
    pub name: String,
    /// What its values are, as far as the first rows tell.
    pub kind: ColumnKind,
    /// The least and the greatest number, where the file says them.
    pub range: Option<[f64; 2]>,
}

/// What the values of a column are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ColumnKind {
    /// Integers.
    Integer,
    /// Floating-point numbers.
    Float,
    /// Words.
    Text,
}

impl Default for ReadRequest {
    /// The first frame with all columns.
    fn default() -> Self {
        Self {
            format: None,
            frame: 0,
            columns: Wanted::All,
            names: Vec::new(),
            topology: None,
            memory_limit: None,
        }
    }
}

impl Survey {
    /// A file of a format, with nothing known of it.
    pub(super) fn new(source: &Source, format: Format) -> Self {
        Self {
            path: source.path.clone(),
            format,
            compression: source.compression,
            frames: None,
            count: None,
            columns: Vec::new(),
            cell: None,
            time: None,
            title: None,
            unit: None,
            position_bytes: 24,
        }
    }
}

impl Wanted {
    /// Returns true if the column with this name is read.
    pub fn has(&self, name: &str) -> bool {
        match self {
            Self::All => true,
            Self::Only(names) => names.iter().any(|wanted| is_called(name, wanted)),
        }
    }

    /// These without some names.
    pub(super) fn without<'n>(&self, names: impl Iterator<Item = &'n str> + Clone) -> Self {
        let Self::Only(wanted) = self else { return Self::All };
        let is_kept = |wanted: &&String| !names.clone().any(|name| is_called(name, wanted));
        Self::Only(wanted.iter().filter(is_kept).cloned().collect())
    }

    /// Refuses names that are not among those of a file.
    pub(super) fn check<'n>(
        &self,
        names: impl Iterator<Item = &'n str> + Clone,
    ) -> Result<(), Trouble> {
        let Self::Only(wanted) = self else { return Ok(()) };
        let is_missing = |wanted: &&String| !names.clone().any(|name| is_called(name, wanted));
        let Some(missing) = wanted.iter().find(is_missing) else { return Ok(()) };
        let all: Vec<String> = names.map(|name| format!("`{name}`")).collect();
        let help = match all.len() {
            0 => "it has positions only".to_owned(),
            _ => format!("it has the columns {}", all.join(", ")),
        };
        Err(Trouble::new(format!("there is no column `{missing}`")).with_help(help))
    }
}
