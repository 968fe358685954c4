//! What a checkpoint says of itself, as JSON: one declaration, written and read.

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

/// The longest header: a scene's description and text, and some.
const MAX_HEADER_BYTES: u32 = 16 << 20;

/// The most pixels along a picture.
const MAX_SIDE: u32 = 1 << 24;

/// What a checkpoint says of itself.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CheckpointHeader {
    /// What the film holds.
    pub film: FilmFormat,
    /// The indices of the samples that every pixel is to have in the end.
    pub samples: Range<u32>,
    /// The render.
    pub job: Job,
    /// The picture of the samples so far.
    pub metadata: Metadata,
    /// Whether it is over.
    pub status: RenderStatus,
    /// What it took.
    pub statistics: CumulativeStats,
    /// Whether the scene leaves the background out of its pictures.
    pub transparent: bool,
    /// The scene file, without its text.
    pub source: Option<SceneSource>,
    /// Where the picture goes; `None` in a checkpoint that was merged.
    pub delivery: Option<OutputSpec>,
}

/// Whether a render is over.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(tag = "state", rename_all = "kebab-case", deny_unknown_fields)]
pub enum RenderStatus {
    /// It lacks samples that it is to have.
    #[default]
    Unfinished,
    /// It has come to its end, be that the end of its time. `missed` are noise targets that its parts did
    /// not meet.
    Ended {
        /// One for each part that did not.
        missed: Vec<NoiseStatus>,
    },
}

/// What a render took, in all its runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CumulativeStats {
    /// Rays traced.
    pub rays: u64,
    /// Seconds of rendering.
    pub seconds: f64,
    /// Paths that were inside more dielectric spheres than can be remembered.
    pub media_overflows: u64,
    /// Paths cut off at the hard limit on their length.
    pub cut_off: u64,
}

/// Where the picture of a render goes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OutputSpec {
    /// The files, from the root on.
    pub files: Vec<FilePath>,
    /// How files for the screen show light.
    pub look: ViewTransform,
    /// Whether files say what the run was like.
    pub with_run: bool,
    /// How often the checkpoint is written.
    pub save_every: Duration,
    /// The file for the picture so far, from the root on.
    pub preview: Option<FilePath>,
    /// How often that is written.
    pub preview_every: Duration,
    /// Where the viewer tev listens.
    pub tev: Option<String>,
}

impl Default for OutputSpec {
    /// No file, and a checkpoint every minute.
    fn default() -> Self {
        Self {
            files: Vec::new(),
            look: ViewTransform::default(),
            with_run: true,
            save_every: Duration::from_secs(60),
            preview: None,
            preview_every: Duration::from_secs(2),
            tev: None,
        }
    }
}

/// A path, also one that is no text.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct FilePath(#[serde(with = "crate::scene::paths")] pub PathBuf);

impl CheckpointHeader {
    /// Whether the numbers can be those of a film.
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
