//! How a picture was made, as its file says it: enough to render it again, and to tell what differs
//! where the result does.
//!
//! The fields of [`Metadata`] are the records of the file: each is written under its own name, texts as
//! they are and everything else as JSON, and read back by the same declaration. The first group, all
//! but [`Metadata::run`], is what decides the pixels: whoever renders the same thing again gets the
//! same records. [`RunRecord`] is about one run: the command, the time, the machine.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use crate::accel::{self, Backend, Intersector};
use crate::color::ViewTransform;
use crate::error::{Error, Result};
use crate::film::Aov;
use crate::image_io::MetadataEntry;
use crate::scene::data::SphereData;
use crate::scene::description::EnvironmentDescription;
use crate::scene::settings::IntegratorSettings;
use crate::scene::{ContentHash, FileHash, PreparedScene, Scene, SceneDescription, Settings};

use super::noise::NoiseTarget;
use super::samples::{MergedSamples, SampleRange, TileSampleCounts};

/// The version of this program.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// The commit that this program was built from, and whether it was changed; `unknown` where the build
/// found no repository.
pub const COMMIT: &str = env!("PHOTOSPHERE_COMMIT");

/// The longest description of a scene, in bytes, that goes along with a picture.
const MAX_DESCRIPTION_BYTES: usize = 1 << 20;

/// All that the file of a picture says of it beside the pixels.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub struct Metadata {
    /// The program's version.
    pub version: String,
    /// The commit that it was built from.
    pub commit: String,
    /// What the scene is: [`Scene::content_hash`].
    pub scene_identity: ContentHash,
    /// What was computed of it, and what with: samples of equal identities may be added up.
    pub job_identity: ContentHash,
    /// What found the hits.
    pub intersector: Intersector,
    /// The settings, with as many samples per pixel as the picture has.
    pub settings: Settings,
    /// Which samples of each pixel.
    pub samples: SampleRange,
    /// How many of them in each tile, where that differs.
    #[serde(default, skip_serializing_if = "TileSampleCounts::is_uniform")]
    pub counts: TileSampleCounts,
    /// The samples of each of its parts, where those two do not tell it.
    #[serde(default, skip_serializing_if = "MergedSamples::is_empty")]
    pub parts: MergedSamples,
    /// The options that bias the picture.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub biased: Vec<String>,
    /// How a file for the screen shows light, where that is not the usual way.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub look: Option<ViewTransform>,
    /// The layers, in a file that has a place for them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub layers: Option<Vec<Aov>>,
    /// The files of the scene, as it names them, with the hashes of their numbers.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub files: Vec<FileHash>,
    /// The scene; `None` where it is too long to go along.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scene: Option<SceneDescription>,
    /// What one run was like; `None` where it is left out.
    #[serde(flatten)]
    pub run: Option<RunRecord>,
}

/// Figures of one run; nothing of them decides the pixels.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub struct RunRecord {
    /// Rays traced.
    pub rays: u64,
    /// Seconds that rendering took, without loading and building.
    pub seconds: f64,
    /// Threads that it took.
    pub threads: usize,
    /// The noise that was asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub noise: Option<NoiseTarget>,
    /// The error that 95 % of the values stay below, or another share where one was asked for, as a
    /// share of the brightness.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<f64>,
    /// Which intersector found the hits, and why it.
    pub intersector_choice: String,
    /// The Embree that there is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub embree: Option<String>,
    /// The command line, quoted for a shell.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub command: Option<String>,
    /// The scene file's full path.
    #[serde(
        default,
        with = "crate::scene::paths::optional",
        skip_serializing_if = "Option::is_none"
    )]
    pub scene_file: Option<PathBuf>,
    /// The text of the scene file, which says the same as `scene` in the user's own words.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scene_text: Option<String>,
}

/// What a job's identity is the hash of.
#[derive(Serialize)]
struct CanonicalJob<'a> {
    encoding: u32,
    version: &'static str,
    intersector: &'a Intersector,
    settings: Settings,
}

impl Metadata {
    /// Of a picture of a shot by an intersector, without any sample so far.
    pub(super) fn new(shot: &PreparedScene, backend: Backend) -> Self {
        let intersector = Intersector::for_backend(backend);
        let scene = shot.scene();
        Self {
            version: VERSION.to_owned(),
            commit: COMMIT.to_owned(),
            scene_identity: scene.content_hash(),
            job_identity: job_identity(shot.settings(), &intersector),
            intersector,
            settings: *shot.settings(),
            samples: SampleRange::first_n(0),
            counts: TileSampleCounts::default(),
            parts: MergedSamples::default(),
            biased: shot.render_settings().biases(),
            look: None,
            layers: None,
            files: relative_files(scene),
            scene: embedded_description(scene),
            run: None,
        }
    }

    /// With the samples that the picture holds, by which equal pictures have equal settings.
    pub(super) fn with_samples(
        self,
        samples: SampleRange,
        counts: TileSampleCounts,
        parts: MergedSamples,
    ) -> Self {
        let mut settings = self.settings;
        if !settings.render.sampler.depends_on_sample_count() {
            set_sample_count(&mut settings, samples.first + samples.most);
        }
        Self { settings, samples, counts, parts, ..self }
    }

