//! Picture metadata: a record of how a picture was made, complete enough to render it again and to
//! explain any difference.
//!
//! Each field of [`Metadata`] is stored in the file as a record under its own name: strings as they
//! are, everything else as JSON. One declaration defines both writing and reading. All fields
//! except [`Metadata::run`] determine the pixels, so rendering the same job again produces the same
//! records. [`RunRecord`] describes one run: the command, the time, the machine.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use crate::accel::{self, Backend};
use crate::color::ViewTransform;
use crate::error::{Error, Result};
use crate::film::Aov;
use crate::image_io::{MetadataEntry, PngDepth};
use crate::overlay::OverlaySpec;
use crate::scene::settings::IntegratorSettings;
use crate::scene::{ContentHash, FileHash, PreparedScene, Scene, SceneDescription, Settings};

use super::noise::NoiseTarget;
use super::noise_status::NoiseStatus;
use super::samples::{MergedSamples, SampleRange, TileSampleCounts};

/// The version of this program.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// The commit that this program was built from, with a mark if the tree was modified; `unknown` if
/// the build found no repository.
pub const COMMIT: &str = env!("PHOTOSPHERE_COMMIT");

/// Maximum size in bytes of a scene description embedded in a picture.
const MAX_DESCRIPTION_BYTES: usize = 1 << 20;

/// Everything that a picture file records besides the pixels.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub struct Metadata {
    /// Version of the program.
    pub version: String,
    /// Commit that the program was built from.
    pub commit: String,
    /// Identity of the scene: [`Scene::content_hash`].
    pub scene_identity: ContentHash,
    /// Identity of the computation. Samples whose scene and job identities are equal may be merged.
    pub job_identity: ContentHash,
    /// The intersector that found the hits.
    pub intersector: Backend,
    /// The settings, with the picture's number of samples per pixel.
    pub settings: Settings,
    /// The sample indices of the pixels.
    pub samples: SampleRange,
    /// Samples per film tile, if they differ.
    #[serde(default, skip_serializing_if = "TileSampleCounts::is_uniform")]
    pub counts: TileSampleCounts,
    /// Samples of each part, if `samples` and `counts` cannot describe them.
    #[serde(default, skip_serializing_if = "MergedSamples::is_empty")]
    pub parts: MergedSamples,
    /// The options that bias the picture.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub biased: Vec<String>,
    /// The view transform of a display format, if it is not the default.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub look: Option<ViewTransform>,
    /// Bits per channel of a display format, if they are not the default.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bits: Option<PngDepth>,
    /// What was done to the rendered pixels afterwards, other than showing them. Such a picture
    /// cannot be rendered again as it is.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub converted: Vec<String>,
    /// What is drawn over the picture.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub overlay: Option<OverlaySpec>,
    /// The AOVs, in formats that store them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub layers: Option<Vec<Aov>>,
    /// Columns of the particle file that are layers, too.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub column_layers: Vec<String>,
    /// The files of the scene, as the scene names them, with the hashes of their values.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub files: Vec<FileHash>,
    /// The scene; `None` if it is too large to embed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scene: Option<SceneDescription>,
    /// Record of the run; `None` if omitted.
    #[serde(flatten)]
    pub run: Option<RunRecord>,
}

/// Facts about one run. None of them affects the pixels.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub struct RunRecord {
    /// Rays traced.
    pub rays: u64,
    /// Render time in seconds, without loading and building.
    pub seconds: f64,
    /// Number of threads.
    pub threads: usize,
    /// The noise target, if there was one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub noise: Option<NoiseTarget>,
    /// The error that 95 % of the values stay below (or the fraction of the noise target), relative
    /// to the brightness.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<f64>,
    /// The noise target, if the picture does not reach it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub missed: Option<NoiseStatus>,
    /// The intersector and the reason for choosing it.
    pub intersector_choice: String,
    /// The Embree version and configuration, if available.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub embree: Option<String>,
    /// The shell-quoted command line.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub command: Option<String>,
    /// Full path of the scene file.
    #[serde(
        default,
        with = "crate::scene::paths::optional",
        skip_serializing_if = "Option::is_none"
    )]
    pub scene_file: Option<PathBuf>,
    /// Text of the scene file, which describes the same scene as [`Metadata::scene`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scene_text: Option<String>,
}

/// The data whose hash is the job identity.
#[derive(Serialize)]
struct CanonicalJob {
    encoding: u32,
    version: &'static str,
    intersector: Backend,
    settings: Settings,
}

impl Metadata {
    /// Metadata of a picture without samples.
    pub(super) fn new(prepared: &PreparedScene, backend: Backend) -> Self {
        let scene = prepared.scene();
        Self {
            version: VERSION.to_owned(),
            commit: COMMIT.to_owned(),
            scene_identity: scene.content_hash(),
            job_identity: job_identity(prepared.settings(), backend),
            intersector: backend,
            settings: *prepared.settings(),
            samples: SampleRange::first_n(0),
            counts: TileSampleCounts::default(),
            parts: MergedSamples::default(),
            biased: prepared.render_settings().biases(),
            look: None,
            bits: None,
            converted: Vec::new(),
            overlay: None,
            layers: None,
            column_layers: Vec::new(),
            files: relative_files(scene),
            scene: embedded_description(scene),
            run: None,
        }
    }

    /// Adds the samples of the picture. The settings are normalized so that equal pictures have
    /// equal settings.
    pub(super) fn with_samples(
        self,
        samples: SampleRange,
        counts: TileSampleCounts,
        parts: MergedSamples,
    ) -> Self {
        let mut settings = self.settings;
        if !settings.render.sampler.depends_on_sample_count() {
            set_sample_count(&mut settings, samples.first + samples.max_count);
        }
        Self { settings, samples, counts, parts, ..self }
    }

