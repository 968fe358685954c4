//! A picture rendered again from what it says of itself.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use crate::accel::{Accel, Backend, BuildOptions};
use crate::error::{Error, Result, Suggestion};
use crate::film::{Aov, Film, FilmFormat, FilmFrame, Layer};
use crate::image_io;
use crate::image_io::Picture;
use crate::scene::{PreparedScene, Scene};
use crate::task::CancelToken;

use super::aovs::develop;
use super::film_format::format_for_scene;
use super::metadata::{Metadata, for_each_file};
use super::progressive::{Counters, ProgressiveRenderer};
use super::samples::{SampleRange, TileSampleCounts, WindowSamples};

/// How to render a picture again.
#[derive(Clone, Debug, Default)]
pub struct ReproduceOptions {
    /// Where the scene's tables and images are.
    pub folder: PathBuf,
    /// The intersector; the one that the picture was made with where `None`.
    pub backend: Option<Backend>,
    /// Set from elsewhere to stop.
    pub cancel: CancelToken,
}

/// A picture that was rendered again.
#[derive(Debug)]
pub struct Reproduction {
    /// The picture.
    pub picture: Picture,
    /// Its sums.
    pub film: Film,
    /// How it was made now.
    pub metadata: Metadata,
}

/// What a picture's file says of it.
///
/// # Errors
/// When it cannot be read, or does not say how it was made.
pub fn read_metadata(path: &Path) -> Result<Metadata> {
    let mut metadata = Metadata::from_records(path, &image_io::read_metadata(path)?)?;
    if metadata.layers.is_none() {
        // An alpha channel may be asked for by the scene or by the job.
        let has_alpha =
            image_io::read_raw_channels(path)?.iter().any(|channel| channel.name == "A");
        metadata.layers = has_alpha.then(|| vec![Aov::Mean(Layer::Alpha)]);
    }
    Ok(metadata)
}

/// Renders a picture again, on the current thread pool; `progress` is told the samples that are done and
/// those that there will be, from any thread.
///
/// # Errors
/// When the scene is not what it was, or cannot be rendered.
pub fn reproduce(
    recorded: &Metadata,
    options: &ReproduceOptions,
    progress: &(dyn Fn(u64, u64) + Sync),
) -> Result<Reproduction> {
    let scene = rebuild_scene(recorded, options)?;
    let shot = PreparedScene::new(&scene, recorded.settings)?;
    let backend = choose_backend(recorded, options)?;
    let threads = rayon::current_num_threads();
    let build = BuildOptions { threads, cancel: options.cancel.clone(), ..Default::default() };
    let accel = backend.build(scene.spheres(), &build)?;
    let layers = recorded.layers.clone().unwrap_or_default();
    let work = Reproducer {
        shot: &shot,
        accel: accel.as_ref(),
        format: format_for_scene(&shot, &layers),
        cancel: &options.cancel,
        progress,
        samples_total: total_samples(recorded),
        samples_done: AtomicU64::new(0),
    };
    let film = work.film(recorded)?;
    let picture = develop(&shot, accel.as_ref(), &film, &layers);
    Ok(Reproduction { picture, film, metadata: Metadata::new(&shot, backend) })
}

/// The scene of a picture, with its files in the folder.
fn rebuild_scene(then: &Metadata, again: &ReproduceOptions) -> Result<Scene> {
    let Some(named) = then.scene.clone() else {
        return Err(Error::input("the scene was too long for the picture")
            .with_help("render the scene file again, and compare the two pictures"));
    };
    let mut description = named.clone();
    for_each_file(&mut description, |file| *file = again.folder.join(&*file));
    let scene = Scene::build(description)?;
    if scene.content_hash() == then.scene_identity {
        // It records its files as the picture does, not by where they were found.
        return Ok(scene.with_description(named));
    }
    let is_changed = |said: &&crate::scene::FileHash| {
        let file = again.folder.join(&said.file);
        let found = scene.files().iter().find(|found| found.file == file);
        found.is_some_and(|found| found.hash != said.hash)
    };
    let changed: Vec<String> = then
        .files
        .iter()
        .filter(is_changed)
        .map(|said| format!("`{}`", again.folder.join(&said.file).display()))
        .collect();
    if changed.is_empty() {
        let (then, now) = (&then.version, super::VERSION);
        let message = format!(
            "the scene of the picture is not what it was: it was made by version {then}, and this is {now}"
        );
        return Err(Error::input(message));
    }
    let verb = if changed.len() == 1 { "is" } else { "are" };
    let message = format!("{} {verb} not what the picture was made of", changed.join(", "));
    Err(Error::input(message)
        .with_help("name the folder where the files are as they were")
        .with_suggestion(Suggestion::Folder, ""))
}

