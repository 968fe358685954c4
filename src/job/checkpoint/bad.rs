//! Why a file is not read as a part, in words.

use std::io;
use std::path::Path;

use crate::error::Error;

use super::version::VERSION;

/// What keeps a file from being read as a part.
#[derive(Debug)]
pub(super) enum Bad {
    Unreadable(io::Error),
    NoPart,
    Newer(u32),
    Older(u32),
    CutOff(u64),
    Damaged(&'static str),
    Unknown(String),
}

impl Bad {
    pub(super) fn told(self, path: &Path) -> Error {
        let refused = |reason: String| Error::file("read", path, reason);
        match self {
            Self::Unreadable(e) => refused(e.to_string()),
            Self::NoPart => refused("it is no part and no checkpoint".to_owned())
                .with_help("name a checkpoint or a part that photosphere wrote"),
            Self::Newer(version) => refused(format!(
                "it is written in version {version} of the format, and this program knows versions up \
                 to {VERSION}"
            ))
            .with_help("use the photosphere that wrote it, or a newer one"),
            Self::Older(version) => refused(format!(
                "it is written in version {version} of the format, which this program does not read any \
                 more"
            ))
            .with_help("finish it with the photosphere that wrote it, or render it anew"),
            Self::CutOff(at) => refused(format!("it is cut off after {at} bytes"))
                .with_help("copy it again, or render this part again"),
            Self::Damaged(what) => refused(format!("it is damaged: {what}"))
                .with_help("copy it again, or render this part again"),
            Self::Unknown(what) => refused(what).with_help("use the photosphere that wrote it"),
        }
    }
}

impl From<io::Error> for Bad {
    fn from(error: io::Error) -> Self {
        Self::Unreadable(error)
    }
}
