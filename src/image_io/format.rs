//! The supported file formats.

use std::path::Path;

use crate::error::{Error, Result};
use crate::names::named_enum;

/// The formats and what they hold, for the help of options.
pub const PICTURE_FORMATS: &str =
    ".png (8 bits, for the screen), .exr (linear, with layers), .hdr or .pfm (linear)";

/// The file formats, named by their extensions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileFormat {
    /// sRGB with 8 bits, for the screen.
    Png,
    /// OpenEXR: linear radiance in 32-bit float, with layers.
    Exr,
    /// Radiance HDR: linear radiance as RGBE.
    Hdr,
    /// Portable float map: linear radiance in 32-bit float.
    Pfm,
}

named_enum! { FileFormat { Png = "png", Exr = "exr", Hdr = "hdr", Pfm = "pfm" } }

impl FileFormat {
    /// The format of a file, by its extension.
    ///
    /// # Errors
    /// If the extension is that of no format.
    pub fn from_path(path: &Path) -> Result<Self> {
        Self::known(path).ok_or_else(|| {
            let message = format!("`{}` does not end in .png, .exr, .hdr or .pfm", path.display());
            Error::input(message).with_help(
                "the extension chooses the format: .png for the screen (sRGB, 8 bits), .exr for linear \
                 light with layers, .hdr or .pfm for linear light",
            )
        })
    }

    fn known(path: &Path) -> Option<Self> {
        Self::named(path.extension()?.to_ascii_lowercase().to_str()?)
    }

    /// Returns true if the file has layers.
    pub fn has_layers(self) -> bool {
        self == Self::Exr
    }

    /// Returns true if the file is for the screen: 8 bit, after a view transform.
    pub fn is_display_referred(self) -> bool {
        self == Self::Png
    }
}

/// Returns true if the extension of the file is that of a supported format.
pub fn has_picture_extension(path: &Path) -> bool {
    FileFormat::known(path).is_some()
}
