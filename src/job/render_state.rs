//! State shared by the threads of a render: the film, the counters, and what is derived from them.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use crate::accel::Accel;
use crate::error::{Error, Result};
use crate::film::{BLOCK_SIZE, Film};
use crate::image_io::AtomicFile;
use crate::integrator::RenderStats;
use crate::scene::PreparedScene;
use crate::task::CancelToken;

use super::adaptive::{MIN_ADAPTIVE_SAMPLES, NoiseProgress, estimate_error, render_adaptive};
use super::checkpoint::{
    CheckpointHeader, CumulativeStats, OutputSpec, RenderStatus, write_checkpoint,
};
use super::eta::{self, Eta};
use super::metadata::{Metadata, RunRecord, embree_summary};
use super::noise_status::NoiseStatus;
use super::observer::{FirstEstimate, RenderProgress};
use super::outcome::{RunOutcome, StopReason};
use super::progressive::{Counters, ProgressiveRenderer};
use super::samples::{MergedSamples, SampleRange, TileSampleCounts};
use super::save_request::SaveRequest;
use super::spec::Job;

/// State shared by the render threads and the monitoring threads.
pub(super) struct RenderState {
    pub(super) prepared: PreparedScene,
    pub(super) accel: Box<dyn Accel>,
    pub(super) film: Film,
    pub(super) job: Job,
    /// The samples that every pixel will have.
    pub(super) samples: Range<u32>,
    /// Stops the current run, or the next one if none is running.
    pub(super) stop_token: Mutex<CancelToken>,
    /// External cancellation, which ends every run.
    pub(super) cancel: CancelToken,
    pub(super) is_running: AtomicBool,
    pub(super) counters: Counters,
    pub(super) noise_progress: Mutex<Option<NoiseProgress>>,
    pub(super) is_timed_out: AtomicBool,
    /// Set if render threads still run after they were asked to stop.
    pub(super) is_abandoned: AtomicBool,
    pub(super) save_request: SaveRequest,
    /// Statistics of earlier sessions.
    pub(super) previous: CumulativeStats,
    pub(super) initial_samples: u64,
    pub(super) clock: Mutex<RunClock>,
    pub(super) threads: usize,
    pub(super) metadata: Metadata,
    pub(super) accel_summary: String,
    pub(super) output: Option<OutputSpec>,
    /// The command line, for the record of a run.
    pub(super) command: Option<String>,
}

/// Measures the render time.
#[derive(Default)]
pub(super) struct RunClock {
    /// Total duration of this session's completed runs.
    elapsed: Duration,
    running_since: Option<Instant>,
}

/// Ends the current run when dropped.
pub(super) struct RunGuard<'a>(&'a RenderState);

impl Drop for RunGuard<'_> {
    fn drop(&mut self) {
        let state = self.0;
        let mut clock = lock(&state.clock);
        if let Some(since) = clock.running_since.take() {
            clock.elapsed += since.elapsed();
        }
        // Abandoned threads still hold the old token.
        *lock(&state.stop_token) = CancelToken::default();
        state.is_running.store(false, Ordering::Release);
    }
}

