//! The header of a checkpoint. One declaration defines how it is written and read as JSON.

use std::ops::Range;
use std::path::PathBuf;
use std::time::Duration;

use serde::{Deserialize, Serialize};

use crate::color::ViewTransform;
use crate::error::{Error, Result};
use crate::film::{BLOCK_SIZE, FilmFormat, Layer};
use crate::math::Rect;
use crate::overlay::OverlayChoice;
use crate::scene::SceneSource;

use super::super::metadata::Metadata;
use super::super::noise_status::NoiseStatus;
use super::super::samples::TileSampleCounts;
use super::super::spec::Job;
use super::hashing::HashingStream;
use super::read_error::ReadError;
use super::source::Source;
use super::version::{MAGIC, MIN_VERSION, VERSION};

/// Maximum header length: a scene's description and its text, with a margin. Longer headers are
/// neither written nor read.
const MAX_HEADER_BYTES: usize = 16 << 20;

/// Maximum picture width or height in pixels.
const MAX_SIDE: u32 = 1 << 24;

/// The header of a checkpoint.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CheckpointHeader {
    /// Format of the film.
    pub film: FilmFormat,
    /// The sample indices that every pixel will have when the render is complete.
    pub samples: Range<u32>,
    /// The render job.
    pub job: Job,
    /// Metadata of the picture of the samples so far.
    pub metadata: Metadata,
    /// Completion state of the render.
    pub status: RenderStatus,
    /// Cumulative statistics of all runs.
    pub statistics: CumulativeStats,
    /// True if the scene makes the background transparent.
    pub transparent: bool,
    /// The scene file, without its text.
    pub source: Option<SceneSource>,
    /// Output files; `None` in a merged checkpoint.
    pub output: Option<OutputSpec>,
}

/// Completion state of a render.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(tag = "state", rename_all = "kebab-case", deny_unknown_fields)]
pub enum RenderStatus {
    /// Some requested samples are missing.
    #[default]
    Unfinished,
    /// The render has ended, possibly at its time limit.
    Ended {
        /// The missed noise targets, one for each part that missed its own.
        missed_targets: Vec<NoiseStatus>,
    },
}

/// Statistics of a render over all its runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CumulativeStats {
    /// Rays traced.
    pub rays: u64,
    /// Render time in seconds.
    pub seconds: f64,
    /// Paths cut off at the hard limit on path length.
    pub truncated_paths: u64,
}

/// Output files and previews of a render. A checkpoint records what the program that renders wants
/// to find again; whoever resumes one decides what to trust.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OutputSpec {
    /// The picture files. In a checkpoint, relative paths start at its folder.
    pub files: Vec<FilePath>,
    /// View transform for display formats.
    pub look: ViewTransform,
    /// Resolution of display formats, in pixels per inch.
    #[serde(default)]
    pub dpi: Option<u32>,
    /// What is drawn over the pictures.
    #[serde(default)]
    pub overlay: OverlayChoice,
    /// Columns of the particle file that are layers of the pictures.
    #[serde(default)]
    pub columns: Vec<String>,
    /// True if the pictures are denoised; the samples never are.
    #[serde(default)]
    pub denoise: bool,
    /// True if picture files include the record of the run.
    pub with_run_record: bool,
    /// Time between checkpoint writes.
    pub save_every: Duration,
    /// The file for previews, likewise.
    pub preview: Option<FilePath>,
    /// Time between preview updates.
    pub preview_every: Duration,
    /// Address of a tev viewer.
    pub tev: Option<String>,
}

impl Default for OutputSpec {
    /// No output file, and a checkpoint every minute.
    fn default() -> Self {
        Self {
            files: Vec::new(),
            look: ViewTransform::default(),
            dpi: None,
            overlay: OverlayChoice::default(),
            columns: Vec::new(),
            denoise: false,
            with_run_record: true,
            save_every: Duration::from_secs(60),
            preview: None,
            preview_every: Duration::from_secs(2),
            tev: None,
        }
    }
}

/// A path that serializes even if it is not valid UTF-8.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct FilePath(#[serde(with = "crate::scene::paths")] pub PathBuf);

impl CheckpointHeader {
    /// Encodes the header as JSON. The sample counts of a huge picture are left out if they would
    /// make it too long: the film has them, too.
    ///
    /// # Errors
    /// If the header is still too long to be read again.
    pub(in crate::job) fn encode(&self) -> Result<String> {
        let mut text = self.to_json()?;
        if text.len() > MAX_HEADER_BYTES {
            let mut shorter = self.clone();
            shorter.metadata.counts = TileSampleCounts::default();
            let parts = &mut shorter.metadata.parts.0;
            parts.iter_mut().for_each(|part| part.counts = TileSampleCounts::default());
            text = shorter.to_json()?;
        }
        if text.len() > MAX_HEADER_BYTES {
            let message = format!(
                "the header of the checkpoint has {} bytes, more than the {MAX_HEADER_BYTES} that \
                 can be read again",
                text.len()
            );
            return Err(Error::input(message).with_help(
                "the header names all files and overrides of the scene: join its sphere tables, or \
                 write the overrides into the scene",
            ));
        }
        Ok(text)
    }

    fn to_json(&self) -> Result<String> {
        serde_json::to_string(self)
            .map_err(|e| Error::input(format!("a checkpoint cannot say what it is: {e}")))
    }

    /// Returns true if the film format and sample range are consistent.
    fn is_valid(&self) -> bool {
        let FilmFormat { frame, first_sample, ref layers, .. } = self.film;
        let Rect { x, y, width, height } = frame.window;
        let fits = |first: u32, length: u32, full: u32| {
            length > 0
                && u64::from(first) + u64::from(length) <= u64::from(full)
                && full <= MAX_SIDE
        };
        let is_repeated = |(index, layer): (usize, &Layer)| layers[..index].contains(layer);
        fits(x, width, frame.full_size[0])
            && fits(y, height, frame.full_size[1])
            && first_sample % BLOCK_SIZE == 0
            && first_sample == self.samples.start
            && self.samples.start <= self.samples.end
            && !layers.iter().enumerate().any(is_repeated)
    }
}

pub(super) fn read(
    stream: &mut HashingStream<Source>,
) -> std::result::Result<CheckpointHeader, ReadError> {
    let bytes = stream.inner.length();
    let mut magic = [0; 8];
    match stream.read_exact(&mut magic) {
        Ok(()) if magic == MAGIC => {}
        Ok(()) | Err(ReadError::Truncated(_)) => return Err(ReadError::NotACheckpoint),
        Err(other) => return Err(other),
    }
    let version = stream.read_u32()?;
    if version > VERSION {
        return Err(ReadError::TooNew(version));
    }
    if version < MIN_VERSION {
        return Err(ReadError::TooOld(version));
    }
    let length = stream.read_u32()?;
    if length as usize > MAX_HEADER_BYTES {
        return Err(ReadError::Corrupt("its header is too long"));
    }
    if u64::from(length) > bytes {
        return Err(ReadError::Truncated(bytes));
    }
    let mut text = vec![0; length as usize];
    stream.read_exact(&mut text)?;
    stream.verify_hash()?;
    let header: CheckpointHeader =
        serde_json::from_slice(&text).map_err(|e| match e.classify() {
            serde_json::error::Category::Data => {
                ReadError::UnsupportedHeader(format!("its header is not supported: {e}"))
            }
            _ => ReadError::Corrupt("its header is not JSON"),
        })?;
    let is_valid = header.is_valid();
    is_valid.then_some(header).ok_or(ReadError::Corrupt("its header is inconsistent"))
}