fn choose_backend(then: &Metadata, again: &ReproduceOptions) -> Result<Backend> {
    if let Some(backend) = again.backend {
        return Ok(backend);
    }
    let backend = then.intersector.backend;
    if Backend::AVAILABLE.contains(&backend) {
        return Ok(backend);
    }
    Err(Error::backend(format!(
        "the picture was made with `{}`, which this build has not",
        backend.name()
    ))
    .with_help("take another intersector and see by how much it differs")
    .with_suggestion(Suggestion::Intersector, "native"))
}

/// About how many samples there are to render.
fn total_samples(then: &Metadata) -> u64 {
    let of = |window: crate::math::Rect, most: u32| window.pixel_count() as u64 * u64::from(most);
    if then.parts.is_empty() {
        return of(then.settings.image.pixel_bounds(), then.samples.most);
    }
    then.parts.0.iter().map(|share| of(share.window, share.samples.most)).sum()
}

/// Rendering the samples that a picture has.
struct Reproducer<'a> {
    shot: &'a PreparedScene,
    accel: &'a dyn Accel,
    /// Of the whole picture.
    format: FilmFormat,
    cancel: &'a CancelToken,
    progress: &'a (dyn Fn(u64, u64) + Sync),
    samples_total: u64,
    /// Samples of the parts that are done.
    samples_done: AtomicU64,
}

impl Reproducer<'_> {
    /// The film, with as many samples of each pixel as the picture has: where it was merged with gaps, each
    /// of its parts by itself, as they were.
    fn film(&self, then: &Metadata) -> Result<Film> {
        let first_sample = then.samples.first;
        if then.parts.is_empty() {
            let film = Film::new(&FilmFormat { first_sample, ..self.format.clone() })?;
            self.fill(&film, &then.samples, &then.counts)?;
            return Ok(film);
        }
        let mut sum = Film::new_lazy(&FilmFormat { first_sample, ..self.format.clone() });
        for &WindowSamples { window, samples, ref counts } in &then.parts.0 {
            let frame = FilmFrame { window, ..self.format.frame };
            let format = FilmFormat { frame, first_sample: samples.first, ..self.format.clone() };
            let film = Film::new(&format)?;
            self.fill(&film, &samples, counts)?;
            self.samples_done.fetch_add(film.sample_count(), Ordering::Relaxed);
            sum.merge(&film)?;
        }
        Ok(sum)
    }

    /// Where a noise target, a time or a signal ended the render, the numbers of samples differ from tile to
    /// tile, and `counts` says how many each has.
    fn fill(&self, film: &Film, samples: &SampleRange, counts: &TileSampleCounts) -> Result<()> {
        let SampleRange { first, fewest, most } = *samples;
        let tiles = film.frame().tile_count();
        let counts = match counts.0.as_slice() {
            [] if fewest == most => vec![most; tiles],
            counts if counts.len() == tiles => counts.to_vec(),
            _ => return Err(missing_counts()),
        };
        let counters = Counters::new(film, self.samples_total);
        let passes = ProgressiveRenderer::new(self.shot, self.accel, film, &counters, self.cancel);
        let mut steps = counts.clone();
        steps.sort_unstable();
        steps.dedup();
        for step in steps {
            // A block at a time, to tell how far it is.
            let mut end = first;
            while end < first + step {
                end = (end / crate::film::BLOCK_SIZE + 1)
                    .saturating_mul(crate::film::BLOCK_SIZE)
                    .min(first + step);
                passes.render_to_sample(end, &|tile| counts[tile] >= step)?;
                self.cancel.check()?;
                let done = self.samples_done.load(Ordering::Relaxed) + counters.samples_done();
                (self.progress)(done, self.samples_total);
            }
        }
        Ok(())
    }
}

fn missing_counts() -> Error {
    let what = "it cannot be rendered again: pixels of one tile have different numbers of samples, and the \
                picture does not say which";
    Error::input(what).with_help(
        "that is so where parts whose windows cut tiles were resumed after a merge, and in pictures of \
         older versions of photosphere",
    )
}
