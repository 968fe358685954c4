//! The checkpoint that a render writes while it runs and when it ends.

use std::path::{Path, PathBuf};

use crate::cli::outputs::Outputs;
use crate::error::{Error, Result};
use crate::image_io::AtomicFile;

/// The checkpoint file, ready to be written.
pub(super) struct CheckpointTarget {
    pub(super) path: PathBuf,
    pub(super) file: AtomicFile,
}

impl CheckpointTarget {
    /// Returns the checkpoint or the requested `.part` file, if there is one.
    pub(super) fn new(checkpoint: Option<&Path>, outputs: &Outputs) -> Result<Option<Self>> {
        let path = match (checkpoint, outputs.part()) {
            (Some(checkpoint), Some(part)) if checkpoint != part => {
                let message = format!(
                    "`{}` is its own checkpoint, so `{}` is not needed",
                    part.display(),
                    checkpoint.display()
                );
                return Err(Error::input(message).with_help("remove --checkpoint"));
            }
            (Some(path), _) | (None, Some(path)) => path.to_path_buf(),
            (None, None) => return Ok(None),
        };
        let file = AtomicFile::new(&path)?;
        Ok(Some(Self { path, file }))
    }
}
