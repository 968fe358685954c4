//! A picture that a command writes, to a file or to the standard output.

use std::io;
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::image_io::{FileFormat, ImageWriter, Picture, write_to_stream};
use crate::job::PictureRecord;

/// One picture file, or the standard output.
pub(super) struct PictureFile {
    pub(super) path: PathBuf,
    target: PictureTarget,
}

/// Where a picture goes.
enum PictureTarget {
    File(ImageWriter),
    Stdout(FileFormat),
}

impl PictureFile {
    /// Prepares a file.
    ///
    /// # Errors
    /// If it cannot be written, or its ending names no format.
    pub(super) fn new(path: &Path) -> Result<Self> {
        let target = PictureTarget::File(ImageWriter::new(path)?);
        Ok(Self { path: path.to_path_buf(), target })
    }

    /// The standard output.
    pub(super) fn stdout(path: &Path, format: FileFormat) -> Self {
        Self { path: path.to_path_buf(), target: PictureTarget::Stdout(format) }
    }

    /// Returns true if the format has layers.
    pub(super) fn has_layers(&self) -> bool {
        match &self.target {
            PictureTarget::File(file) => file.has_layers(),
            PictureTarget::Stdout(format) => format.has_layers(),
        }
    }

    /// Returns true if the picture is for the screen.
    pub(super) fn is_display_referred(&self) -> bool {
        match &self.target {
            PictureTarget::File(file) => file.is_display_referred(),
            PictureTarget::Stdout(format) => format.is_display_referred(),
        }
    }

    /// Returns true if the format holds what is drawn over a picture, in its pixels or as a layer.
    pub(super) fn holds_overlay(&self) -> bool {
        self.is_display_referred() || self.has_layers()
    }

    /// Writes the picture, to its own path or to another.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub(super) fn write(
        &self,
        place: Option<&Path>,
        picture: &Picture,
        record: &PictureRecord,
    ) -> Result<()> {
        let format = match &self.target {
            PictureTarget::File(file) => file.format(),
            PictureTarget::Stdout(format) => *format,
        };
        let notes = record.options_for(format)?;
        match (place, &self.target) {
            (Some(place), _) => ImageWriter::new(place)?.write_with(picture, &notes),
            (None, PictureTarget::File(file)) => file.write_with(picture, &notes),
            (None, PictureTarget::Stdout(format)) => {
                write_to_stream(*format, picture, &notes, &mut io::stdout().lock())
                    .map_err(|e| Error::file("write", Path::new("standard output"), e))
            }
        }
    }

    /// Returns true if the picture could be written to another place instead.
    pub(super) fn is_file(&self) -> bool {
        matches!(self.target, PictureTarget::File(_))
    }
}
