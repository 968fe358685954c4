//! The header of a checkpoint. One declaration defines how it is written and read as JSON.

use std::fs::File;
use std::io::BufReader;
use std::ops::Range;
use std::path::PathBuf;
use std::time::Duration;

use serde::{Deserialize, Serialize};

use crate::color::ViewTransform;
use crate::film::{BLOCK_SIZE, FilmFormat, Layer};
use crate::math::Rect;
use crate::scene::SceneSource;

use super::super::metadata::Metadata;
use super::super::outcome::NoiseStatus;
use super::super::spec::Job;
use super::hashing::HashingStream;
use super::read_error::ReadError;
use super::version::{MAGIC, MIN_VERSION, VERSION};

/// Maximum header length: a scene's description and its text, with a margin.
const MAX_HEADER_BYTES: u32 = 16 << 20;

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
    /// Where the picture goes; `None` in a merged checkpoint.
    pub delivery: Option<OutputSpec>,
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
        /// The noise targets that were missed, one for each part that missed its own.
        missed: Vec<NoiseStatus>,
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
    /// Paths that were inside more dielectric spheres than the medium stack can hold.
    pub media_overflows: u64,
    /// Paths cut off at the hard limit on path length.
    pub cut_off: u64,
}

/// Output files and previews of a render.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OutputSpec {
    /// The picture files, as absolute paths.
    pub files: Vec<FilePath>,
    /// View transform for display formats.
    pub look: ViewTransform,
    /// Resolution of display formats, in pixels per inch.
    #[serde(default)]
    pub dpi: Option<u32>,
    /// True if picture files include the record of the run.
    pub with_run: bool,
    /// Time between checkpoint writes.
    pub save_every: Duration,
    /// The file for previews, as an absolute path.
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
            with_run: true,
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
    /// Returns true if the film format and sample range are consistent.
    fn is_valid(&self) -> bool {
        let FilmFormat { frame, first_sample, ref layers, .. } = self.film;
        let Rect { x, y, width, height } = frame.window;
        let fits = |first: u32, length: u32, full: u32| {
            length > 0
                && u64::from(first) + u64::from(length) <= u64::from(full)
                && full <= MAX_SIDE
        };
        let is_twice = |(at, layer): (usize, &Layer)| layers[..at].contains(layer);
        fits(x, width, frame.full_size[0])
            && fits(y, height, frame.full_size[1])
            && first_sample % BLOCK_SIZE == 0
            && first_sample == self.samples.start
            && self.samples.start <= self.samples.end
            && !layers.iter().enumerate().any(is_twice)
    }
}

pub(super) fn read(
    from: &mut HashingStream<BufReader<File>>,
    bytes: u64,
) -> std::result::Result<CheckpointHeader, ReadError> {
    let mut magic = [0; 8];
    match from.read_exact(&mut magic) {
        Ok(()) if magic == MAGIC => {}
        Ok(()) | Err(ReadError::Truncated(_)) => return Err(ReadError::NotACheckpoint),
        Err(other) => return Err(other),
    }
    let version = from.read_u32()?;
    if version > VERSION {
        return Err(ReadError::TooNew(version));
    }
    if version < MIN_VERSION {
        return Err(ReadError::TooOld(version));
    }
    let length = from.read_u32()?;
    if length > MAX_HEADER_BYTES {
        return Err(ReadError::Corrupt("its header is too long"));
    }
    if u64::from(length) > bytes {
        return Err(ReadError::Truncated(bytes));
    }
    let mut text = vec![0; length as usize];
    from.read_exact(&mut text)?;
    from.verify_hash()?;
    let header: CheckpointHeader =
        serde_json::from_slice(&text).map_err(|e| match e.classify() {
            serde_json::error::Category::Data => {
                ReadError::UnsupportedHeader(format!("its header says: {e}"))
            }
            _ => ReadError::Corrupt("its header is no JSON"),
        })?;
    let is_possible = header.is_valid();
    is_possible.then_some(header).ok_or(ReadError::Corrupt("its header says something impossible"))
}
