//! A picture that a command writes, to a file or to the standard output.

use std::io;
use std::path::{Path, PathBuf};

use crate::color::ViewTransform;
use crate::error::{Error, Result};
use crate::film::Aov;
use crate::image_io::{FileFormat, ImageWriter, Picture, WriteOptions, write_to_stream};
use crate::job::Metadata;

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

/// What is written beside the pixels of a picture file.
pub(super) struct PictureNotes {
    pub(super) notes: WriteOptions,
    pub(super) metadata: Metadata,
    pub(super) layers: Vec<Aov>,
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

    /// Writes the picture, to its own path or to another.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub(super) fn write(
        &self,
        place: Option<&Path>,
        picture: &Picture,
        of: &PictureNotes,
    ) -> Result<()> {
        let usual = of.notes.view_transform == ViewTransform::default();
        let metadata = Metadata {
            look: (self.is_display_referred() && !usual).then_some(of.notes.view_transform),
            overlay: of.metadata.overlay.clone().filter(|_| self.shows_overlay()),
            layers: self.has_layers().then(|| of.layers.clone()),
            column_layers: match self.has_layers() {
                true => of.metadata.column_layers.clone(),
                false => Vec::new(),
            },
            ..of.metadata.clone()
        };
        let notes = WriteOptions { metadata: metadata.to_records()?, ..of.notes.clone() };
        match (place, &self.target) {
            (Some(place), _) => ImageWriter::new(place)?.write_with(picture, &notes),
            (None, PictureTarget::File(file)) => file.write_with(picture, &notes),
            (None, PictureTarget::Stdout(format)) => {
                write_to_stream(*format, picture, &notes, &mut io::stdout().lock())
                    .map_err(|e| Error::file("write", Path::new("standard output"), e))
            }
        }
    }

    /// Returns true if the format holds what is drawn over the picture.
    fn shows_overlay(&self) -> bool {
        self.is_display_referred() || self.has_layers()
    }

    /// Returns true if the picture could be written to another place instead.
    pub(super) fn is_file(&self) -> bool {
        matches!(self.target, PictureTarget::File(_))
    }
}
