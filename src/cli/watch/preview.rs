//! The current picture in a file.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::cli::print;
use crate::color::ViewTransform;
use crate::error::{Error, Result};
use crate::image_io::{CropWindow, ImageWriter, OverlayImage, Picture, WriteOptions};

/// A preview file that is replaced atomically with every update.
pub(super) struct Preview {
    path: PathBuf,
    look: ViewTransform,
    /// What is drawn over the picture.
    overlay: Option<Arc<OverlayImage>>,
    /// True if the last attempt failed and a warning was printed.
    is_failing: bool,
}

impl Preview {
    /// Prepares the file.
    ///
    /// # Errors
    /// If the path does not end in `.png`, or cannot be written.
    pub(super) fn new(path: &Path, look: ViewTransform) -> Result<Self> {
        let extension = path.extension().unwrap_or_default();
        if !extension.eq_ignore_ascii_case("png") {
            return Err(Error::input(format!(
                "the preview `{}` is not a .png file",
                path.display()
            ))
            .with_help("name a .png file; -o chooses the format of the picture"));
        }
        ImageWriter::new(path)?;
        Ok(Self { path: path.to_owned(), look, overlay: None, is_failing: false })
    }

    /// Sets what is drawn over the picture.
    pub(super) fn set_overlay(&mut self, overlay: Arc<OverlayImage>) {
        self.overlay = Some(overlay);
    }

    /// Replaces the file. `cropped_from` is the crop window of the finished picture, on whose grid
    /// the dither pattern is anchored. A failure does not stop the render: it is a warning, printed
    /// once until a write succeeds again.
    pub(super) fn write(&mut self, picture: &Picture, cropped_from: Option<CropWindow>) {
        let notes = WriteOptions {
            overlay: self.overlay.clone(),
            crop_window: cropped_from,
            view_transform: self.look,
            fast: true,
            ..WriteOptions::default()
        };
        let written =
            ImageWriter::new(&self.path).and_then(|target| target.write_with(picture, &notes));
        if let (Err(e), false) = (&written, self.is_failing) {
            print::warning(format_args!("cannot update the preview: {e}"));
        }
        self.is_failing = written.is_err();
    }
}
