//! Errors from reading a checkpoint, and their messages.

use std::io;
use std::path::Path;

use crate::error::Error;

use super::version::VERSION;

/// Why bytes cannot be read as a checkpoint.
#[derive(Debug)]
pub(super) enum ReadError {
    Io(io::Error),
    NotACheckpoint,
    TooNew(u32),
    TooOld(u32),
    Truncated(u64),
    Corrupt(&'static str),
    UnsupportedHeader(String),
}

impl ReadError {
    /// Returns the error for the user. `path` is the file, if there is one.
    pub(super) fn into_error(self, path: Option<&Path>) -> Error {
        let error = |reason: String| match path {
            Some(path) => Error::file("read", path, reason),
            None => Error::input(format!("cannot read the checkpoint: {reason}")),
        };
        match self {
            Self::Io(e) => error(e.to_string()),
            Self::NotACheckpoint => error("it is neither a checkpoint nor a part".to_owned())
                .with_help("name a checkpoint or a part written by photosphere"),
            Self::TooNew(version) => error(format!(
                "its format has version {version}, and this program reads versions up to {VERSION}"
            ))
            .with_help("use the photosphere that wrote it, or a newer one"),
            Self::TooOld(version) => error(format!(
                "its format has version {version}, which this program no longer reads"
            ))
            .with_help("finish it with the photosphere that wrote it, or render it again"),
            Self::Truncated(at) => error(format!("it is truncated after {at} bytes"))
                .with_help("copy it again, or render this part again"),
            Self::Corrupt(reason) => error(format!("it is damaged: {reason}"))
                .with_help("copy it again, or render this part again"),
            Self::UnsupportedHeader(reason) => {
                error(reason).with_help("use the photosphere that wrote it")
            }
        }
    }
}

impl From<io::Error> for ReadError {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}
