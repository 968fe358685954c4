//! A temporary folder.

use std::env;

use tempfile::TempDir;

use crate::error::{Error, Result};

/// Creates a folder in the system's folder for temporary files; dropping it removes it.
///
/// # Errors
/// Names the system's folder if nothing can be created in it.
pub(crate) fn temp_folder() -> Result<TempDir> {
    let place = env::temp_dir();
    tempfile::tempdir_in(&place).map_err(|e| {
        let reason = e.to_string();
        // tempfile appends the name that it tried.
        let reason = reason.split(" at path ").next().unwrap_or_default().to_owned();
        Error::file("create a temporary folder in", &place, reason)
            .with_help("the environment variable TMPDIR names this folder; let it name another")
    })
}
