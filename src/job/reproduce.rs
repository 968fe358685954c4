//! Reproduces a picture from its metadata.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use crate::accel::{Accel, Backend, BuildOptions};
use crate::error::{Error, Result, Suggestion};
use crate::film::{Aov, Film, FilmFormat, FilmFrame, Layer};
use crate::image_io;
use crate::image_io::Picture;
use crate::scene::{ColumnLayers, PreparedScene, Scene};
use crate::task::CancelToken;

use super::aovs::develop;
use super::film_format::format_for_scene;
use super::metadata::Metadata;
use super::progressive::{Counters, ProgressiveRenderer};
pub use super::recorded::ReproductionCost;
use super::samples::{SampleRange, TileSampleCounts, WindowSamples};

/// Options for [`reproduce`].
#[derive(Clone, Debug, Default)]
pub struct ReproduceOptions {
    /// Folder of the scene's tables and images.
    pub folder: PathBuf,
    /// The intersector; `None` selects the one that made the picture.
    pub backend: Option<Backend>,
    /// Cancels the render.
    pub cancel: CancelToken,
}

/// A reproduced picture.
#[derive(Debug)]
pub struct Reproduction {
    /// The picture.
    pub picture: Picture,
    /// The film that the picture was developed from.
    pub film: Film,
    /// Metadata of the new render.
    pub metadata: Metadata,
}

/// Reads the metadata of a picture file.
///
/// # Errors
/// If the file cannot be read or has no metadata.
pub fn read_metadata(path: &Path) -> Result<Metadata> {
    let mut metadata = Metadata::from_records(path, &image_io::read_metadata(path)?)?;
    if metadata.layers.is_none() {
        // The alpha channel may come from the scene or from the job.
        let has_alpha =
            image_io::read_raw_channels(path)?.iter().any(|channel| channel.name == "A");
        metadata.layers = has_alpha.then(|| vec![Aov::Mean(Layer::Alpha)]);
    }
    Ok(metadata)
}

/// Renders a picture again on the current thread pool. `progress` receives the samples done and the
/// total, from any thread.
///
/// # Errors
/// If the record is impossible, or if the scene has changed or cannot be rendered.
pub fn reproduce(
    recorded: &Metadata,
    options: &ReproduceOptions,
    progress: &(dyn Fn(u64, u64) + Sync),
) -> Result<Reproduction> {
    let cost = ReproductionCost::of(recorded)?;
    let scene = rebuild_scene(recorded, options)?;
    let prepared = PreparedScene::new(&scene, recorded.settings)?;
    let backend = choose_backend(recorded, options)?;
    let threads = rayon::current_num_threads();
    let build = BuildOptions { threads, cancel: options.cancel.clone(), ..Default::default() };
    let accel = backend.build(scene.spheres(), &build)?;
    let layers = recorded.layers.clone().unwrap_or_default();
    let reproducer = Reproducer {
        prepared: &prepared,
        accel: accel.as_ref(),
        format: format_for_scene(&prepared, &layers),
        cancel: &options.cancel,
        progress,
        samples_total: cost.samples,
        samples_done: AtomicU64::new(0),
    };
    let film = reproducer.film(recorded)?;
    let mut picture = develop(&prepared, accel.as_ref(), &film, &layers);
    if let (names @ [_, ..], Some(recorded)) = (&recorded.column_layers[..], &recorded.scene) {
        ColumnLayers::of_description(recorded, &options.folder, names)?
            .add_to(&mut picture, &scene);
    }
    Ok(Reproduction { picture, film, metadata: Metadata::new(&prepared, backend) })
}

/// Rebuilds the scene of a picture with its files in the given folder.
pub(super) fn rebuild_scene(recorded: &Metadata, options: &ReproduceOptions) -> Result<Scene> {
    let Some(recorded_scene) = recorded.scene.clone() else {
        return Err(Error::input("the scene was too large to be stored in the picture")
            .with_help("render the scene file again, and compare the two pictures"));
    };
    let mut description = recorded_scene.clone();
    let mut missing = None;
    description.for_each_file(|file| {
        *file = options.folder.join(&*file);
        missing = missing.take().or_else(|| (!file.exists()).then(|| file.clone()));
    });
    if let Some(file) = missing {
        return Err(Error::file("read", &file, "the picture was made of it, and it is not there")
            .with_help("name the folder that has the files of the scene")
            .with_suggestion(Suggestion::Folder, "DIR"));
    }
    let scene = Scene::build(description)?;
    if scene.content_hash() == recorded.scene_identity {
        // Record the file names as the picture gives them, not where they were found.
        return Ok(scene.with_description(recorded_scene));
    }
    let is_changed = |file_hash: &&crate::scene::FileHash| {
        let file = options.folder.join(&file_hash.file);
        let found = scene.files().iter().find(|found| found.file == file);
        found.is_some_and(|found| found.hash != file_hash.hash)
    };
    let changed: Vec<String> = recorded
        .files
        .iter()
        .filter(is_changed)
        .map(|file_hash| format!("`{}`", options.folder.join(&file_hash.file).display()))
        .collect();
    if changed.is_empty() {
        let (version, own_version) = (&recorded.version, super::VERSION);
        let message = format!(
            "this version reads the scene of the picture differently: version {version} made it, and this is {own_version}"
        );
        return Err(Error::input(message));
    }
    let verb = if changed.len() == 1 { "is" } else { "are" };
    let message = format!("{} {verb} not what the picture was made of", changed.join(", "));
    Err(Error::input(message)
        .with_help("name the folder that has the original files")
        .with_suggestion(Suggestion::Folder, "DIR"))
}

