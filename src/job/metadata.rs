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
use crate::color::Look;
use crate::error::{Error, Result};
use crate::film::Kind;
use crate::image_io::Record;
use crate::scene::data::SphereData;
use crate::scene::description::Dome;
use crate::scene::settings::Integrator;
use crate::scene::{Description, FileHash, Identity, Scene, Settings, Shot};

use super::noise::NoiseTarget;
use super::samples::{Samples, Shares, TileCounts};

/// The version of this program.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// The commit that this program was built from, and whether it was changed; `unknown` where the build
/// found no repository.
pub const COMMIT: &str = env!("PHOTOSPHERE_COMMIT");

/// The longest description of a scene, in bytes, that goes along with a picture.
const LONGEST: usize = 1 << 20;

/// All that the file of a picture says of it beside the pixels.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub struct Metadata {
    /// The program's version.
    pub version: String,
    /// The commit that it was built from.
    pub commit: String,
    /// What the scene is: [`Scene::identity`].
    pub scene_identity: Identity,
    /// What was computed of it, and what with: samples of equal identities may be added up.
    pub job_identity: Identity,
    /// What found the hits.
    pub intersector: Intersector,
    /// The settings, with as many samples per pixel as the picture has.
    pub settings: Settings,
    /// Which samples of each pixel.
    pub samples: Samples,
    /// How many of them in each tile, where that differs.
    #[serde(default, skip_serializing_if = "TileCounts::is_empty")]
    pub counts: TileCounts,
    /// The samples of each of its parts, where those two do not tell it.
    #[serde(default, skip_serializing_if = "Shares::is_empty")]
    pub parts: Shares,
    /// The options that bias the picture.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub biased: Vec<String>,
    /// How a file for the screen shows light, where that is not the usual way.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub look: Option<Look>,
    /// The layers, in a file that has a place for them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub layers: Option<Vec<Kind>>,
    /// The files of the scene, as it names them, with the hashes of their numbers.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub files: Vec<FileHash>,
    /// The scene; `None` where it is too long to go along.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scene: Option<Description>,
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
struct Canonical<'a> {
    encoding: u32,
    version: &'static str,
    intersector: &'a Intersector,
    settings: Settings,
}

impl Metadata {
    /// Of a picture of a shot by an intersector, without any sample so far.
    pub(super) fn of(shot: &Shot, backend: Backend) -> Self {
        let intersector = Intersector::of(backend);
        let scene = shot.scene();
        Self {
            version: VERSION.to_owned(),
            commit: COMMIT.to_owned(),
            scene_identity: scene.identity(),
            job_identity: job_identity(shot.settings(), &intersector),
            intersector,
            settings: *shot.settings(),
            samples: Samples::all(0),
            counts: TileCounts::default(),
            parts: Shares::default(),
            biased: shot.render().biases(),
            look: None,
            layers: None,
            files: files_of(scene),
            scene: description_of(scene),
            run: None,
        }
    }

    /// With the samples that the picture holds, by which equal pictures have equal settings.
    pub(super) fn with_samples(self, samples: Samples, counts: TileCounts, parts: Shares) -> Self {
        let mut settings = self.settings;
        if !settings.render.sampler.depends_on_count() {
            set_samples(&mut settings, samples.first + samples.most);
        }
        Self { settings, samples, counts, parts, ..self }
    }

    /// The indices of the samples: `0..64`, or `0..16, 32..64` where some are missing in between, and
    /// whether every pixel has them.
    pub fn samples_as_text(&self) -> String {
        if self.parts.is_empty() {
            return self.samples.to_string();
        }
        let ranges = self.parts.ranges();
        match self.parts.are_all_of(&self.settings.image.window()) {
            true => ranges,
            false => format!("{ranges} (some pixels lack some)"),
        }
    }

    /// As records of a file.
    ///
    /// # Errors
    /// When a path cannot be written.
    pub fn to_records(&self) -> Result<Vec<Record>> {
        let value = serde_json::to_value(self);
        let value = value.map_err(|e| Error::input(format!("cannot say how it was made: {e}")))?;
        let Value::Object(fields) = value else { return Ok(Vec::new()) };
        Ok(fields.into_iter().map(|(name, value)| Record::new(&name, text_of(value))).collect())
    }

