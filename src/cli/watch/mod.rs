//! Those who look on while a scene is rendered: the progress, a preview file, the viewer tev.
//!
//! They have one thread, which reads the film as it is and never makes the render wait. What it
//! spends on pictures and errors is held below a fiftieth of the time of all threads, however large the
//! picture and however short the wish of `--preview-every`. The picture at the end is always shown: a
//! render that is over sooner than that pays for it has no other.

mod preview;
mod tev;
mod turns;

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::time::{Duration, Instant};

use crate::accel::Cancel;
use crate::color::Look;
use crate::error::Result;
use crate::film::{Film, Frame, Picture};
use crate::render::{self, Standing};

use super::args::WatchArgs;
use super::goal::CONFIDENCE;
use super::interrupt::Interrupt;
use super::pace::{self, Pace};
use super::progress::{Progress, State};
use super::{outputs, print};

use preview::Preview;
use tev::Tev;
use turns::Turns;

/// How long those who look on may take for the last picture, when all is saved.
const PATIENCE: Duration = Duration::from_secs(5);
/// The same where somebody waits for the program to be gone.
const PATIENCE_WHEN_STOPPED: Duration = Duration::from_millis(300);
/// Between two looks at the clock; where a time is nearly up, sooner.
const TICK: Duration = Duration::from_millis(100);
const SHORTEST_TICK: Duration = Duration::from_millis(5);
/// Between two estimates of the error.
const BETWEEN_ERRORS: Duration = Duration::from_secs(2);
/// The shares of the time of all threads that pictures and errors may take.
const FOR_PICTURES: f64 = 1.0 / 64.0;
const FOR_ERRORS: f64 = 1.0 / 256.0;
/// What a pixel of a picture takes, and what an error does: known better after the first, so on the safe
/// side of what was measured.
const PIXEL: Duration = Duration::from_nanos(300);
const ERROR: Duration = Duration::from_millis(5);

/// What a render tells of itself, from any of its threads.
#[derive(Default)]
pub(super) struct Told {
    samples_done: AtomicU64,
    samples_total: AtomicU64,
    standing: Mutex<Option<Standing>>,
    /// Set when nothing more is rendered.
    has_ended: AtomicBool,
    /// The picture that it came to.
    picture: Mutex<Option<Picture>>,
}

impl Told {
    pub(super) fn progress(&self, state: render::Progress) {
        self.samples_done.fetch_max(state.samples_done, Ordering::Relaxed);
        self.samples_total.store(state.samples_total, Ordering::Relaxed);
    }

    /// Nothing more is rendered from now on.
    pub(super) fn end(&self) {
        self.has_ended.store(true, Ordering::Relaxed);
    }

    /// The picture that it came to: so nobody needs to make it again.
    pub(super) fn picture(&self, picture: Picture) {
        if let Ok(mut told) = self.picture.lock() {
            *told = Some(picture);
        }
    }

    pub(super) fn standing(&self, standing: Standing) {
        if let Ok(mut told) = self.standing.lock() {
            *told = Some(standing);
        }
    }

    /// How far the render to a target was when it last told.
    pub(super) fn last_standing(&self) -> Option<Standing> {
        self.standing.lock().ok().and_then(|told| told.clone())
    }
}

/// Where the picture so far is to be seen.
pub(super) struct Shows {
    preview: Option<Preview>,
    tev: Option<Tev>,
    /// Between two pictures.
    every: Duration,
}

impl Shows {
    /// `look` is how the preview shows light, `name` what the picture is called elsewhere. A render that
    /// goes on does so without those who have gone away since.
    ///
    /// # Errors
    /// When the preview cannot be written, or tev cannot be reached, and it does not go on.
    pub(super) fn new(args: &WatchArgs, look: Look, name: String, goes_on: bool) -> Result<Self> {
        let preview = args.preview.as_deref().map(|path| Preview::new(path, look));
        let tev = args.tev.as_deref().map(|place| Tev::find(place, name));
        let (preview, tev) = (there(preview, goes_on)?, there(tev, goes_on)?);
        Ok(Self { preview, tev, every: args.preview_every })
    }

