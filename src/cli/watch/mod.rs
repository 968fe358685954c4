//! Viewers of a running render: a preview file, and the viewer tev.
//!
//! One thread serves them. It reads the film as it is and never makes the render wait. Its pictures
//! take less than a fiftieth of the time of all threads, whatever the picture size and
//! `--preview-every`. The final picture is always shown: a very short render has no other.

mod preview;
mod tev;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use crate::error::Result;
use crate::film::FilmFrame;
use crate::image_io::Picture;
use crate::job::{BudgetedTimer, FilePath, OutputSpec, Session, frame_crop};
use crate::overlay::OverlaySpec;

use super::interrupt::Interrupt;
use super::print;

use preview::Preview;
pub(super) use tev::Tev;

/// How long viewers may take for the final picture, after everything is saved.
const PATIENCE: Duration = Duration::from_secs(5);
/// How long viewers may take for the final picture after a stop request, when somebody waits for
/// the program to exit.
const PATIENCE_WHEN_STOPPED: Duration = Duration::from_millis(300);
/// Interval between two checks of the time.
const TICK: Duration = Duration::from_millis(100);
/// The fraction of the time of all threads that pictures may take.
const FOR_PICTURES: f64 = 1.0 / 64.0;
/// Initial estimate of the time per pixel of a picture, deliberately above the measured values. The
/// first picture replaces it by a measurement.
const PIXEL: Duration = Duration::from_nanos(300);

/// The viewers of a render.
pub(super) struct Viewers {
    preview: Option<Preview>,
    tev: Option<Tev>,
    /// Interval between two pictures.
    every: Duration,
}

impl Viewers {
    /// Opens the viewers. `name` is the title of the picture in tev. A resumed render continues
    /// without viewers that cannot be reached.
    ///
    /// # Errors
    /// If the preview cannot be written or tev cannot be reached, unless the render is resumed.
    pub(super) fn new(delivery: &OutputSpec, name: String, is_resumed: bool) -> Result<Self> {
        let preview = delivery.preview.as_ref();
        let preview = preview.map(|FilePath(path)| Preview::new(path, delivery.look));
        let tev = delivery.tev.as_deref().map(|place| Tev::connect(place, name));
        let (preview, tev) = (there(preview, is_resumed)?, there(tev, is_resumed)?);
        Ok(Self { preview, tev, every: delivery.preview_every })
    }

    /// Sets what is drawn over previews.
    pub(super) fn set_overlay(&mut self, overlay: Option<&OverlaySpec>) {
        if let (Some(preview), Some(overlay)) = (&mut self.preview, overlay) {
            preview.set_overlay(Arc::new(overlay.draw()));
        }
    }

    fn is_empty(&self) -> bool {
        self.preview.is_none() && self.tev.is_none()
    }

    /// Sends the picture to all viewers. A viewer that fails is dropped with a warning.
    fn update(&mut self, picture: &Picture, frame: &FilmFrame) {
        if let Some(preview) = &mut self.preview {
            preview.write(picture, frame_crop(frame));
        }
        if let Some(Err(e)) = self.tev.as_mut().map(|tev| tev.show(picture)) {
            print::warning(format_args!("tev no longer accepts the picture: {e}"));
            self.tev = None;
        }
    }

