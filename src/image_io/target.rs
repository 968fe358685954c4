//! A place for a picture's file, and how the picture gets there.

use std::path::Path;

use crate::error::Result;

use super::atomic_file::{self, AtomicFile, Sink};
use super::format::FileFormat;
use super::notes::WriteOptions;
use super::picture::Picture;
use super::{exr, hdr, pfm, png};

/// A place where a picture can be written: the folder is there and lets us in.
#[derive(Debug)]
pub struct ImageWriter {
    file: AtomicFile,
    format: FileFormat,
}

impl ImageWriter {
    /// Prepares to write `path`. Its extension, in any case, chooses the format: `.png` (sRGB, 8
    /// bit), or linear radiance as `.exr` (32-bit float with the layers `direct` and `indirect`),
    /// `.hdr` (RGBE) or `.pfm` (32-bit float).
    ///
    /// # Errors
    /// When the extension is another one, when `path` is a folder, or when its folder is missing or
    /// cannot be written to.
    pub fn new(path: &Path) -> Result<Self> {
        atomic_file::reject_folder(path, "picture.png")?;
        let format = FileFormat::from_path(path)?;
        Ok(Self { file: AtomicFile::new(path)?, format })
    }

    /// Whether the file has layers.
    pub fn has_layers(&self) -> bool {
        self.format.has_layers()
    }

    /// Whether the file is for the screen, and so has a [`ViewTransform`](crate::color::ViewTransform).
    pub fn is_display_referred(&self) -> bool {
        self.format.is_display_referred()
    }

    /// Writes the picture, whole, as often as one likes, and gives the file its name.
    ///
    /// # Errors
    /// When the disk refuses; a file that was there before is then unchanged, and nothing else is
    /// left behind.
    pub fn write(&self, picture: &Picture) -> Result<()> {
        self.write_with(picture, &WriteOptions::default())
    }

    /// The same with notes, as far as the format has a place for them.
    ///
    /// # Errors
    /// Like [`Self::write`].
    pub fn write_with(&self, picture: &Picture, notes: &WriteOptions) -> Result<()> {
        let content = |sink: &mut Sink<'_>| match self.format {
            FileFormat::Png => png::write(picture, notes, sink),
            FileFormat::Exr => exr::write(picture, notes, sink),
            FileFormat::Hdr => hdr::write(picture, sink),
            FileFormat::Pfm => pfm::write(picture, sink),
        };
        match notes.fast {
            true => self.file.write_unsynced(content),
            false => self.file.write(content),
        }
    }
}