    fn is_empty(&self) -> bool {
        self.preview.is_none() && self.tev.is_none()
    }

    /// Brings the pictures up to date. Who cannot be reached any more is told of once.
    fn update(&mut self, picture: &Picture, frame: &Frame) {
        if let Some(preview) = &mut self.preview {
            preview.write(picture, outputs::crop(frame));
        }
        if let Some(Err(e)) = self.tev.as_mut().map(|tev| tev.show(picture)) {
            print::warning(format_args!("tev does not take the picture any more: {e}"));
            self.tev = None;
        }
    }
}

/// Who is there to look on.
fn there<T>(found: Option<Result<T>>, goes_on: bool) -> Result<Option<T>> {
    match found {
        Some(Err(e)) if goes_on => {
            print::warning(format_args!("{e}; the render goes on without it"));
            Ok(None)
        }
        found => found.transpose(),
    }
}

/// The thread's equipment.
pub(super) struct Watch<'a> {
    pub(super) film: &'a Film,
    pub(super) told: &'a Told,
    pub(super) progress: &'a Progress,
    pub(super) shows: Shows,
    /// Threads that render.
    pub(super) threads: usize,
    /// When to stop the render, and how.
    pub(super) deadline: Option<Deadline<'a>>,
    /// Whether somebody waits for the end.
    pub(super) interrupt: &'a Interrupt,
    /// Whether the picture has an alpha channel: the film may sum it for other layers alone.
    pub(super) has_alpha: bool,
}

/// The end of the time that a render may take.
#[derive(Clone)]
pub(super) struct Deadline<'a> {
    pub(super) at: Instant,
    pub(super) cancel: Cancel,
    /// Samples that there must be before: one block of every pixel.
    pub(super) at_least: u64,
    /// Set when the time is up.
    pub(super) is_up: &'a AtomicBool,
}

impl Deadline<'_> {
    /// Minds the time until there is nothing more to end, by a thread of its own: who looks on may hang.
    fn mind_until(&self, ended: &Receiver<()>, told: &Told) {
        let tick = || {
            let left = self.at.saturating_duration_since(Instant::now());
            left.clamp(SHORTEST_TICK, TICK)
        };
        while ended.recv_timeout(tick()) == Err(RecvTimeoutError::Timeout) {
            self.mind(told.samples_done.load(Ordering::Relaxed));
        }
    }

    /// Stops the render, if it is time and it has so many samples.
    pub(super) fn mind(&self, samples: u64) {
        if samples >= self.at_least && Instant::now() >= self.at {
            self.is_up.store(true, Ordering::Relaxed);
            self.cancel.cancel();
        }
    }
}

/// The end of watching, which whoever works may bring about: the pictures are brought up to date once
/// more.
pub(super) struct LastLook<'a> {
    on: Mutex<Option<Looking>>,
    interrupt: &'a Interrupt,
}

/// What holds those who look on, and what they answer.
struct Looking {
    /// Dropped to end them.
    ends: [Sender<()>; 2],
    all_shown: Receiver<()>,
    hang_up: Option<Box<dyn FnOnce() + Send>>,
}

impl LastLook<'_> {
    /// Waits for it; a viewer that does not take its picture is left after a while. Nothing happens where
    /// it has been before.
    pub(super) fn wait(&self) {
        let looking = self.on.lock().ok().and_then(|mut on| on.take());
        let Some(Looking { ends, all_shown, hang_up }) = looking else { return };
        drop(ends);
        let is_asked = self.interrupt.is_asked();
        let patience = if is_asked { PATIENCE_WHEN_STOPPED } else { PATIENCE };
        let waited = all_shown.recv_timeout(patience);
        if let (Err(RecvTimeoutError::Timeout), Some(hang_up)) = (waited, hang_up) {
            hang_up();
        }
    }
}

