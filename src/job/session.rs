//! A render that owns all it needs. It can be run, looked at while it runs, stopped, extended, saved and
//! resumed, from any thread.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use rayon::ThreadPool;

use crate::accel::{Accel, Backend, BuildOptions};
use crate::error::{Error, Result, Setting};
use crate::film::{Film, Format, Frame, Layer, Scale, summed_for};
use crate::image_io::Picture;
use crate::image_io::WholeFile;
use crate::integrator::Tally;
use crate::math::Rect;
use crate::scene::{Scene, Settings, Shot};
use crate::task::Cancel;

use super::adaptive::{Standing, error_so_far, render_to};
use super::aovs::picture;
use super::checkpoint::{Checkpoint, Delivery, Header, Statistics, Status, write_checkpoint};
use super::metadata::{Metadata, RunRecord, embree_as_text};
use super::monitor::{self, Autosave};
use super::observer::{Observer, Progress};
use super::outcome::{End, NoiseStatus, Outcome, warnings};
use super::passes::{Counters, Passes};
use super::samples::{Samples, Shares, TileCounts};
use super::spec::Job;
use super::start;

/// A render that owns all it needs.
pub struct Session {
    work: Arc<Work>,
    pool: ThreadPool,
    autosave: Option<Autosave>,
    /// Seconds that the intersector's build took.
    build_seconds: f64,
}

/// What the threads that render share with those that look on.
pub(super) struct Work {
    pub(super) shot: Shot,
    pub(super) accel: Box<dyn Accel>,
    pub(super) film: Film,
    pub(super) job: Job,
    /// The samples that every pixel is to have.
    pub(super) samples: Range<u32>,
    pub(super) cancel: Cancel,
    pub(super) counters: Counters,
    standing: Mutex<Option<Standing>>,
    pub(super) is_time_up: AtomicBool,
    /// Set where threads still render though they were asked to stop.
    pub(super) is_left_behind: AtomicBool,
    /// What earlier runs took.
    before: Statistics,
    pub(super) samples_before: u64,
    timing: Mutex<Timing>,
    threads: usize,
    metadata: Metadata,
    accel_words: String,
    delivery: Option<Delivery>,
    /// What the command line adds to the records of a run.
    command: Option<String>,
}

/// When the render ran.
#[derive(Default)]
struct Timing {
    /// Of runs of this session that are over.
    spent: Duration,
    running_since: Option<Instant>,
}

/// What a render came to, before it is saved or shown.
#[derive(Clone, Debug)]
pub struct Reached {
    /// How it ended.
    pub end: End,
    /// How far the noise target is met, where there is one.
    pub noise: Option<NoiseStatus>,
    /// The error that a share of the values stay below.
    pub error: Option<f64>,
}

/// What a session is opened with, beside scene and job.
#[derive(Clone, Debug, Default)]
pub struct Opening {
    /// Set from elsewhere to stop the build and the render.
    pub cancel: Cancel,
    /// Told how far the build is.
    pub build_progress: crate::task::Progress,
    /// Where the picture goes, for checkpoints to tell.
    pub delivery: Option<Delivery>,
    /// The command, quoted for a shell, for files to tell.
    pub command: Option<String>,
}

impl Session {
    /// Opens a render without any sample, and builds the intersector.
    ///
    /// # Errors
    /// When the job makes no sense, there is no memory for the film, or the intersector cannot be built.
    pub fn new(scene: &Scene, job: Job, opening: Opening) -> Result<Self> {
        Self::open(scene, job, None, opening)
    }

    /// Opens a render where a checkpoint ends. The job may ask for more samples, or for less noise.
    ///
    /// # Errors
    /// When the checkpoint is of another scene or another job, with what differs; and as [`Self::new`].
    pub fn resume(
        scene: &Scene,
        job: Job,
        checkpoint: Checkpoint,
        opening: Opening,
    ) -> Result<Self> {
        Self::open(scene, job, Some(checkpoint), opening)
    }