    /// From the records of a file.
    ///
    /// # Errors
    /// When one is missing or makes no sense; the message names the picture.
    pub fn of_records(picture: &Path, records: &[Record]) -> Result<Self> {
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
            records.iter().map(|record| (record.name.clone(), value_of(record))).collect();
        serde_json::from_value(Value::Object(fields)).map_err(|e| {
            let message =
                format!("`{shown}` says how it was made in a way that is not understood: {e}");
            Error::input(message).with_help("it may be of another version of photosphere")
        })
    }
}

/// The text of a record: a text as it is, unless it reads as JSON, and all else as JSON.
fn text_of(value: Value) -> String {
    match value {
        Value::String(text) if serde_json::from_str::<Value>(&text).is_err() => text,
        other => other.to_string(),
    }
}

/// What a record says: JSON, or else a text.
pub fn value_of(record: &Record) -> Value {
    serde_json::from_str(&record.text).unwrap_or_else(|_| Value::String(record.text.clone()))
}

/// Asks for so many samples of each pixel, or the paper's sub-pixels for as many as that takes.
pub(super) fn set_samples(settings: &mut Settings, samples: u32) {
    let render = &mut settings.render;
    match &mut render.integrator {
        Integrator::Paper(paper) => {
            // Settings may still hold any number.
            let cells = paper.subpixels.saturating_pow(2).max(1);
            paper.samples = samples.div_ceil(cells).max(1);
            render.samples_per_pixel = paper.samples.saturating_mul(cells);
        }
        _ => render.samples_per_pixel = samples.max(1),
    }
}

/// What decides the worth of a sample beside the scene: not which samples of which pixels are taken.
pub(super) fn job_identity(settings: &Settings, intersector: &Intersector) -> Identity {
    let mut settings = *settings;
    settings.image.crop = None;
    let render = &settings.render;
    let is_centred = render.samples_per_pixel == 1;
    // Where the samples' number changes each of them.
    let samples = match (render.sampler.depends_on_count(), render.integrator) {
        (true, _) => render.samples_per_pixel,
        (_, Integrator::Normals | Integrator::Raycast { .. }) => {
            if is_centred {
                1
            } else {
                2
            }
        }
        _ => 1,
    };
    set_samples(&mut settings, samples);
    let canonical = Canonical { encoding: 2, version: VERSION, intersector, settings };
    let bytes = serde_json::to_vec(&canonical);
    Identity::of_bytes(&bytes.expect("plain values with names as their keys are JSON"))
}

/// The scene with its files as it names them.
pub(super) fn description_of(scene: &Scene) -> Option<Description> {
    // Written-out spheres take a hundred bytes and more.
    if scene.description().spheres.len() > LONGEST / 64 {
        return None;
    }
    let mut description = scene.description().clone();
    let folder = scene.source().map_or(Path::new(""), |source| &source.folder);
    each_file(&mut description, |file| {
        if let Ok(relative) = file.strip_prefix(folder) {
            *file = relative.to_path_buf();
        }
    });
    let length = serde_json::to_vec(&description).ok()?.len();
    (length <= LONGEST).then_some(description)
}

/// Changes the path of every file of a scene.
pub(super) fn each_file(description: &mut Description, mut change: impl FnMut(&mut PathBuf)) {
    for table in &mut description.tables {
        if let SphereData::File { path, .. } = &mut table.data {
            change(path);
        }
    }
    if let Dome::Image { file, .. } = &mut description.background.dome {
        change(file);
    }
}

fn files_of(scene: &Scene) -> Vec<FileHash> {
    let folder = scene.source().map_or(Path::new(""), |source| &source.folder);
    let named = |FileHash { file, hash }: &FileHash| FileHash {
        file: file.strip_prefix(folder).unwrap_or(file).to_path_buf(),
        hash: *hash,
    };
    scene.files().iter().map(named).collect()
}

/// What is to be told of the Embree in use.
pub(super) fn embree_as_text() -> Option<String> {
    let info = accel::embree_info()?.ok()?;
    Some(format!(
        "{}, compiled against {}, {}, {}",
        info.runtime_version, info.compiled_version, info.instruction_set, info.tasking
    ))
}