/// Locks a mutex. Poisoning is ignored: nothing can panic while a lock is held.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl RenderState {
    /// Renders until the job is done or cancelled. Returns true if it is done.
    pub(super) fn render(&self) -> Result<bool> {
        let stop = self.stop_token();
        let renderer = ProgressiveRenderer::new(
            &self.prepared,
            &*self.accel,
            &self.film,
            &self.counters,
            &stop,
        );
        match self.job.until.noise {
            None => renderer.render_to_sample(self.samples.end, &|_| true),
            Some(target) => {
                let on_progress = |noise_progress: &NoiseProgress| {
                    self.set_noise_progress(noise_progress.clone())
                };
                render_adaptive(&renderer, target, self.samples.end, &on_progress)
                    .map(|(_, is_done)| is_done)
            }
        }
    }

    /// The outcome of a run. `is_done` is true if the job is done and was not only stopped.
    pub(super) fn outcome(&self, is_done: bool) -> RunOutcome {
        let noise = self.noise_progress().as_ref().map(NoiseStatus::from);
        let is_met = noise.is_none_or(|noise| noise.is_met());
        let end = match (is_done, self.is_timed_out.load(Ordering::Relaxed)) {
            (true, _) if is_met => StopReason::Finished,
            (true, _) => StopReason::NoiseTargetMissed,
            (false, true) => StopReason::TimeLimit,
            (false, false) => StopReason::Stopped,
        };
        RunOutcome { stop_reason: end, noise, error: self.estimate_error() }
    }

    fn set_noise_progress(&self, noise_progress: NoiseProgress) {
        *lock(&self.noise_progress) = Some(noise_progress);
    }

    pub(super) fn noise_progress(&self) -> Option<NoiseProgress> {
        lock(&self.noise_progress).clone()
    }

    /// Starts a run, which ends when the returned guard is dropped.
    ///
    /// # Errors
    /// If a run is active: two runs would render the same samples twice.
    pub(super) fn start_clock(&self) -> Result<RunGuard<'_>> {
        if self.is_abandoned.load(Ordering::Relaxed) {
            let message = "threads of a run that was stopped are still rendering";
            return Err(Error::input(message).with_help("save a checkpoint and resume it"));
        }
        if self.is_running.swap(true, Ordering::AcqRel) {
            return Err(Error::input("this session is already running"));
        }
        self.is_timed_out.store(false, Ordering::Relaxed);
        lock(&self.clock).running_since = Some(Instant::now());
        Ok(RunGuard(self))
    }

    /// The token that stops the current run.
    pub(super) fn stop_token(&self) -> CancelToken {
        lock(&self.stop_token).clone()
    }

    /// Returns true if the run should stop. Forwards an external cancellation to the current run.
    pub(super) fn should_stop(&self) -> bool {
        let stop = self.stop_token();
        if self.cancel.is_cancelled() {
            stop.cancel();
        }
        stop.is_cancelled()
    }

    /// Render time in this session.
    pub(super) fn elapsed(&self) -> Duration {
        let clock = lock(&self.clock);
        clock.elapsed + clock.running_since.map_or(Duration::ZERO, |since| since.elapsed())
    }

    /// Render time of all sessions, in seconds.
    pub(super) fn total_seconds(&self) -> f64 {
        self.previous.seconds + self.elapsed().as_secs_f64()
    }

    /// Render time before this session, in seconds.
    pub(super) fn previous_seconds(&self) -> f64 {
        self.previous.seconds
    }

    /// Statistics of this session and earlier ones; connections of this one alone.
    pub(super) fn stats(&self) -> RenderStats {
        let CumulativeStats { rays, truncated_paths, .. } = self.previous;
        self.counters.stats() + RenderStats { rays, truncated_paths, connections: 0 }
    }

    pub(super) fn estimate_error(&self) -> Option<f64> {
        estimate_error(&self.film, &self.job.until.reported_target())
    }

    /// The noise target, if there is one that is not met.
    fn missed_target(&self) -> Option<NoiseStatus> {
        self.noise_progress().as_ref().map(NoiseStatus::from).filter(|status| !status.is_met())
    }

    /// Metadata of a picture developed from `film`.
    pub(super) fn metadata(&self, film: &Film) -> Metadata {
        let samples = SampleRange::from_film(film, self.samples.start);
        // After resuming merged parts whose windows cut tiles, the samples within a tile may
        // differ, and per-tile counts cannot describe them.
        let counts = TileSampleCounts::from_film(film).unwrap_or_default();
        let source = self.prepared.scene().source();
        let run = RunRecord {
            rays: self.stats().rays,
            seconds: (self.total_seconds() * 1e3).round() / 1e3,
            threads: self.threads,
            noise: self.job.until.noise,
            error: self.estimate_error(),
            missed: self.missed_target(),
            intersector_choice: self.accel_summary.clone(),
            embree: embree_summary(),
            command: self.command.clone(),
            scene_file: source
                .and_then(|source| source.file.as_ref())
                .map(|file| std::path::absolute(file).unwrap_or_else(|_| file.clone())),
            scene_text: source.and_then(|source| source.text.clone()),
        };
        let metadata = Metadata { run: Some(run), ..self.metadata.clone() };
        metadata.with_samples(samples, counts, MergedSamples::default())
    }

    /// The header of a checkpoint. `outcome` is the outcome if the render has ended.
    pub(super) fn checkpoint_header(&self, outcome: Option<&RunOutcome>) -> CheckpointHeader {
        let mut metadata = self.metadata(&self.film);
        metadata.layers = Some(self.job.layers.clone());
        let is_ended = |outcome: &&RunOutcome| {
            !matches!(outcome.stop_reason, StopReason::Stopped | StopReason::Failed)
        };
        let status = outcome.filter(is_ended).map_or(RenderStatus::Unfinished, |outcome| {
            RenderStatus::Ended {
                missed_targets: outcome.noise.filter(|noise| !noise.is_met()).into_iter().collect(),
            }
        });
        let RenderStats { rays, truncated_paths, .. } = self.stats();
        let scene = self.prepared.scene();
        let source = scene.source().map(|source| {
            let mut source = source.clone();
            source.text = None;
            source.file = source.file.map(|file| std::path::absolute(&file).unwrap_or(file));
            source
        });
        CheckpointHeader {
            film: self.film.format(),
            samples: self.samples.clone(),
            job: self.job.clone(),
            metadata,
            status,
            statistics: CumulativeStats { rays, seconds: self.total_seconds(), truncated_paths },
            transparent: scene.description().background.transparent,
            source,
            output: self.output.clone(),
        }
    }

    /// Writes the samples so far. `outcome` is the outcome if the render has ended.
    pub(super) fn write_checkpoint(
        &self,
        file: &AtomicFile,
        outcome: Option<&RunOutcome>,
    ) -> Result<()> {
        write_checkpoint(file, &self.film, &self.checkpoint_header(outcome))
    }

    /// Remaining time of the job's time limit, counted over all its runs; `None` without a limit.
    pub(super) fn time_left(&self) -> Option<Duration> {
        let spent = Duration::try_from_secs_f64(self.previous_seconds()).unwrap_or_default();
        Some(self.job.until.time?.saturating_sub(spent).saturating_sub(self.elapsed()))
    }

    /// Samples required before the time limit can end the render: one block per pixel.
    pub(super) fn min_samples(&self) -> u64 {
        let block = BLOCK_SIZE.min(self.samples.len() as u32);
        self.film.frame().pixel_count() as u64 * u64::from(block)
    }

    /// Stops the render if the time limit has passed and every pixel has one block of samples. An
    /// earlier stop request keeps its own stop reason.
    pub(super) fn check_time_limit(&self) {
        if self.should_stop() {
            return;
        }
        let is_up = self.time_left().is_some_and(|time_left| time_left.is_zero());
        if is_up && self.counters.samples_done() >= self.min_samples() {
            self.is_timed_out.store(true, Ordering::Relaxed);
            self.stop_token().cancel();
        }
    }

    /// How far tiles are from the samples of their first estimate, at so many samples per second.
    fn to_first_estimate(&self, done: u64, rate: f64) -> Option<FirstEstimate> {
        let pixels = self.film.frame().pixel_count() as f64;
        let (samples, needed) = (done as f64 / pixels, self.samples.end.min(MIN_ADAPTIVE_SAMPLES));
        let time = |samples: f64| Duration::try_from_secs_f64(samples * pixels / rate).ok();
        Some(FirstEstimate {
            samples,
            needed,
            time_per_sample: time(1.0)?,
            time_left: time((f64::from(needed) - samples).max(0.0))?,
        })
    }

    /// Progress of the render. `error` is the last error estimate.
    pub(super) fn progress(&self, error: Option<f64>) -> RenderProgress {
        let done = self.counters.samples_done().max(self.initial_samples);
        let noise_progress = self.noise_progress();
        let mut total = match &noise_progress {
            Some(noise_progress) => noise_progress.expected_samples.clone(),
            None => {
                let total = self.counters.samples_total();
                total..total
            }
        };
        let (elapsed, samples) = (self.elapsed(), done - self.initial_samples);
        let time_left = self.time_left();
        if let Some(time_left) = time_left {
            let expected = done + eta::expected_samples(time_left, samples, elapsed);
            total = eta::total_at_deadline(&total, expected, self.min_samples());
        }
        let samples_left = total.start.saturating_sub(done)..total.end.saturating_sub(done);
        let estimate = Eta { elapsed, samples, samples_left };
        // The time left is unknown before the first noise decisions.
        let is_known = noise_progress
            .as_ref()
            .is_none_or(|noise_progress| noise_progress.worst_error.is_finite());
        let to_first_estimate =
            (!is_known).then(|| self.to_first_estimate(done, estimate.rate())).flatten();
        RenderProgress {
            to_first_estimate,
            samples_done: done,
            samples_total: total.end,
            rate: estimate.rate(),
            error,
            worst_error: noise_progress
                .as_ref()
                .map(|noise_progress| noise_progress.worst_error)
                .filter(|error| error.is_finite()),
            tiles_converged: noise_progress
                .map(|noise_progress| [noise_progress.tiles_converged, noise_progress.tiles]),
            time_left: estimate.time_left().filter(|_| is_known || time_left.is_some()),
        }
    }
}
