//! A render session, which owns everything it needs. Any thread can run, monitor, stop, extend,
//! save and resume it.

use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use rayon::ThreadPool;

use crate::accel::{Accel, Backend, BuildOptions};
use crate::color::ViewTransform;
use crate::error::{Error, Result, Suggestion};
use crate::film::{Film, FilmFormat};
use crate::image_io::{AtomicFile, Picture};
use crate::overlay::OverlaySpec;
use crate::scene::{PreparedScene, Scene};
use crate::task::CancelToken;

use super::aovs::develop;
use super::checkpoint::{Checkpoint, CumulativeStats, OutputSpec, encode_checkpoint};
use super::film_format::format_for_scene;
use super::metadata::Metadata;
use super::monitor::{self, Autosave};
use super::observer::{Observer, RenderProgress};
use super::outcome::{RenderResult, RunOutcome};
use super::progressive::Counters;
use super::render_state::RenderState;
use super::resume;
use super::save_request::SaveRequest;
use super::shown_colors::{ColorDifference, median_difference};
use super::spec::Job;
use super::warnings::render_warnings;

/// A render session, which owns everything it needs.
pub struct Session {
    state: Arc<RenderState>,
    pool: ThreadPool,
    autosave: Option<Autosave>,
    /// Build time of the intersector, in seconds.
    build_seconds: f64,
}

/// Options for opening a session.
#[derive(Clone, Debug, Default)]
pub struct SessionOptions {
    /// Cancels the build and the render.
    pub cancel: CancelToken,
    /// Requests an immediate checkpoint while the render continues.
    pub save_request: SaveRequest,
    /// Receives the progress of the build.
    pub build_progress: crate::task::ProgressCallback,
    /// Output files of the render, to be recorded in checkpoints.
    pub output: Option<OutputSpec>,
    /// The shell-quoted command line, to be recorded in files.
    pub command: Option<String>,
    /// What is drawn over the picture, to be recorded in checkpoints.
    pub overlay: Option<OverlaySpec>,
}

impl Session {
    /// Opens a render without samples and builds the intersector.
    ///
    /// # Errors
    /// If the job is invalid, the film does not fit into memory, or the intersector cannot be
    /// built.
    pub fn new(scene: &Scene, job: Job, options: SessionOptions) -> Result<Self> {
        Self::create(scene, job, None, options)
    }

    /// Opens a render that continues from a checkpoint. The job may ask for more samples or less
    /// noise.
    ///
    /// # Errors
    /// If the checkpoint belongs to another scene or job (the message describes the difference), or
    /// as for [`Self::new`].
    pub fn resume(
        scene: &Scene,
        job: Job,
        checkpoint: Checkpoint,
        options: SessionOptions,
    ) -> Result<Self> {
        Self::create(scene, job, Some(checkpoint), options)
    }

    fn create(
        scene: &Scene,
        job: Job,
        checkpoint: Option<Checkpoint>,
        options: SessionOptions,
    ) -> Result<Self> {
        job.validate()?;
        let job = job.without_repeated_layers();
        let SessionOptions { cancel, save_request, build_progress, output, command, overlay } =
            options;
        let pool = thread_pool(job.threads)?;
        let prepared = pool.install(|| PreparedScene::new(scene, job.settings))?;
        let samples = job.sample_range()?;
        let selection = job.accel.select(scene.spheres());
        let metadata = Metadata { overlay, ..Metadata::new(&prepared, selection.backend) };
        let format =
            FilmFormat { first_sample: samples.start, ..format_for_scene(&prepared, &job.layers) };
        let (film, previous) = match checkpoint {
            None => (Film::new(&format)?, CumulativeStats::default()),
            Some(checkpoint) => resume::load_film(checkpoint, &metadata, &format, &samples, &job)?,
        };
        let build = BuildOptions {
            threads: pool.current_num_threads(),
            quality: job.quality,
            progress: build_progress,
            cancel: cancel.clone(),
            ..Default::default()
        };
        let start = Instant::now();
        let accel = pool.install(|| selection.backend.build(scene.spheres(), &build))?;
        let build_seconds = start.elapsed().as_secs_f64();
        let accel_summary = describe_accel(selection.backend, &selection.reason, &*accel);
        let total = film.frame().pixel_count() as u64 * samples.len() as u64;
        let state = RenderState {
            counters: Counters::new(&film, total),
            initial_samples: film.sample_count(),
            prepared,
            accel,
            film,
            job,
            samples,
            stop_token: Default::default(),
            cancel,
            is_running: AtomicBool::new(false),
            save_request,
            noise_progress: Default::default(),
            is_timed_out: AtomicBool::new(false),
            is_abandoned: AtomicBool::new(false),
            threads: pool.current_num_threads(),
            previous,
            clock: Default::default(),
            metadata,
            accel_summary,
            output,
            command,
        };
        Ok(Self { state: Arc::new(state), pool, autosave: None, build_seconds })
    }

