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
        let refused = |reason: String| match path {
            Some(path) => Error::file("read", path, reason),
            None => Error::input(format!("cannot read the checkpoint: {reason}")),
        };
        match self {
            Self::Io(e) => refused(e.to_string()),
            Self::NotACheckpoint => refused("it is no part and no checkpoint".to_owned())
                .with_help("name a checkpoint or a part that photosphere wrote"),
            Self::TooNew(version) => refused(format!(
                "it is written in version {version} of the format, and this program knows versions up \
                 to {VERSION}"
            ))
            .with_help("use the photosphere that wrote it, or a newer one"),
            Self::TooOld(version) => refused(format!(
                "it is written in version {version} of the format, which this program does not read any \
                 more"
            ))
            .with_help("finish it with the photosphere that wrote it, or render it anew"),
            Self::Truncated(at) => refused(format!("it is cut off after {at} bytes"))
                .with_help("copy it again, or render this part again"),
            Self::Corrupt(what) => refused(format!("it is damaged: {what}"))
                .with_help("copy it again, or render this part again"),
            Self::UnsupportedHeader(what) => refused(what).with_help("use the photosphere that wrote it"),
        }
    }
}

impl From<io::Error> for ReadError {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}
