//! A picture rendered again from what it says of itself.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use crate::accel::{Accel, Backend, BuildOptions, Cancel};
use crate::error::{Error, Result};
use crate::film::{Film, Format, Frame, Rect};
use crate::output::{self, Notes, RawChannel, Target};
use crate::provenance::{Counts, Made, Samples, Share};
use crate::render::{self, RenderOptions, Session};
use crate::scene::Scene;

use super::super::args::ReproduceArgs;
use super::super::progress::{Progress, State};
use super::super::{interrupt, outputs};
use super::Said;

/// A picture again.
pub(super) struct Again {
    pub(super) made: Made,
    pub(super) film: Film,
    pub(super) channels: Vec<RawChannel>,
}

impl Again {
    /// # Errors
    /// When the scene is not what it was, or cannot be rendered.
    pub(super) fn of(args: &ReproduceArgs, said: &Said) -> Result<Self> {
        let scene = said.made.scene(&folder(args, said), said.scene_file.as_deref())?;
        let backend = backend(args, said)?;
        let interrupt = interrupt::listen();
        let threads = rayon::current_num_threads();
        let build = BuildOptions { threads, cancel: interrupt.cancel(), ..Default::default() };
        let accel = backend.build(scene.spheres(), &build)?;
        let progress = Progress::new(args.quiet);
        let work = Work {
            scene: &scene,
            accel: accel.as_ref(),
            format: render::format_with(&scene, &said.kinds),
            cancel: interrupt.cancel(),
            progress: &progress,
            began: Instant::now(),
            total: samples_of(&said.made, &scene),
            done: AtomicU64::new(0),
        };
        let film = work.film(&said.made);
        progress.finish();
        let film = film?;
        let picture = render::picture(&scene, accel.as_ref(), &film, &said.kinds);
        let made = Made::new(&scene, backend, said.made.samples);
        let cropped_from = outputs::crop(film.frame());
        let notes = Notes { cropped_from, look: said.look, ..Notes::default() };
        let temporary = tempfile::tempdir().map_err(|e| Error::file("write", &args.picture, e))?;
        let name = if said.is_png(&args.picture) { "again.png" } else { "again.exr" };
        let file = temporary.path().join(name);
        Target::new(&file)?.write_with(&picture, &notes)?;
        Ok(Self { made, film, channels: output::raw_channels(&file)? })
    }
}

/// Where the scene's files are.
fn folder(args: &ReproduceArgs, said: &Said) -> PathBuf {
    let then = said.scene_file.as_deref().and_then(Path::parent);
    let beside = args.picture.parent().unwrap_or(Path::new(""));
    args.folder.clone().unwrap_or_else(|| then.unwrap_or(beside).to_path_buf())
}

/// The intersector that was asked for, or that the picture was made with.
fn backend(args: &ReproduceArgs, said: &Said) -> Result<Backend> {
    if let Some(backend) = args.accel {
        return Ok(backend);
    }
    let name = said.made.intersector.split(' ').next().unwrap_or_default();
    let backend: Backend = name.parse()?;
    if Backend::AVAILABLE.contains(&backend) {
        return Ok(backend);
    }
    Err(Error::backend(format!("the picture was made with `{name}`, which this build has not"))
        .with_help("take another and see by how much it differs: --accel native"))
}

/// About how many samples there are to render.
fn samples_of(made: &Made, scene: &Scene) -> u64 {
    if made.shares.is_empty() {
        let window = scene.description().image.window();
        return u64::from(window.width) * u64::from(window.height) * u64::from(made.samples.most);
    }
    let of_share = |Share { window, samples, .. }: &Share| {
        u64::from(window.width) * u64::from(window.height) * u64::from(samples.most)
    };
    made.shares.0.iter().map(of_share).sum()
}

/// Rendering the samples that a picture has.
struct Work<'a> {
    scene: &'a Scene,
    accel: &'a dyn Accel,
    /// Of the whole picture.
    format: Format,
    cancel: Cancel,
    progress: &'a Progress,
    began: Instant,
    total: u64,
    /// Samples of the shares that are done.
    done: AtomicU64,
}

impl Work<'_> {
    /// The film, with as many samples of each pixel as the picture has: where it was merged with gaps, each
    /// of its parts by itself, as they were.
    fn film(&self, made: &Made) -> Result<Film> {
        if made.shares.is_empty() {
            let first_sample = made.samples.first;
            let film = Film::new(&Format { first_sample, ..self.format.clone() })?;
            self.fill(&film, &made.samples, &made.counts)?;
            return Ok(film);
        }
        let first_sample = made.samples.first;
        let mut sum = Film::without_memory(&Format { first_sample, ..self.format.clone() });
        for Share { window, samples, counts } in &made.shares.0 {
            let window =
                Rect { x: window.x, y: window.y, width: window.width, height: window.height };
            let frame = Frame { window, ..self.format.frame };
            let format = Format { frame, first_sample: samples.first, ..self.format.clone() };
            let film = Film::new(&format)?;
            self.fill(&film, samples, counts)?;
            self.done.fetch_add(film.samples(), Ordering::Relaxed);
            sum.add_film(&film)?;
        }
        Ok(sum)
    }

    /// Where a noise target, a time or a signal ended the render, the numbers of samples differ from tile to
    /// tile, and `counts` says how many each has.
    fn fill(&self, film: &Film, samples: &Samples, counts: &Counts) -> Result<()> {
        let Samples { first, fewest, most } = *samples;
        let tiles = film.frame().tiles();
        let counts = match counts.0.as_slice() {
            [] if fewest == most => vec![most; tiles],
            counts if counts.len() == tiles => counts.to_vec(),
            _ => return Err(uncounted()),
        };
        let show = |state: render::Progress| {
            let done = self.done.load(Ordering::Relaxed) + state.samples_done;
            self.progress.show(&State::since(self.began, done, self.total));
        };
        let options = RenderOptions { cancel: self.cancel.clone(), progress: &show };
        let session = Session::new(self.scene, self.accel, film, &options);
        let mut steps = counts.clone();
        steps.sort_unstable();
        steps.dedup();
        for step in steps {
            session.advance(first + step, &|tile| counts[tile] >= step)?;
            session.cancel().check()?;
        }
        Ok(())
    }
}

fn uncounted() -> Error {
    let what = "it cannot be rendered again: pixels of one tile have different numbers of samples, and the \
                picture does not say which";
    Error::input(what).with_help(
        "that is so where parts whose windows cut tiles were gone on with after a merge, and in pictures \
         of older versions of photosphere",
    )
}