    /// Saves the samples to this file periodically during a run, on a separate thread.
    ///
    /// # Errors
    /// If a checkpoint of this render would have too long a header to be read again.
    pub fn autosave(&mut self, file: AtomicFile, interval: Duration) -> Result<()> {
        self.state.checkpoint_header(None).encode()?;
        self.autosave = Some(Autosave { file, interval });
        Ok(())
    }

    /// Renders until the job is done, stopped or cancelled. Reports to `observer` on the calling
    /// thread. Another call continues from there.
    ///
    /// A stop request takes effect soon: render threads stuck in a long batch are abandoned, and
    /// their unfinished samples are discarded.
    ///
    /// # Errors
    /// If the session is already running, or a pixel is too bright for the film.
    pub fn run(&self, observer: &dyn Observer) -> Result<RunOutcome> {
        let _running = self.state.start_clock()?;
        monitor::run(&self.state, &self.pool, self.autosave.as_ref(), observer)
    }

    /// Stops the current run, or the next one if none is active. Every pixel then has a whole
    /// number of sample blocks, and the next run continues from there.
    pub fn stop(&self) {
        self.state.stop_token().cancel();
    }

    /// Asks for more samples, less noise or more time, after a run.
    ///
    /// # Errors
    /// If the job belongs to another render, or asks for less than the film holds.
    pub fn extend(&mut self, job: Job) -> Result<()> {
        job.validate()?;
        let Some(state) = Arc::get_mut(&mut self.state) else {
            let message = "threads of a run that was stopped are still rendering";
            return Err(Error::input(message).with_help("save a checkpoint and resume it"));
        };
        let error = |reason: String| Error::input(format!("cannot extend the render: {reason}"));
        let samples = job.sample_range()?;
        let prepared =
            self.pool.install(|| PreparedScene::new(state.prepared.scene(), job.settings))?;
        let overlay = state.metadata.overlay.clone();
        let metadata = Metadata { overlay, ..Metadata::new(&prepared, state.metadata.intersector) };
        let format =
            FilmFormat { first_sample: samples.start, ..format_for_scene(&prepared, &job.layers) };
        let format_before = state.film.format();
        resume::check_matches((&state.metadata, &format_before), (&metadata, &format))
            .map_err(error)?;
        resume::check_can_continue(&state.film, state.job.until.noise, &samples, &job)
            .map_err(error)?;
        state
            .counters
            .set_samples_total(state.film.frame().pixel_count() as u64 * samples.len() as u64);
        (state.prepared, state.metadata, state.samples, state.job) =
            (prepared, metadata, samples, job);
        Ok(())
    }

    /// Returns true if the job's time limit has ended the run.
    pub fn timed_out(&self) -> bool {
        self.state.is_timed_out.load(Ordering::Relaxed)
    }

    /// The job.
    pub fn job(&self) -> &Job {
        &self.state.job
    }

    /// The scene with the job's settings.
    pub fn prepared(&self) -> &PreparedScene {
        &self.state.prepared
    }

    /// The samples that every pixel will have when the render is complete.
    pub fn samples(&self) -> Range<u32> {
        self.state.samples.clone()
    }

    /// The film so far. A running render keeps adding to it.
    pub fn film(&self) -> &Film {
        &self.state.film
    }

    /// The intersector.
    pub fn accel(&self) -> &dyn Accel {
        &*self.state.accel
    }

    /// The intersector, why it was chosen, and how it was built, as text.
    pub fn accel_summary(&self) -> &str {
        &self.state.accel_summary
    }

    /// Build time of the intersector, in seconds.
    pub fn build_seconds(&self) -> f64 {
        self.build_seconds
    }

    /// Number of render threads.
    pub fn threads(&self) -> usize {
        self.pool.current_num_threads()
    }

    /// Progress of the render, without an error estimate.
    pub fn progress(&self) -> RenderProgress {
        self.state.progress(None)
    }

    /// Estimates the error that 95 % of the values stay below (or the fraction of the noise
    /// target), relative to the brightness, from a subset of pixels in a few milliseconds. `None`
    /// before anything is known.
    pub fn estimate_error(&self) -> Option<f64> {
        self.state.estimate_error()
    }

    /// The picture of the samples so far with all layers, and its metadata. During a run both come
    /// from one copy of the film, which doubles the film's memory.
    pub fn snapshot(&self) -> (Picture, Metadata) {
        let RenderState { prepared, accel, film, job, .. } = &*self.state;
        let develop_film = |film: &Film| {
            (develop(prepared, &**accel, film, &job.layers), self.state.metadata(film))
        };
        match self.state.is_running.load(Ordering::Acquire) {
            true => develop_film(&film.snapshot()),
            false => develop_film(film),
        }
    }

    /// The picture of the samples so far, as in [`Self::snapshot`].
    pub fn picture(&self) -> Picture {
        self.snapshot().0
    }

    /// A quick preview of the beauty so far, without other layers.
    pub fn preview(&self) -> Picture {
        let mut picture = self.state.film.picture();
        let transparent = self.state.prepared.scene().description().background.transparent;
        picture.alpha = picture.alpha.filter(|_| self.state.job.has_alpha(transparent));
        picture
    }

