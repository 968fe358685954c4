//! What the threads of a render share: the film and the counters that grow, and what is told of them.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use crate::accel::Accel;
use crate::error::{Error, Result};
use crate::film::{BLOCK, Film};
use crate::image_io::WholeFile;
use crate::integrator::Tally;
use crate::scene::Shot;
use crate::task::Cancel;

use super::adaptive::{Standing, error_so_far, render_to};
use super::checkpoint::{Delivery, Header, Statistics, Status, write_checkpoint};
use super::metadata::{Metadata, RunRecord, embree_as_text};
use super::observer::Progress;
use super::outcome::{End, NoiseStatus, Reached};
use super::pace::{self, Pace};
use super::passes::{Counters, Passes};
use super::samples::{Samples, Shares, TileCounts};
use super::save_request::SaveRequest;
use super::spec::Job;

/// What the threads that render share with those that look on.
pub(super) struct RenderState {
    pub(super) shot: Shot,
    pub(super) accel: Box<dyn Accel>,
    pub(super) film: Film,
    pub(super) job: Job,
    /// The samples that every pixel is to have.
    pub(super) samples: Range<u32>,
    /// The request to stop the run that goes on, or else the next one.
    pub(super) stop: Mutex<Cancel>,
    /// A request from elsewhere, which ends every run.
    pub(super) cancel: Cancel,
    pub(super) is_running: AtomicBool,
    pub(super) counters: Counters,
    pub(super) standing: Mutex<Option<Standing>>,
    pub(super) is_time_up: AtomicBool,
    /// Set where threads still render though they were asked to stop.
    pub(super) is_left_behind: AtomicBool,
    pub(super) save_request: SaveRequest,
    /// What earlier runs took.
    pub(super) before: Statistics,
    pub(super) samples_before: u64,
    pub(super) timing: Mutex<Timing>,
    pub(super) threads: usize,
    pub(super) metadata: Metadata,
    pub(super) accel_words: String,
    pub(super) delivery: Option<Delivery>,
    /// What the command line adds to the records of a run.
    pub(super) command: Option<String>,
}

/// When the render ran.
#[derive(Default)]
pub(super) struct Timing {
    /// Of runs of this session that are over.
    spent: Duration,
    running_since: Option<Instant>,
}

/// A run that goes on.
pub(super) struct Running<'a>(&'a RenderState);

impl Drop for Running<'_> {
    fn drop(&mut self) {
        let state = self.0;
        let mut timing = lock(&state.timing);
        if let Some(since) = timing.running_since.take() {
            timing.spent += since.elapsed();
        }
        // Threads that were left behind still hold the old request.
        *lock(&state.stop) = Cancel::default();
        state.is_running.store(false, Ordering::Release);
    }
}

/// No lock is held while anything can panic.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl RenderState {
    /// Renders until the job is done or cancelled. Returns whether it is done.
    pub(super) fn reach(&self) -> Result<bool> {
        let stop = self.stop_request();
        let passes = Passes::new(&self.shot, &*self.accel, &self.film, &self.counters, &stop);
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
        *lock(&self.standing) = Some(standing);
    }

    pub(super) fn standing(&self) -> Option<Standing> {
        lock(&self.standing).clone()
    }

    /// Begins a run, which ends when the value is dropped.
    ///
    /// # Errors
    /// When a run is going on: two would render the same samples twice.
    pub(super) fn begin(&self) -> Result<Running<'_>> {
        if self.is_left_behind.load(Ordering::Relaxed) {
            let message = "threads of a run that was stopped are still rendering";
            return Err(Error::input(message).with_help("save a checkpoint, and resume that"));
        }
        if self.is_running.swap(true, Ordering::AcqRel) {
            return Err(Error::input("this session is running already"));
        }
        self.is_time_up.store(false, Ordering::Relaxed);
        lock(&self.timing).running_since = Some(Instant::now());
        Ok(Running(self))
    }

    /// The request to stop the current run.
    pub(super) fn stop_request(&self) -> Cancel {
        lock(&self.stop).clone()
    }

    /// Whether the run is to stop; a request from elsewhere becomes one of this run.
    pub(super) fn is_asked_to_stop(&self) -> bool {
        let stop = self.stop_request();
        if self.cancel.is_cancelled() {
            stop.cancel();
        }
        stop.is_cancelled()
    }

    /// Time in this session.
    pub(super) fn elapsed(&self) -> Duration {
        let timing = lock(&self.timing);
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

    /// How the picture of a film of this render was made.
    pub(super) fn metadata(&self, film: &Film) -> Metadata {
        let samples = Samples::of(film, self.samples.start);
        // Parts that cut tiles may have been resumed: then nothing short tells how many each has.
        let counts = TileCounts::of(film).unwrap_or_default();
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
        let mut metadata = self.metadata(&self.film);
        metadata.layers = Some(self.job.layers.clone());
        let is_ended = |reached: &&Reached| !matches!(reached.end, End::Stopped | End::Failed);
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

    /// What is left of the time of the job, counted over all its runs; `None` where there is no limit.
    pub(super) fn time_left(&self) -> Option<Duration> {
        let spent = Duration::try_from_secs_f64(self.seconds_before()).unwrap_or_default();
        Some(self.job.until.time?.saturating_sub(spent).saturating_sub(self.elapsed()))
    }

    /// Samples that there must be before the time ends the render: one block of every pixel.
    pub(super) fn samples_at_least(&self) -> u64 {
        let block = BLOCK.min(self.samples.len() as u32);
        self.film.frame().pixels() as u64 * u64::from(block)
    }

    /// Stops the render, if its time is up and it has one block of every pixel. Who stopped it before is
    /// who stopped it.
    pub(super) fn mind_time(&self) {
        if self.is_asked_to_stop() {
            return;
        }
        let is_up = self.time_left().is_some_and(|left| left.is_zero());
        if is_up && self.counters.samples_done() >= self.samples_at_least() {
            self.is_time_up.store(true, Ordering::Relaxed);
            self.stop_request().cancel();
        }
    }

    /// How far it is; `error` is the last estimate of the error.
    pub(super) fn progress(&self, error: Option<f64>) -> Progress {
        let done = self.counters.samples_done().max(self.samples_before);
        let standing = self.standing();
        let mut total = match &standing {
            Some(standing) => standing.samples.clone(),
            None => {
                let total = self.counters.samples_total();
                total..total
            }
        };
        let (elapsed, samples) = (self.elapsed(), done - self.samples_before);
        let rest = self.time_left();
        if let Some(rest) = rest {
            let in_time = done + pace::samples_in(rest, samples, elapsed);
            total = pace::total_in_time(&total, in_time, self.samples_at_least());
        }
        let left = total.start.saturating_sub(done)..total.end.saturating_sub(done);
        let estimate = Pace { elapsed, samples, left };
        // Before the first decisions nobody knows.
        let is_known = standing.as_ref().is_none_or(|standing| standing.worst.is_finite());
        Progress {
            samples_done: done,
            samples_total: total.end,
            rate: estimate.rate(),
            error,
            squares: standing.map(|standing| [standing.done, standing.squares]),
            left: estimate.time_left().filter(|_| is_known || rest.is_some()),
        }
    }
}
