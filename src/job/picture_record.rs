//! What is written beside the pixels of a picture file.

use std::sync::Arc;

use crate::color::ViewTransform;
use crate::error::Result;
use crate::film::Aov;
use crate::image_io::{CropWindow, FileFormat, WriteOptions};
use crate::overlay::OverlaySpec;

use super::checkpoint::OutputSpec;
use super::metadata::Metadata;

/// What is written beside the pixels of a picture file: how the picture was made, how it is shown,
/// and what is drawn over it. One serves files of all formats.
#[derive(Clone, Debug)]
pub struct PictureRecord {
    options: WriteOptions,
    metadata: Metadata,
    layers: Vec<Aov>,
}

impl PictureRecord {
    /// The record of a picture with these layers. Of `output`, it takes the view transform, the
    /// resolution, and the choice to omit the record of the run.
    pub fn new(
        metadata: &Metadata,
        layers: &[Aov],
        crop_window: Option<CropWindow>,
        overlay: Option<&OverlaySpec>,
        output: &OutputSpec,
    ) -> Self {
        let mut metadata = metadata.clone();
        metadata.run = metadata.run.filter(|_| output.with_run_record);
        metadata.overlay = overlay.cloned();
        let options = WriteOptions {
            crop_window,
            view_transform: output.look,
            dpi: output.dpi,
            overlay: overlay.map(|overlay| Arc::new(overlay.draw())),
            ..WriteOptions::default()
        };
        Self { options, metadata, layers: layers.to_vec() }
    }

    /// Names the columns of the scene's tables that are layers of the picture, too.
    #[must_use]
    pub fn with_columns(mut self, names: Vec<String>) -> Self {
        self.metadata.column_layers = names;
        self
    }

    /// Favours writing speed over file size.
    #[must_use]
    pub fn fast(mut self, fast: bool) -> Self {
        self.options.fast = fast;
        self
    }

    /// The options for a file of this format.
    ///
    /// # Errors
    /// If a path cannot be serialized.
    pub fn options_for(&self, format: FileFormat) -> Result<WriteOptions> {
        let Self { options, metadata, layers } = self;
        let is_usual = options.view_transform == ViewTransform::default();
        let shows_overlay = format.is_display_referred() || format.has_layers();
        let metadata = Metadata {
            look: (format.is_display_referred() && !is_usual).then_some(options.view_transform),
            overlay: metadata.overlay.clone().filter(|_| shows_overlay),
            layers: format.has_layers().then(|| layers.clone()),
            column_layers: match format.has_layers() {
                true => metadata.column_layers.clone(),
                false => Vec::new(),
            },
            ..metadata.clone()
        };
        Ok(WriteOptions { metadata: metadata.to_records()?, ..options.clone() })
    }
}
