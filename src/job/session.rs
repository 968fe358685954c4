//! A render that owns all it needs. It can be run, looked at while it runs, stopped, extended, saved and
//! resumed, from any thread.

use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use rayon::ThreadPool;

use crate::accel::{self, Accel, Backend, BuildOptions, Cancel};
use crate::error::{Error, Result, Setting};
use crate::film::{Film, Format, Picture};
use crate::output::WholeFile;
use crate::scene::{Scene, Shot};

use super::aovs::picture;
use super::checkpoint::{Checkpoint, Delivery, Statistics};
use super::film_format::format_of;
use super::metadata::Metadata;
use super::monitor::{self, Autosave};
use super::observer::{Observer, Progress};
use super::outcome::{Outcome, Reached, warnings};
use super::passes::Counters;
use super::render_state::RenderState;
use super::spec::Job;
use super::start;

/// A render that owns all it needs.
pub struct Session {
    state: Arc<RenderState>,
    pool: ThreadPool,
    autosave: Option<Autosave>,
    /// Seconds that the intersector's build took.
    build_seconds: f64,
}

/// What a session is opened with, beside scene and job.
#[derive(Clone, Debug, Default)]
pub struct Opening {
    /// Set from elsewhere to stop the build and the render.
    pub cancel: Cancel,
    /// Told how far the build is.
    pub build_progress: accel::Progress,
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
        let state = RenderState {
            counters: Counters::of(&film, total),
            samples_before: film.samples(),
            shot,
            accel,
            film,
            job,
            samples,
            cancel,
            standing: Default::default(),
            is_time_up: AtomicBool::new(false),
            is_left_behind: AtomicBool::new(false),
            threads: pool.current_num_threads(),
            before,
            timing: Default::default(),
            metadata,
            accel_words,
            delivery,
            command,
        };
        Ok(Self { state: Arc::new(state), pool, autosave: None, build_seconds })
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
        self.state.begin();
        let reached = monitor::run(&self.state, &self.pool, self.autosave.as_ref(), observer);
        self.state.pause();
        reached
    }

    /// Asks the render to stop; it then has some whole number of blocks of samples in every pixel.
    pub fn stop(&self) {
        self.state.cancel.cancel();
    }

    /// The request to stop, to be set from elsewhere.
    pub fn cancel(&self) -> Cancel {
        self.state.cancel.clone()
    }

    /// Whether the time of the job is up.
    pub fn is_time_up(&self) -> bool {
        self.state.is_time_up.load(Ordering::Relaxed)
    }

    /// The render.
    pub fn job(&self) -> &Job {
        &self.state.job
    }

    /// The scene as the job has it.
    pub fn shot(&self) -> &Shot {
        &self.state.shot
    }

    /// The samples that every pixel is to have in the end.
    pub fn samples(&self) -> Range<u32> {
        self.state.samples.clone()
    }

    /// The sums so far, which may grow while they are looked at.
    pub fn film(&self) -> &Film {
        &self.state.film
    }

    /// The intersector.
    pub fn accel(&self) -> &dyn Accel {
        &*self.state.accel
    }

    /// The intersector, why it, and how it was built, in words.
    pub fn accel_as_text(&self) -> &str {
        &self.state.accel_words
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
        self.state.progress(None)
    }

    /// The error that a share of the values stay below, estimated from some pixels in a few
    /// milliseconds; `None` before anything is known.
    pub fn error(&self) -> Option<f64> {
        self.state.error()
    }

    /// The picture of the samples so far with all of its layers: every pixel at a whole number of calls
    /// of the integrator.
    pub fn picture(&self) -> Picture {
        let RenderState { shot, accel, film, job, .. } = &*self.state;
        picture(shot, &**accel, film, &job.layers)
    }

    /// The beauty so far, quickly, for those who only look on.
    pub fn preview(&self) -> Picture {
        let mut picture = self.state.film.picture();
        let transparent = self.state.shot.scene().description().background.transparent;
        picture.alpha = picture.alpha.filter(|_| self.state.job.has_alpha(transparent));
        picture
    }

    /// How the picture so far was made.
    pub fn metadata(&self) -> Metadata {
        self.state.metadata()
    }

    /// Samples and rays of this session alone, and what the user should know about the picture.
    pub fn statistics(&self) -> (u64, u64, Vec<String>) {
        let state = &*self.state;
        let samples = state.counters.samples_done() - state.samples_before;
        let warnings = warnings(&state.shot, &state.tally(), &state.film);
        (samples, state.counters.tally().rays, warnings)
    }

    /// Writes the sums; `reached` is what they came to, where the render does not go on.
    ///
    /// # Errors
    /// When the disk refuses; a file that was there before is then unchanged.
    pub fn write_checkpoint(&self, file: &WholeFile, reached: Option<&Reached>) -> Result<()> {
        self.state.write_checkpoint(file, reached)
    }

    /// All that there is to know of what the render came to.
    pub fn outcome(&self, reached: Reached) -> Outcome {
        let Reached { end, noise, error } = reached;
        let (_, _, mut warnings) = self.statistics();
        warnings.extend(noise.filter(|noise| !noise.is_met()).map(|noise| noise.to_string()));
        Outcome {
            picture: self.on_free_threads(|| self.picture()),
            metadata: Metadata { layers: Some(self.state.job.layers.clone()), ..self.metadata() },
            end,
            noise,
            error,
            samples: self.state.film.samples(),
            rays: self.state.tally().rays,
            seconds: self.state.seconds(),
            warnings,
        }
    }

    /// Does something with the help of all threads, also where those that render are stuck.
    pub fn on_free_threads<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        if !self.state.is_left_behind.load(Ordering::Relaxed) {
            return self.pool.install(work);
        }
        match pool_of(self.state.job.threads) {
            Ok(pool) => pool.install(work),
            // Without threads to be had, this one does it alone.
            Err(_) => work(),
        }
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