    fn open(
        scene: &Scene,
        job: Job,
        checkpoint: Option<Checkpoint>,
        opening: Opening,
    ) -> Result<Self> {
        job.check()?;
        let Opening { cancel, build_progress, delivery, command } = opening;
        let pool = pool_of(job.threads)?;
        let shot = pool.install(|| Shot::new(scene, job.settings))?;
        let samples = job.sample_range()?;
        let chosen = job.accel.choose(scene.spheres());
        let metadata = Metadata::of(&shot, chosen.backend);
        let format = Format { first_sample: samples.start, ..format_of(&shot, &job.layers) };
        let (film, before) = match checkpoint {
            None => (Film::new(&format)?, Statistics::default()),
            Some(checkpoint) => start::of(checkpoint, &metadata, &format, &samples, &job)?,
        };
        let build = BuildOptions {
            threads: pool.current_num_threads(),
            quality: job.quality,
            progress: build_progress,
            cancel: cancel.clone(),
            ..Default::default()
        };
        let began = Instant::now();
        let accel = pool.install(|| chosen.backend.build(scene.spheres(), &build))?;
        let build_seconds = began.elapsed().as_secs_f64();
        let accel_words = words_of_accel(chosen.backend, &chosen.reason, &*accel);
        let total = film.frame().pixels() as u64 * samples.len() as u64;
        let work = Work {
            counters: Counters::of(&film, total),
            samples_before: film.samples(),
            shot,
            accel,
            film,
            job,
            samples,
            cancel,
            standing: Mutex::default(),
            is_time_up: AtomicBool::new(false),
            is_left_behind: AtomicBool::new(false),
            threads: pool.current_num_threads(),
            before,
            timing: Mutex::default(),
            metadata,
            accel_words,
            delivery,
            command,
        };
        Ok(Self { work: Arc::new(work), pool, autosave: None, build_seconds })
    }

    /// Saves the samples so far to this file, again and again while it runs, by a thread of its own.
    pub fn autosave(&mut self, file: WholeFile, every: Duration) {
        self.autosave = Some(Autosave { file, every });
    }

    /// Renders until the job is done, stopped or cancelled; `observer` is told on this thread.
    ///
    /// A request to stop is followed soon: where the threads that render are stuck in a long batch, they
    /// are left behind, and their unfinished samples are not used.
    ///
    /// # Errors
    /// When a pixel is too bright for the film.
    pub fn run(&self, observer: &dyn Observer) -> Result<Reached> {
        self.work.begin();
        let reached = monitor::run(&self.work, &self.pool, self.autosave.as_ref(), observer);
        self.work.pause();
        reached
    }

    /// Asks the render to stop; it then has some whole number of blocks of samples in every pixel.
    pub fn stop(&self) {
        self.work.cancel.cancel();
    }

    /// The request to stop, to be set from elsewhere.
    pub fn cancel(&self) -> Cancel {
        self.work.cancel.clone()
    }

    /// Whether the time of the job is up.
    pub fn is_time_up(&self) -> bool {
        self.work.is_time_up.load(Ordering::Relaxed)
    }

    /// The render.
    pub fn job(&self) -> &Job {
        &self.work.job
    }

    /// The scene as the job has it.
    pub fn shot(&self) -> &Shot {
        &self.work.shot
    }

    /// The samples that every pixel is to have in the end.
    pub fn samples(&self) -> Range<u32> {
        self.work.samples.clone()
    }

    /// The sums so far, which may grow while they are looked at.
    pub fn film(&self) -> &Film {
        &self.work.film
    }

    /// The intersector.
    pub fn accel(&self) -> &dyn Accel {
        &*self.work.accel
    }

    /// The intersector, why it, and how it was built, in words.
    pub fn accel_as_text(&self) -> &str {
        &self.work.accel_words
    }

    /// Seconds that the intersector's build took.
    pub fn build_seconds(&self) -> f64 {
        self.build_seconds
    }

    /// Threads that render.
    pub fn threads(&self) -> usize {
        self.pool.current_num_threads()
    }

    /// How far it is, without an estimate of the error.
    pub fn progress(&self) -> Progress {
        self.work.progress(None)
    }

    /// The error that a share of the values stay below, estimated from some pixels in a few
    /// milliseconds; `None` before anything is known.
    pub fn error(&self) -> Option<f64> {
        self.work.error()
    }

    /// The picture of the samples so far with all of its layers: every pixel at a whole number of calls
    /// of the integrator.
    pub fn picture(&self) -> Picture {
        let Work { shot, accel, film, job, .. } = &*self.work;
        picture(shot, &**accel, film, &job.layers)
    }

