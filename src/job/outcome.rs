//! The outcome of a render.

use std::path::Path;

use crate::error::Result;
use crate::film::FilmFrame;
use crate::image_io::Picture;
use crate::image_io::{CropWindow, ImageWriter, WriteOptions};

use super::metadata::Metadata;
use super::noise_status::NoiseStatus;

/// A finished render.
#[derive(Clone, Debug)]
pub struct RenderResult {
    /// The picture with its layers.
    pub picture: Picture,
    /// The record of how the picture was made.
    pub metadata: Metadata,
    /// Why the render ended.
    pub stop_reason: StopReason,
    /// Status of the noise target, if there is one.
    pub noise: Option<NoiseStatus>,
    /// The error that 95 % of the values stay below (or the fraction of the noise target), relative
    /// to the brightness; `None` if unknown.
    pub error: Option<f64>,
    /// Samples in the picture.
    pub samples: u64,
    /// Rays traced, including shadow rays.
    pub rays: u64,
    /// Render time in seconds.
    pub seconds: f64,
    /// Warnings for the user about the picture.
    pub warnings: Vec<String>,
}

/// The outcome of a run, before the picture is saved or shown.
#[derive(Clone, Debug)]
pub struct RunOutcome {
    /// Why the run ended.
    pub stop_reason: StopReason,
    /// Status of the noise target, if there is one.
    pub noise: Option<NoiseStatus>,
    /// The error that 95 % of the values stay below (or the fraction of the noise target), relative
    /// to the brightness; `None` if unknown.
    pub error: Option<f64>,
}

/// Why a render ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StopReason {
    /// All requested samples are rendered and the noise target, if any, is met.
    Finished,
    /// The time limit was reached.
    TimeLimit,
    /// The maximum number of samples was reached, but some tiles miss the noise target.
    NoiseTargetMissed,
    /// The render was stopped or cancelled.
    Stopped,
    /// A render thread panicked, which is a bug in this library. The samples so far are valid.
    Failed,
}

impl RenderResult {
    /// Writes the picture and its metadata atomically. The extension selects the format: `.png` for
    /// display, `.exr` with all layers, `.hdr` or `.pfm`.
    ///
    /// # Errors
    /// If writing fails; an existing file is then unchanged.
    pub fn write(&self, path: impl AsRef<Path>) -> Result<()> {
        let target = ImageWriter::new(path.as_ref())?;
        let mut metadata = self.metadata.clone();
        if !target.has_layers() {
            metadata.layers = None;
        }
        let crop = metadata.settings.image.crop;
        let crop_window = crop.map(|crop| CropWindow {
            full_size: [metadata.settings.image.width, metadata.settings.image.height]
                .map(|pixels| pixels as usize),
            offset: [crop.x, crop.y].map(|pixels| pixels as usize),
        });
        let records = metadata.to_records()?;
        target.write_with(
            &self.picture,
            &WriteOptions { crop_window, metadata: records, ..WriteOptions::default() },
        )
    }
}

/// The film's window within the full picture; `None` if the film covers all of it.
pub fn frame_crop(frame: &FilmFrame) -> Option<CropWindow> {
    let FilmFrame { full_size, window } = *frame;
    (*frame != FilmFrame::full(full_size[0], full_size[1])).then(|| CropWindow {
        full_size: full_size.map(|pixels| pixels as usize),
        offset: [window.x, window.y].map(|pixels| pixels as usize),
    })
}
