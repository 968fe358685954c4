//! The particles of a file as values (`[[particles]]`).

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::appearance::Appearance;
use crate::particles::{Format, ReadRequest, Wanted};

/// The particles of a file, and how they look.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ParticleTable {
    /// The file.
    #[serde(with = "super::paths")]
    pub path: PathBuf,
    /// The format; `None` recognises it by content.
    pub format: Option<Format>,
    /// The frame: 0 is the first, -1 the last.
    pub frame: i64,
    /// Names of the columns where the file does not name them.
    pub columns: Vec<String>,
    /// The file with names and types for a trajectory that has none.
    #[serde(with = "super::paths::optional")]
    pub topology: Option<PathBuf>,
    /// The look.
    pub appearance: Appearance,
}

impl ParticleTable {
    /// Changes the path of each file.
    pub(crate) fn for_each_file(&mut self, change: &mut impl FnMut(&mut PathBuf)) {
        change(&mut self.path);
        self.topology.iter_mut().for_each(change);
    }

    /// What to read of the file: the columns that the options may need, or all of them.
    pub fn request(&self, wanted: Wanted) -> ReadRequest {
        ReadRequest {
            format: self.format,
            frame: self.frame,
            columns: wanted,
            names: self.columns.clone(),
            topology: self.topology.clone(),
            ..ReadRequest::default()
        }
    }
}
