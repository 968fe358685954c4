//! The supported file formats.

use std::path::Path;

use crate::error::{Error, Result};

/// File formats, selected by extension.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FileFormat {
    Png,
    Exr,
    Hdr,
    Pfm,
}

impl FileFormat {
    /// The format of a file, by its extension.
    pub(super) fn from_path(path: &Path) -> Result<Self> {
        let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
        match extension.to_str() {
            Some("png") => Ok(Self::Png),
            Some("exr") => Ok(Self::Exr),
            Some("hdr") => Ok(Self::Hdr),
            Some("pfm") => Ok(Self::Pfm),
            _ => Err(Error::input(format!(
                "`{}` does not end in .png, .exr, .hdr or .pfm",
                path.display()
            ))
            .with_help(
                "the ending chooses the format: .png for the screen (sRGB, 8 bit), .exr for linear \
                 light with its layers, .hdr or .pfm for linear light",
            )),
        }
    }
}