    /// The beauty so far, quickly, for those who only look on.
    pub fn preview(&self) -> Picture {
        let mut picture = self.work.film.picture();
        let transparent = self.work.shot.scene().description().background.transparent;
        picture.alpha = picture.alpha.filter(|_| self.work.job.has_alpha(transparent));
        picture
    }

    /// How the picture so far was made.
    pub fn metadata(&self) -> Metadata {
        self.work.metadata()
    }

    /// Samples and rays of this session alone, and what the user should know about the picture.
    pub fn statistics(&self) -> (u64, u64, Vec<String>) {
        let work = &*self.work;
        let samples = work.counters.samples_done() - work.samples_before;
        let warnings = warnings(&work.shot, &work.tally(), &work.film);
        (samples, work.counters.tally().rays, warnings)
    }

    /// Writes the sums; `reached` is what they came to, where the render does not go on.
    ///
    /// # Errors
    /// When the disk refuses; a file that was there before is then unchanged.
    pub fn write_checkpoint(&self, file: &WholeFile, reached: Option<&Reached>) -> Result<()> {
        self.work.write_checkpoint(file, reached)
    }

    /// All that there is to know of what the render came to.
    pub fn outcome(&self, reached: Reached) -> Outcome {
        let Reached { end, noise, error } = reached;
        let (_, _, mut warnings) = self.statistics();
        warnings.extend(noise.filter(|noise| !noise.is_met()).map(|noise| noise.to_string()));
        Outcome {
            picture: self.on_free_threads(|| self.picture()),
            metadata: Metadata { layers: Some(self.work.job.layers.clone()), ..self.metadata() },
            end,
            noise,
            error,
            samples: self.work.film.samples(),
            rays: self.work.tally().rays,
            seconds: self.work.seconds(),
            warnings,
        }
    }

    /// Does something with the help of all threads, also where those that render are stuck.
    pub fn on_free_threads<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        if !self.work.is_left_behind.load(Ordering::Relaxed) {
            return self.pool.install(work);
        }
        match pool_of(self.work.job.threads) {
            Ok(pool) => pool.install(work),
            // Without threads to be had, this one does it alone.
            Err(_) => work(),
        }
    }
}

impl Work {
    /// Renders until the job is done or cancelled. Returns whether it is done.
    pub(super) fn reach(&self) -> Result<bool> {
        let passes =
            Passes::new(&self.shot, &*self.accel, &self.film, &self.counters, &self.cancel);
        match self.job.until.noise {
            None => passes.advance(self.samples.end, &|_| true),
            Some(target) => {
                let tell = |standing: &Standing| self.tell_standing(standing.clone());
                render_to(&passes, target, self.samples.end, &tell).map(|(_, ended)| ended)
            }
        }
    }

    /// What it came to; `ended` where it is done and not only stopped.
    pub(super) fn reached(&self, ended: bool) -> Reached {
        let noise = self.standing().as_ref().map(NoiseStatus::from);
        let is_met = noise.is_none_or(|noise| noise.is_met());
        let end = match (ended, self.is_time_up.load(Ordering::Relaxed)) {
            (true, _) if is_met => End::Finished,
            (true, _) => End::TooNoisy,
            (false, true) => End::TimeUp,
            (false, false) => End::Stopped,
        };
        Reached { end, noise, error: self.error() }
    }

    fn tell_standing(&self, standing: Standing) {
        *self.standing.lock().unwrap_or_else(PoisonError::into_inner) = Some(standing);
    }