    /// How far the colours of particles in a picture of the session, as a screen shows them, are
    /// from those that a colour bar shows; `None` if no particle of a file is seen.
    pub fn color_difference(
        &self,
        picture: &Picture,
        look: &ViewTransform,
    ) -> Option<ColorDifference> {
        let RenderState { prepared, accel, film, .. } = &*self.state;
        median_difference(prepared, &**accel, film.frame(), picture, look)
    }

    /// Metadata of the picture so far.
    pub fn metadata(&self) -> Metadata {
        self.state.metadata(&self.state.film)
    }

    /// Samples and rays of this session, without earlier ones, and warnings for the user about the
    /// picture.
    pub fn statistics(&self) -> (u64, u64, Vec<String>) {
        let state = &*self.state;
        let samples = state.counters.samples_done() - state.initial_samples;
        let warnings = render_warnings(&state.prepared, &state.stats(), &state.film);
        (samples, state.counters.stats().rays, warnings)
    }

    /// Writes a checkpoint. `outcome` is the outcome if the render has ended.
    ///
    /// # Errors
    /// If its header is too long, or writing fails; an existing file is then unchanged.
    pub fn write_checkpoint(&self, file: &AtomicFile, outcome: Option<&RunOutcome>) -> Result<()> {
        self.state.write_checkpoint(file, outcome)
    }

    /// Returns a checkpoint in memory, for [`Checkpoint::from_bytes`]. `reached` is the outcome if
    /// the render has ended.
    ///
    /// # Errors
    /// If its header is too long.
    pub fn checkpoint_bytes(&self, reached: Option<&RunOutcome>) -> Result<Vec<u8>> {
        encode_checkpoint(&self.state.film, &self.state.checkpoint_header(reached))
    }

    /// The full result of a run.
    pub fn result(&self, outcome: RunOutcome) -> RenderResult {
        let RunOutcome { stop_reason: end, noise, error } = outcome;
        let (_, _, mut warnings) = self.statistics();
        warnings.extend(noise.filter(|noise| !noise.is_met()).map(|noise| noise.to_string()));
        RenderResult {
            picture: self.install(|| self.picture()),
            metadata: Metadata { layers: Some(self.state.job.layers.clone()), ..self.metadata() },
            stop_reason: end,
            noise,
            error,
            samples: self.state.film.sample_count(),
            rays: self.state.stats().rays,
            seconds: self.state.total_seconds(),
            warnings,
        }
    }

    /// Runs a closure with the help of all threads, even if the render threads are stuck.
    pub fn install<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        if !self.state.is_abandoned.load(Ordering::Relaxed) {
            return self.pool.install(work);
        }
        match thread_pool(self.state.job.threads) {
            Ok(pool) => pool.install(work),
            // If no threads can be started, run on this thread.
            Err(_) => work(),
        }
    }
}

/// As in "native (fastest on processors with AVX2; ...)".
fn describe_accel(backend: Backend, reason: &str, accel: &dyn Accel) -> String {
    let details = accel.details();
    let separator = if details.is_empty() { "" } else { "; " };
    format!("{} ({reason}{separator}{details})", backend.name())
}

fn thread_pool(threads: usize) -> Result<ThreadPool> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.map_err(|e| {
        Error::input(format!("cannot start the threads: {e}"))
            .with_help("use fewer threads")
            .with_suggestion(Suggestion::Threads, "")
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::ErrorBound;
    use crate::math::{Hit, Ray};
    use crate::scene::SceneBuilder;
    use std::sync::atomic::AtomicUsize;

    /// An intersector without spheres that panics after a few calls.
    struct Failing(AtomicUsize);

    impl Accel for Failing {
        fn closest(&self, _: &[Ray], hits: &mut [Hit]) {
            assert!(self.0.fetch_add(1, Ordering::SeqCst) < 8, "a mistake, as this test wants it");
            hits.fill(Hit::MISS);
        }

        fn occluded(&self, _: &[Ray], occluded: &mut [bool]) {
            occluded.fill(false);
        }

        fn error_bound(&self) -> ErrorBound {
            ErrorBound { particles: 0.0, giants: 0.0, rounds_origin: false }
        }

        fn bytes(&self) -> usize {
            0
        }
    }

    #[test]
    fn a_panic_of_a_thread_that_renders_keeps_the_samples_so_far() {
        let mut scene = SceneBuilder::new();
        let grey = scene.diffuse([0.5; 3]);
        scene.sphere(grey, [0.0; 3], 1.0);
        let scene = scene.build().unwrap();
        let mut job = Job::with_size(64, 48).samples_per_pixel(4096);
        job.threads = 1;
        let mut session = Session::new(&scene, job, SessionOptions::default()).unwrap();
        Arc::get_mut(&mut session.state).unwrap().accel = Box::new(Failing(AtomicUsize::new(0)));
        let outcome = session.run(&()).unwrap();
        let samples = session.film().sample_count();
        assert!(
            outcome.stop_reason == super::super::StopReason::Failed && samples > 0,
            "{outcome:?}"
        );
        assert_eq!(session.result(outcome).samples, samples);
    }
}
