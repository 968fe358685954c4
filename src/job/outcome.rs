//! What a render came to.

use std::fmt;
use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::error::Result;
use crate::film::{Film, FilmFrame};
use crate::image_io::Picture;
use crate::image_io::{CropWindow, ImageWriter, WriteOptions};
use crate::integrator::RenderStats;
use crate::scene::PreparedScene;

use super::adaptive::NoiseProgress;
use super::metadata::Metadata;
use super::noise::NoiseTarget;

/// A finished render.
#[derive(Clone, Debug)]
pub struct RenderResult {
    /// The picture with its layers.
    pub picture: Picture,
    /// How it was made.
    pub metadata: Metadata,
    /// How the render ended.
    pub stop_reason: StopReason,
    /// How far the noise target is met, where there is one.
    pub noise: Option<NoiseStatus>,
    /// The error that 95 % of the values stay below, or the share that a noise target names, as a share
    /// of the brightness; `None` where it is not known.
    pub error: Option<f64>,
    /// Samples of the picture.
    pub samples: u64,
    /// Rays traced, shadow rays included.
    pub rays: u64,
    /// Seconds of rendering.
    pub seconds: f64,
    /// What the user should know about the picture.
    pub warnings: Vec<String>,
}

/// What a render came to, before it is saved or shown.
#[derive(Clone, Debug)]
pub struct RunOutcome {
    /// How it ended.
    pub stop_reason: StopReason,
    /// How far the noise target is met, where there is one.
    pub noise: Option<NoiseStatus>,
    /// The error that a share of the values stay below.
    pub error: Option<f64>,
}

/// How a render ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StopReason {
    /// It has all that was asked for.
    Finished,
    /// Its time was up.
    TimeLimit,
    /// It has the most samples that there may be, and some squares are noisier than was asked for.
    NoiseTargetMissed,
    /// It was stopped.
    Stopped,
    /// A thread that renders failed in an unexpected way, which is a fault of this library. The samples
    /// so far are good.
    Failed,
}

/// How far a noise target is met.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NoiseStatus {
    /// What is asked for.
    pub target: NoiseTarget,
    /// Squares of the picture.
    pub squares: usize,
    /// Squares that meet the target.
    pub done: usize,
    /// The error of the square that is worst; `None` where one is not known.
    pub worst: Option<f64>,
}

impl RenderResult {
    /// Writes the picture with how it was made, whole; the file's extension chooses the format: `.png`
    /// for the screen, `.exr` with the layers, `.hdr` or `.pfm`.
    ///
    /// # Errors
    /// When it cannot be written; a file that was there before is then unchanged.
    pub fn write(&self, path: impl AsRef<Path>) -> Result<()> {
        let target = ImageWriter::new(path.as_ref())?;
        let mut metadata = self.metadata.clone();
        if !target.has_layers() {
            metadata.layers = None;
        }
        let crop = metadata.settings.image.crop;
        let cropped_from = crop.map(|crop| CropWindow {
            full_size: [metadata.settings.image.width, metadata.settings.image.height]
                .map(|pixels| pixels as usize),
            offset: [crop.x, crop.y].map(|pixels| pixels as usize),
        });
        let records = metadata.to_records()?;
        target.write_with(
            &self.picture,
            &WriteOptions {
                crop_window: cropped_from,
                metadata: records,
                ..WriteOptions::default()
            },
        )
    }
}

impl NoiseStatus {
    /// Whether all squares meet the target.
    pub fn is_met(&self) -> bool {
        self.done == self.squares
    }
}

impl From<&NoiseProgress> for NoiseStatus {
    fn from(standing: &NoiseProgress) -> Self {
        let NoiseProgress {
            target, tiles: squares, tiles_converged: done, worst_error: worst, ..
        } = *standing;
        Self { target, squares, done, worst: worst.is_finite().then_some(worst) }
    }
}

/// What to tell where it is not met.
impl fmt::Display for NoiseStatus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { target, squares, done, worst } = self;
        let target = format_percent(target.error);
        write!(
            f,
            "the noise target of {target} is not met in {} of {squares} squares; ",
            squares - done
        )?;
        match worst {
            Some(worst) => write!(f, "the worst has an error of {}", format_percent(*worst)),
            None => f.write_str("their errors are not known yet"),
        }
    }
}

/// A share in three digits: `1.23 %`.
pub(crate) fn format_percent(share: f64) -> String {
    let decimals = match 100.0 * share {
        x if x < 9.995 => 2,
        x if x < 99.95 => 1,
        _ => 0,
    };
    format!("{:.decimals$} %", 100.0 * share)
}

/// Which part of the whole picture a film is, unless it is all of it.
pub fn frame_crop(frame: &FilmFrame) -> Option<CropWindow> {
    let FilmFrame { full_size, window } = *frame;
    (*frame != FilmFrame::full(full_size[0], full_size[1])).then(|| CropWindow {
        full_size: full_size.map(|pixels| pixels as usize),
        offset: [window.x, window.y].map(|pixels| pixels as usize),
    })
}

/// What the user should know about a film of a shot.
pub fn render_warnings(shot: &PreparedScene, tally: &RenderStats, film: &Film) -> Vec<String> {
    let mut warnings = Vec::new();
    if shot.render_settings().clamp_indirect.is_some() {
        let options = shot.render_settings().biases().join(", ");
        warnings.push(format!("the picture is biased by {options}"));
    }
    if let Some((count, [x, y])) = film.non_finite_samples() {
        warnings.push(format!(
            "{count} samples were infinite or not a number and were left out, such as in column {x}, \
             row {y}: please report this"
        ));
    }
    if tally.media_overflows > 0 {
        let count = tally.media_overflows;
        warnings.push(format!("{count} paths were inside more than 8 dielectric spheres at once"));
    }
    if tally.truncated_paths > 0 {
        let count = tally.truncated_paths;
        warnings.push(format!("{count} paths were cut off after 10000 edges, which loses light"));
    }
    warnings
}