    pub(super) fn standing(&self) -> Option<Standing> {
        self.standing.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    fn begin(&self) {
        let mut timing = self.timing.lock().unwrap_or_else(PoisonError::into_inner);
        timing.running_since = Some(Instant::now());
    }

    fn pause(&self) {
        let mut timing = self.timing.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(since) = timing.running_since.take() {
            timing.spent += since.elapsed();
        }
    }

    /// Time in this session.
    pub(super) fn elapsed(&self) -> Duration {
        let timing = self.timing.lock().unwrap_or_else(PoisonError::into_inner);
        timing.spent + timing.running_since.map_or(Duration::ZERO, |since| since.elapsed())
    }

    /// Seconds of rendering in all sessions.
    pub(super) fn seconds(&self) -> f64 {
        self.before.seconds + self.elapsed().as_secs_f64()
    }

    /// Seconds of rendering before this session.
    pub(super) fn seconds_before(&self) -> f64 {
        self.before.seconds
    }

    /// What happened in this session and those before.
    pub(super) fn tally(&self) -> Tally {
        let Statistics { rays, media_overflows, cut_off, .. } = self.before;
        self.counters.tally() + Tally { rays, media_overflows, cut_off }
    }

    pub(super) fn error(&self) -> Option<f64> {
        error_so_far(&self.film, self.job.until.confidence())
    }

    fn metadata(&self) -> Metadata {
        let samples = Samples::of(&self.film, self.samples.start);
        // Parts that cut tiles may have been resumed: then nothing short tells how many each has.
        let counts = TileCounts::of(&self.film).unwrap_or_default();
        let source = self.shot.scene().source();
        let run = RunRecord {
            rays: self.tally().rays,
            seconds: (self.seconds() * 1e3).round() / 1e3,
            threads: self.threads,
            noise: self.job.until.noise,
            error: self.error(),
            intersector_choice: self.accel_words.clone(),
            embree: embree_as_text(),
            command: self.command.clone(),
            scene_file: source
                .and_then(|source| source.file.as_ref())
                .map(|file| std::fs::canonicalize(file).unwrap_or_else(|_| file.clone())),
            scene_text: source.and_then(|source| source.text.clone()),
        };
        let metadata = Metadata { run: Some(run), ..self.metadata.clone() };
        metadata.with_samples(samples, counts, Shares::default())
    }

    pub(super) fn write_checkpoint(
        &self,
        file: &WholeFile,
        reached: Option<&Reached>,
    ) -> Result<()> {
        let mut metadata = self.metadata();
        metadata.layers = Some(self.job.layers.clone());
        let is_ended = |reached: &&Reached| reached.end != End::Stopped;
        let status = reached.filter(is_ended).map_or(Status::Unfinished, |reached| Status::Ended {
            missed: reached.noise.filter(|noise| !noise.is_met()).into_iter().collect(),
        });
        let Tally { rays, media_overflows, cut_off } = self.tally();
        let scene = self.shot.scene();
        let source = scene.source().map(|source| {
            let mut source = source.clone();
            source.text = None;
            source.file = source.file.map(|file| std::path::absolute(&file).unwrap_or(file));
            source
        });
        let header = Header {
            film: self.film.format(),
            samples: self.samples.clone(),
            job: self.job.clone(),
            metadata,
            status,
            statistics: Statistics { rays, seconds: self.seconds(), media_overflows, cut_off },
            transparent: scene.description().background.transparent,
            source,
            delivery: self.delivery.clone(),
        };
        write_checkpoint(file, &self.film, &header)
    }
}

/// The film of a shot's picture with these layers, from the first sample on.
pub fn format_of(shot: &Shot, layers: &[crate::film::Kind]) -> Format {
    let transparent = shot.scene().description().background.transparent;
    format_with(shot.settings(), transparent, Scale::of_brightest(shot.brightest()), layers)
}

/// The same, before the scene's emitters are known.
pub(super) fn format_with(
    settings: &Settings,
    transparent: bool,
    scale: Scale,
    layers: &[crate::film::Kind],
) -> Format {
    let mut layers = summed_for(layers);
    if transparent && !layers.contains(&Layer::Alpha) {
        layers.push(Layer::Alpha);
    }
    let Rect { x, y, width, height } = settings.image.window();
    Format {
        frame: Frame {
            full_size: [settings.image.width, settings.image.height],
            window: Rect { x, y, width, height },
        },
        first_sample: 0,
        scale,
        layers,
        squares: true,
    }
}

/// As in "native (fastest on processors with AVX2; ...)".
fn words_of_accel(backend: Backend, reason: &str, accel: &dyn Accel) -> String {
    let details = accel.details();
    let separator = if details.is_empty() { "" } else { "; " };
    format!("{} ({reason}{separator}{details})", backend.name())
}

fn pool_of(threads: usize) -> Result<ThreadPool> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.map_err(|e| {
        Error::input(format!("cannot start the threads: {e}"))
            .with_help("ask for fewer threads")
            .with_setting(Setting::Threads, "")
    })
}