fn choose_backend(recorded: &Metadata, options: &ReproduceOptions) -> Result<Backend> {
    if let Some(backend) = options.backend {
        return Ok(backend);
    }
    let backend = recorded.intersector;
    if Backend::AVAILABLE.contains(&backend) {
        return Ok(backend);
    }
    Err(Error::backend(format!(
        "the picture was made with `{}`, which this build does not include",
        backend.name()
    ))
    .with_help("use another intersector and compare the pictures")
    .with_suggestion(Suggestion::Intersector, "native"))
}

/// Renders the samples that a picture has.
struct Reproducer<'a> {
    prepared: &'a PreparedScene,
    accel: &'a dyn Accel,
    /// Film format of the whole picture.
    format: FilmFormat,
    cancel: &'a CancelToken,
    progress: &'a (dyn Fn(u64, u64) + Sync),
    samples_total: u64,
    /// Samples in completed parts.
    samples_done: AtomicU64,
}

impl Reproducer<'_> {
    /// Renders a film with the same samples per pixel as the picture. For a picture merged with
    /// gaps, each part is rendered separately.
    fn film(&self, recorded: &Metadata) -> Result<Film> {
        let first_sample = recorded.samples.first;
        if recorded.parts.is_empty() {
            let film = Film::new(&FilmFormat { first_sample, ..self.format.clone() })?;
            self.fill(&film, &recorded.samples, &recorded.counts)?;
            return Ok(film);
        }
        let mut sum = Film::new_lazy(&FilmFormat { first_sample, ..self.format.clone() });
        for &WindowSamples { window, samples, ref counts } in &recorded.parts.0 {
            let frame = FilmFrame { window, ..self.format.frame };
            let format = FilmFormat { frame, first_sample: samples.first, ..self.format.clone() };
            let film = Film::new(&format)?;
            self.fill(&film, &samples, counts)?;
            self.samples_done.fetch_add(film.sample_count(), Ordering::Relaxed);
            sum.merge(&film)?;
        }
        Ok(sum)
    }

    /// Fills a film. If a noise target, a time limit or a signal ended the render, tiles have
    /// different numbers of samples, and `counts` holds the number for each tile.
    fn fill(&self, film: &Film, samples: &SampleRange, counts: &TileSampleCounts) -> Result<()> {
        let SampleRange { first, min_count, max_count } = *samples;
        let tiles = film.frame().tile_count();
        let counts = match counts.0.as_slice() {
            [] if min_count == max_count => vec![max_count; tiles],
            counts if counts.len() == tiles => counts.to_vec(),
            _ => return Err(missing_counts()),
        };
        let counters = Counters::new(film, self.samples_total);
        let renderer =
            ProgressiveRenderer::new(self.prepared, self.accel, film, &counters, self.cancel);
        let mut steps = counts.clone();
        steps.sort_unstable();
        steps.dedup();
        for step in steps {
            // One block at a time, to report progress.
            let mut end = first;
            while end < first + step {
                end = (end / crate::film::BLOCK_SIZE + 1)
                    .saturating_mul(crate::film::BLOCK_SIZE)
                    .min(first + step);
                renderer.render_to_sample(end, &|tile| counts[tile] >= step)?;
                self.cancel.check()?;
                let done = self.samples_done.load(Ordering::Relaxed) + counters.samples_done();
                (self.progress)(done, self.samples_total);
            }
        }
        Ok(())
    }
}

fn missing_counts() -> Error {
    let message = "it cannot be reproduced: pixels of one tile have different numbers of samples, and the \
                picture does not record them";
    Error::input(message).with_help(
        "this happens if parts whose windows cut tiles were resumed after a merge, and in pictures of \
         older versions of photosphere",
    )
}
