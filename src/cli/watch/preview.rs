//! The picture so far, in a file.

use std::path::{Path, PathBuf};

use crate::cli::print;
use crate::color::ViewTransform;
use crate::error::{Error, Result};
use crate::image_io::Picture;
use crate::image_io::{CropWindow, ImageWriter, WriteOptions};

/// A file that is replaced whole, again and again.
pub(super) struct Preview {
    path: PathBuf,
    look: ViewTransform,
    /// True if the last attempt failed and was reported.
    is_failing: bool,
}

impl Preview {
    /// # Errors
    /// When the path does not end in `.png`, or nothing can be written there.
    pub(super) fn new(path: &Path, look: ViewTransform) -> Result<Self> {
        let extension = path.extension().unwrap_or_default();
        if !extension.eq_ignore_ascii_case("png") {
            return Err(Error::input(format!(
                "the preview `{}` is not a .png file",
                path.display()
            ))
            .with_help("a preview is for the screen; -o chooses the format of the picture"));
        }
        ImageWriter::new(path)?;
        Ok(Self { path: path.to_owned(), look, is_failing: false })
    }

    /// Replaces the file; `cropped_from` as in the finished picture, whose dither starts there.
    /// What goes wrong is a warning, once until it goes well again: the render matters more.
    pub(super) fn write(&mut self, picture: &Picture, cropped_from: Option<CropWindow>) {
        let notes = WriteOptions {
            crop_window: cropped_from,
            view_transform: self.look,
            fast: true,
            ..WriteOptions::default()
        };
        let written =
            ImageWriter::new(&self.path).and_then(|target| target.write_with(picture, &notes));
        if let (Err(e), false) = (&written, self.is_failing) {
            print::warning(format_args!("no preview for now: {e}"));
        }
        self.is_failing = written.is_err();
    }
}