impl Watch<'_> {
    /// Runs `work` while another thread watches, until the last look, which `work` may have before its own
    /// end.
    pub(super) fn during<T>(mut self, work: impl FnOnce(&LastLook<'_>) -> T) -> T {
        let (end, ended) = mpsc::channel::<()>();
        let (end_of_time, time_ended) = mpsc::channel::<()>();
        let (shown, all_shown) = mpsc::channel::<()>();
        let hang_up = self.shows.tev.as_ref().and_then(Tev::hang_up);
        let hang_up = hang_up.map(|hang_up| Box::new(hang_up) as Box<dyn FnOnce() + Send>);
        let looking = Looking { ends: [end, end_of_time], all_shown, hang_up };
        let last_look = LastLook { on: Mutex::new(Some(looking)), interrupt: self.interrupt };
        let (deadline, told) = (self.deadline.clone(), self.told);
        std::thread::scope(|threads| {
            if let Some(deadline) = deadline {
                threads.spawn(move || deadline.mind_until(&time_ended, told));
            }
            let watch = move || {
                self.run(&ended);
                drop(shown);
            };
            // By its name its share of the time can be measured (benches/record/).
            let watcher = std::thread::Builder::new().name("watch".to_owned());
            if let Err(e) = watcher.spawn_scoped(threads, watch) {
                print::warning(format_args!("nobody can look on: {e}"));
            }
            // Moved here, so that those who look on end where the work panics.
            let last_look = last_look;
            let result = work(&last_look);
            last_look.wait();
            result
        })
    }

    fn run(&mut self, ended: &Receiver<()>) {
        let began = Instant::now();
        let samples_before = self.film.samples();
        let picture = PIXEL.saturating_mul(self.film.frame().pixels() as u32);
        let mut pictures = Turns::new(self.shows.every, FOR_PICTURES, self.threads, picture);
        let mut errors = Turns::new(BETWEEN_ERRORS, FOR_ERRORS, self.threads, ERROR);
        let mut error = None;
        while ended.recv_timeout(TICK) == Err(RecvTimeoutError::Timeout) {
            if self.told.has_ended.load(Ordering::Relaxed) {
                continue; // what it came to is being saved
            }
            pictures.take(|| self.show());
            if self.progress.is_shown() {
                let confidence = self.confidence();
                errors.take(|| error = render::error_so_far(self.film, confidence));
                self.progress.show(&self.state(began, samples_before, error));
            }
        }
        self.progress.finish();
        match self.told.picture.lock().ok().and_then(|mut told| told.take()) {
            Some(picture) => self.shows.update(&picture, self.film.frame()),
            None => self.show(),
        }
    }

    /// Shows the picture so far, if somebody sees it.
    fn show(&mut self) {
        if self.shows.is_empty() || self.film.samples() == 0 {
            return;
        }
        let mut picture = self.film.picture();
        picture.alpha = picture.alpha.filter(|_| self.has_alpha);
        self.shows.update(&picture, self.film.frame());
    }

    fn confidence(&self) -> f64 {
        self.told.last_standing().map_or(CONFIDENCE, |standing| standing.target.confidence)
    }

    fn state(&self, began: Instant, samples_before: u64, error: Option<f64>) -> State {
        let done = self.told.samples_done.load(Ordering::Relaxed).max(samples_before);
        let standing = self.told.last_standing();
        let mut total = match &standing {
            Some(standing) => standing.samples.clone(),
            None => {
                let total = self.told.samples_total.load(Ordering::Relaxed);
                total..total
            }
        };
        let (elapsed, samples) = (began.elapsed(), done - samples_before);
        if let Some(deadline) = &self.deadline {
            let rest = deadline.at.saturating_duration_since(Instant::now());
            let in_time = done + pace::samples_in(rest, samples, elapsed);
            total = pace::total_in_time(&total, in_time, deadline.at_least);
        }
        let left = total.start.saturating_sub(done)..total.end.saturating_sub(done);
        let pace = Pace { elapsed, samples, left };
        // Before the first decisions nobody knows.
        let is_known = standing.as_ref().is_none_or(|standing| standing.worst.is_finite());
        let left = pace.time_left().filter(|_| is_known || self.deadline.is_some());
        State {
            samples_done: done,
            samples_total: total.end,
            rate: pace.rate(),
            error,
            squares: standing.map(|standing| [standing.done, standing.squares]),
            left: left.map(|left| pace::in_words(&left)),
        }
    }
}