    /// The indices of the samples: `0..64`, or `0..16, 32..64` where some are missing in between, and
    /// whether every pixel has them.
    pub fn samples_to_string(&self) -> String {
        if self.parts.is_empty() {
            return self.samples.to_string();
        }
        let ranges = self.parts.ranges_to_string();
        match self.parts.all_cover(&self.settings.image.pixel_bounds()) {
            true => ranges,
            false => format!("{ranges} (some pixels lack some)"),
        }
    }

    /// As records of a file.
    ///
    /// # Errors
    /// When a path cannot be written.
    pub fn to_records(&self) -> Result<Vec<MetadataEntry>> {
        let value = serde_json::to_value(self);
        let value = value.map_err(|e| Error::input(format!("cannot say how it was made: {e}")))?;
        let Value::Object(fields) = value else { return Ok(Vec::new()) };
        Ok(fields
            .into_iter()
            .map(|(name, value)| MetadataEntry::new(&name, record_text(value)))
            .collect())
    }

    /// From the records of a file.
    ///
    /// # Errors
    /// When one is missing or makes no sense; the message names the picture.
    pub fn from_records(picture: &Path, records: &[MetadataEntry]) -> Result<Self> {
        let shown = picture.display();
        if !records.iter().any(|record| record.name == "scene-identity") {
            let message = format!("`{shown}` does not say how it was made");
            let is_old = records.iter().any(|record| record.name == "identity");
            let help = match is_old {
                true => "it is of an older version of photosphere: use that version",
                false => "other programs may drop it on saving",
            };
            return Err(Error::input(message).with_help(help));
        }
        let fields: Map<String, Value> =
            records.iter().map(|record| (record.name.clone(), record_value(record))).collect();
        serde_json::from_value(Value::Object(fields)).map_err(|e| {
            let message =
                format!("`{shown}` says how it was made in a way that is not understood: {e}");
            Error::input(message).with_help("it may be of another version of photosphere")
        })
    }
}

/// The text of a record: a text as it is, unless it reads as JSON, and all else as JSON.
fn record_text(value: Value) -> String {
    match value {
        Value::String(text) if serde_json::from_str::<Value>(&text).is_err() => text,
        other => other.to_string(),
    }
}

/// What a record says: JSON, or else a text.
pub fn record_value(record: &MetadataEntry) -> Value {
    serde_json::from_str(&record.text).unwrap_or_else(|_| Value::String(record.text.clone()))
}

/// Asks for so many samples of each pixel, or the paper's sub-pixels for as many as that takes.
pub(super) fn set_sample_count(settings: &mut Settings, samples: u32) {
    let render = &mut settings.render;
    match &mut render.integrator {
        IntegratorSettings::Paper(paper) => {
            // Settings may still hold any number.
            let cells = paper.subpixels.saturating_pow(2).max(1);
            paper.samples = samples.div_ceil(cells).max(1);
            render.samples_per_pixel = paper.samples.saturating_mul(cells);
        }
        _ => render.samples_per_pixel = samples.max(1),
    }
}

/// What decides the worth of a sample beside the scene: not which samples of which pixels are taken.
pub(super) fn job_identity(settings: &Settings, intersector: &Intersector) -> ContentHash {
    let mut settings = *settings;
    settings.image.crop = None;
    let render = &settings.render;
    let is_centred = render.samples_per_pixel == 1;
    // Where the samples' number changes each of them.
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
    let canonical = CanonicalJob { encoding: 2, version: VERSION, intersector, settings };
    let bytes = serde_json::to_vec(&canonical);
    ContentHash::of_bytes(&bytes.expect("plain values with names as their keys are JSON"))
}

/// The scene with its files as it names them.
pub(super) fn embedded_description(scene: &Scene) -> Option<SceneDescription> {
    // Written-out spheres take a hundred bytes and more.
    if scene.description().spheres.len() > MAX_DESCRIPTION_BYTES / 64 {
        return None;
    }
    let mut description = scene.description().clone();
    let folder = scene.source().map_or(Path::new(""), |source| &source.folder);
    for_each_file(&mut description, |file| {
        if let Ok(relative) = file.strip_prefix(folder) {
            *file = relative.to_path_buf();
        }
    });
    let length = serde_json::to_vec(&description).ok()?.len();
    (length <= MAX_DESCRIPTION_BYTES).then_some(description)
}

/// Changes the path of every file of a scene.
pub(super) fn for_each_file(
    description: &mut SceneDescription,
    mut change: impl FnMut(&mut PathBuf),
) {
    for table in &mut description.tables {
        if let SphereData::File { path, .. } = &mut table.data {
            change(path);
        }
    }
    if let EnvironmentDescription::Image { file, .. } = &mut description.background.dome {
        change(file);
    }
}

fn relative_files(scene: &Scene) -> Vec<FileHash> {
    let folder = scene.source().map_or(Path::new(""), |source| &source.folder);
    let named = |FileHash { file, hash }: &FileHash| FileHash {
        file: file.strip_prefix(folder).unwrap_or(file).to_path_buf(),
        hash: *hash,
    };
    scene.files().iter().map(named).collect()
}

/// What is to be told of the Embree in use.
pub(super) fn embree_summary() -> Option<String> {
    let info = accel::embree_info()?.ok()?;
    Some(format!(
        "{}, compiled against {}, {}, {}",
        info.runtime_version, info.compiled_version, info.instruction_set, info.tasking
    ))
}