    /// The sample indices as text: `0..64`, or `0..16, 32..64` if some are missing in between, with
    /// a note if some pixels lack samples.
    pub fn samples_to_string(&self) -> String {
        if self.parts.is_empty() {
            return self.samples.to_string();
        }
        let ranges = self.parts.ranges_to_string();
        match self.parts.all_cover(&self.settings.image.pixel_bounds()) {
            true => ranges,
            false => format!("{ranges} (some pixels have fewer)"),
        }
    }

    /// Converts the metadata to file records.
    ///
    /// # Errors
    /// If a path cannot be serialized.
    pub fn to_records(&self) -> Result<Vec<MetadataEntry>> {
        let value = serde_json::to_value(self);
        let value =
            value.map_err(|e| Error::input(format!("cannot serialize the metadata: {e}")))?;
        let Value::Object(fields) = value else { return Ok(Vec::new()) };
        Ok(fields
            .into_iter()
            .map(|(name, value)| MetadataEntry::new(&name, record_text(value)))
            .collect())
    }

    /// Reads metadata from the records of the file `picture`.
    ///
    /// # Errors
    /// If a record is missing or invalid. The message names the picture.
    pub fn from_records(picture: &Path, records: &[MetadataEntry]) -> Result<Self> {
        let path = picture.display();
        if !records.iter().any(|record| record.name == "scene-identity") {
            let message = format!("`{path}` has no metadata of photosphere");
            let has_old_records = records.iter().any(|record| record.name == "identity");
            let help = match has_old_records {
                true => "an older version of photosphere wrote it: use that version",
                false => "other programs may drop the metadata when they save a picture",
            };
            return Err(Error::input(message).with_help(help));
        }
        let fields: Map<String, Value> =
            records.iter().map(|record| (record.name.clone(), record_value(record))).collect();
        serde_json::from_value(Value::Object(fields)).map_err(|e| {
            let message = format!("the metadata of `{path}` is not understood: {e}");
            Error::input(message).with_help("another version of photosphere may have written it")
        })
    }
}

/// Text of a record: a string is stored as it is unless it parses as JSON; any other value is
/// stored as JSON.
fn record_text(value: Value) -> String {
    match value {
        Value::String(text) if serde_json::from_str::<Value>(&text).is_err() => text,
        other => other.to_string(),
    }
}

/// The value of a record: JSON if it parses, otherwise a string.
pub fn record_value(record: &MetadataEntry) -> Value {
    serde_json::from_str(&record.text).unwrap_or_else(|_| Value::String(record.text.clone()))
}

/// Sets the number of samples per pixel. The `paper` integrator rounds it up to whole sub-pixel
/// grids.
pub(super) fn set_sample_count(settings: &mut Settings, samples: u32) {
    let render = &mut settings.render;
    match &mut render.integrator {
        IntegratorSettings::Paper(paper) => {
            // The settings are not validated yet and may hold any number.
            let cells = paper.subpixels.saturating_pow(2).max(1);
            paper.samples = samples.div_ceil(cells).max(1);
            render.samples_per_pixel = paper.samples.saturating_mul(cells);
        }
        _ => render.samples_per_pixel = samples.max(1),
    }
}

/// Hash of everything besides the scene that affects the value of a sample. The choice of pixels
/// and samples is excluded.
pub(super) fn job_identity(settings: &Settings, intersector: Backend) -> ContentHash {
    let mut settings = *settings;
    settings.image.crop = None;
    let render = &settings.render;
    let is_centred = render.samples_per_pixel == 1;
    // Keep the sample count only if it changes the value of each sample.
    let samples = match (render.sampler.depends_on_sample_count(), render.integrator) {
        (true, _) => render.samples_per_pixel,
        (_, IntegratorSettings::Normals | IntegratorSettings::Raycast { .. }) => {
            if is_centred {
                1
            } else {
                2
            }
        }
        _ => 1,
    };
    set_sample_count(&mut settings, samples);
    let canonical = CanonicalJob { encoding: 6, version: VERSION, intersector, settings };
    let bytes = serde_json::to_vec(&canonical);
    ContentHash::of_bytes(&bytes.expect("plain values with string keys serialize to JSON"))
}

/// The scene description to embed, with file names as the scene gives them.
pub(super) fn embedded_description(scene: &Scene) -> Option<SceneDescription> {
    // An inline sphere takes at least a hundred bytes.
    if scene.description().spheres.len() > MAX_DESCRIPTION_BYTES / 64 {
        return None;
    }
    let mut description = scene.description().clone();
    let folder = scene.source().map_or(Path::new(""), |source| &source.folder);
    description.for_each_file(|file| {
        if let Ok(relative) = file.strip_prefix(folder) {
            *file = relative.to_path_buf();
        }
    });
    let length = serde_json::to_vec(&description).ok()?.len();
    (length <= MAX_DESCRIPTION_BYTES).then_some(description)
}

fn relative_files(scene: &Scene) -> Vec<FileHash> {
    let folder = scene.source().map_or(Path::new(""), |source| &source.folder);
    let relative = |FileHash { file, hash }: &FileHash| FileHash {
        file: file.strip_prefix(folder).unwrap_or(file).to_path_buf(),
        hash: *hash,
    };
    scene.files().iter().map(relative).collect()
}

/// Versions and configuration of the Embree in use.
pub(super) fn embree_summary() -> Option<String> {
    let info = accel::embree_info()?.ok()?;
    Some(format!(
        "{}, compiled against {}, {}, {}",
        info.runtime_version, info.compiled_version, info.instruction_set, info.tasking
    ))
}