    /// Runs `work` while another thread shows its progress, up to the final update. `work` may
    /// trigger that before it returns.
    pub(super) fn run_alongside<T>(
        mut self,
        session: &Session,
        interrupt: &Interrupt,
        work: impl FnOnce(&FinalUpdate<'_>) -> T,
    ) -> T {
        let (end, ended) = mpsc::channel::<()>();
        let (shown, all_shown) = mpsc::channel::<()>();
        let hang_up = self.tev.as_ref().and_then(Tev::disconnector);
        let hang_up = hang_up.map(|hang_up| Box::new(hang_up) as Box<dyn FnOnce() + Send>);
        let looking = Looking { _end: end, all_shown, hang_up };
        let state = State::default();
        let last_look = FinalUpdate { on: Mutex::new(Some(looking)), state: &state, interrupt };
        std::thread::scope(|threads| {
            let state = &state;
            let watch = move || {
                // A panic here must not lose the render.
                let run = AssertUnwindSafe(|| self.run(session, state, &ended));
                if catch_unwind(run).is_err() {
                    print::warning("showing the picture failed; please report this");
                }
                drop(shown);
            };
            // The name lets benches/record/ measure the thread's share of the time.
            let watcher = std::thread::Builder::new().name("watch".to_owned());
            if let Err(e) = watcher.spawn_scoped(threads, watch) {
                print::warning(format_args!("cannot start the preview thread: {e}"));
            }
            // Moved here, so that a panic of `work` also ends the viewer thread.
            let last_look = last_look;
            let result = work(&last_look);
            last_look.wait();
            result
        })
    }

    fn run(&mut self, session: &Session, state: &State, ended: &Receiver<()>) {
        let frame = *session.film().frame();
        let picture = PIXEL.saturating_mul(frame.pixel_count() as u32);
        let mut pictures = BudgetedTimer::new(self.every, FOR_PICTURES, session.threads(), picture);
        let mut has_shown_first = false;
        while ended.recv_timeout(TICK) == Err(RecvTimeoutError::Timeout) {
            // While the result is being saved, pictures must not take threads away from it.
            if state.is_saving.load(Ordering::Relaxed) {
                continue;
            }
            // The first whole picture is worth more than the time that it takes.
            if !has_shown_first && session.film().sample_count_range().0 > 0 {
                has_shown_first = true;
                pictures.run_now(|| self.show(session));
            } else {
                pictures.run_if_due(|| self.show(session));
            }
        }
        match state.picture.lock().ok().and_then(|mut picture| picture.take()) {
            Some(picture) => self.update(&picture, &frame),
            None => self.show(session),
        }
    }

    /// Shows the current picture if there is a viewer and at least one sample.
    fn show(&mut self, session: &Session) {
        if !self.is_empty() && session.film().sample_count() > 0 {
            self.update(&session.preview(), session.film().frame());
        }
    }
}

/// Returns the viewer. For a resumed render, turns a failure into a warning.
fn there<T>(found: Option<Result<T>>, is_resumed: bool) -> Result<Option<T>> {
    match found {
        Some(Err(e)) if is_resumed => {
            print::warning(format_args!("{e}; continuing without it"));
            Ok(None)
        }
        found => found.transpose(),
    }
}

/// State shared with the viewer thread.
#[derive(Default)]
struct State {
    /// Set when rendering has ended.
    is_saving: AtomicBool,
    /// The final picture, so that it is not computed twice.
    picture: Mutex<Option<Picture>>,
}

/// Ends the viewer thread after one final update. The running work may trigger this early.
pub(super) struct FinalUpdate<'a> {
    on: Mutex<Option<Looking>>,
    state: &'a State,
    interrupt: &'a Interrupt,
}

/// The channels to and from the viewer thread.
struct Looking {
    /// Dropped to end the thread.
    _end: Sender<()>,
    all_shown: Receiver<()>,
    hang_up: Option<Box<dyn FnOnce() + Send>>,
}

impl FinalUpdate<'_> {
    /// Announces that rendering has ended.
    pub(super) fn begin_saving(&self) {
        self.state.is_saving.store(true, Ordering::Relaxed);
    }

    /// Hands over the final picture.
    pub(super) fn set_picture(&self, picture: Picture) {
        if let Ok(mut shown) = self.state.picture.lock() {
            *shown = Some(picture);
        }
    }

    /// Waits for the final update, and disconnects a viewer that takes too long. A second call does
    /// nothing.
    pub(super) fn wait(&self) {
        let looking = self.on.lock().ok().and_then(|mut on| on.take());
        let Some(Looking { _end: end, all_shown, hang_up }) = looking else { return };
        drop(end);
        let is_asked = self.interrupt.is_requested();
        let patience = if is_asked { PATIENCE_WHEN_STOPPED } else { PATIENCE };
        let waited = all_shown.recv_timeout(patience);
        if let (Err(RecvTimeoutError::Timeout), Some(hang_up)) = (waited, hang_up) {
            hang_up();
        }
    }
}
