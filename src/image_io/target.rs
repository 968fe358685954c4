//! Writes pictures to files.

use std::io::{self, Seek, Write};
use std::path::Path;

use crate::error::Result;

use super::atomic_file::{self, AtomicFile, Sink};
use super::format::FileFormat;
use super::notes::WriteOptions;
use super::picture::Picture;
use super::{exr, hdr, pfm, png};

/// A picture file to write, checked to be writable when created.
#[derive(Debug)]
pub struct ImageWriter {
    file: AtomicFile,
    format: FileFormat,
}

impl ImageWriter {
    /// Prepares to write `path`. The extension (case-insensitive) selects the format: `.png` (sRGB,
    /// 8 bits), or linear radiance as `.exr` (32-bit float with the layers `direct` and
    /// `indirect`), `.hdr` (RGBE) or `.pfm` (32-bit float).
    ///
    /// # Errors
    /// On any other extension, when `path` is a folder, or when its folder is missing or not
    /// writable.
    pub fn new(path: &Path) -> Result<Self> {
        atomic_file::reject_folder(path, "picture.png")?;
        let format = FileFormat::from_path(path)?;
        Ok(Self { file: AtomicFile::new(path)?, format })
    }

    /// The format.
    pub fn format(&self) -> FileFormat {
        self.format
    }

    /// Returns true if the format has layers.
    pub fn has_layers(&self) -> bool {
        self.format.has_layers()
    }

    /// Returns true if the file is for display and so uses a
    /// [`ViewTransform`](crate::color::ViewTransform).
    pub fn is_display_referred(&self) -> bool {
        self.format.is_display_referred()
    }

    /// Writes the picture atomically. You can call this repeatedly.
    ///
    /// # Errors
    /// On I/O errors. An existing file is then unchanged, and no temporary file remains.
    pub fn write(&self, picture: &Picture) -> Result<()> {
        self.write_with(picture, &WriteOptions::default())
    }

    /// Like [`Self::write`], with those options that the format supports.
    ///
    /// # Errors
    /// As [`Self::write`].
    pub fn write_with(&self, picture: &Picture, notes: &WriteOptions) -> Result<()> {
        let content = |sink: &mut Sink<'_>| encode(self.format, picture, notes, sink);
        match notes.fast {
            true => self.file.write_unsynced(content),
            false => self.file.write(content),
        }
    }
}

/// Writes the picture to a stream, which need not be able to seek.
///
/// # Errors
/// On I/O errors, after which the stream may hold a part of the picture.
pub fn write_to_stream(
    format: FileFormat,
    picture: &Picture,
    notes: &WriteOptions,
    stream: &mut dyn Write,
) -> io::Result<()> {
    // Some formats are written out of order.
    let mut whole = tempfile::tempfile()?;
    let mut sink = Sink::new(&mut whole);
    encode(format, picture, notes, &mut sink)?;
    sink.flush()?;
    drop(sink);
    whole.rewind()?;
    io::copy(&mut whole, stream)?;
    stream.flush()
}

fn encode(
    format: FileFormat,
    picture: &Picture,
    notes: &WriteOptions,
    sink: &mut Sink<'_>,
) -> io::Result<()> {
    match format {
        FileFormat::Png => png::write(picture, notes, sink),
        FileFormat::Exr => exr::write(picture, notes, sink),
        FileFormat::Hdr => hdr::write(picture, sink),
        FileFormat::Pfm => pfm::write(picture, sink),
    }
}
