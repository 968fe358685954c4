//! Those who look on while a scene is rendered: a preview file, the viewer tev.
//!
//! One thread serves them. It reads the film as it is and never makes the render wait. What it
//! spends on pictures is held below a fiftieth of the time of all threads, however large the
//! picture and however short the wish of `--preview-every`. The picture at the end is always shown:
//! a render that is over sooner than that pays for it has no other.

mod preview;
mod tev;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::time::Duration;

use crate::error::Result;
use crate::film::FilmFrame;
use crate::image_io::Picture;
use crate::job::{BudgetedTimer, FilePath, OutputSpec, Session, frame_crop};

use super::interrupt::Interrupt;
use super::print;

use preview::Preview;
use tev::Tev;

/// How long those who look on may take for the last picture, when all is saved.
const PATIENCE: Duration = Duration::from_secs(5);
/// How long viewers may take for the last picture if a signal asked to stop.
const PATIENCE_WHEN_STOPPED: Duration = Duration::from_millis(300);
/// Between two looks at the clock.
const TICK: Duration = Duration::from_millis(100);
/// The share of the time of all threads that pictures may take.
const FOR_PICTURES: f64 = 1.0 / 64.0;
/// What a pixel of a picture takes: known better after the first, so on the safe side of what was
/// measured.
const PIXEL: Duration = Duration::from_nanos(300);

/// Where the picture so far is to be seen.
pub(super) struct Viewers {
    preview: Option<Preview>,
    tev: Option<Tev>,
    /// Between two pictures.
    every: Duration,
}

impl Viewers {
    /// `name` is what the picture is called elsewhere. A render that is resumed goes on without
    /// those who have gone away since.
    ///
    /// # Errors
    /// When the preview cannot be written, or tev cannot be reached, and it is not resumed.
    pub(super) fn new(delivery: &OutputSpec, name: String, is_resumed: bool) -> Result<Self> {
        let preview = delivery.preview.as_ref();
        let preview = preview.map(|FilePath(path)| Preview::new(path, delivery.look));
        let tev = delivery.tev.as_deref().map(|place| Tev::connect(place, name));
        let (preview, tev) = (there(preview, is_resumed)?, there(tev, is_resumed)?);
        Ok(Self { preview, tev, every: delivery.preview_every })
    }

    fn is_empty(&self) -> bool {
        self.preview.is_none() && self.tev.is_none()
    }

    /// Brings the pictures up to date. Who cannot be reached any more is told of once.
    fn update(&mut self, picture: &Picture, frame: &FilmFrame) {
        if let Some(preview) = &mut self.preview {
            preview.write(picture, frame_crop(frame));
        }
        if let Some(Err(e)) = self.tev.as_mut().map(|tev| tev.show(picture)) {
            print::warning(format_args!("tev does not take the picture any more: {e}"));
            self.tev = None;
        }
    }

    /// Runs `work` while another thread shows what it comes to, until the last look, which `work`
    /// may have before its own end.
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
                // Whatever goes wrong here, the render is not lost.
                let run = AssertUnwindSafe(|| self.run(session, state, &ended));
                if catch_unwind(run).is_err() {
                    print::warning("showing the picture failed; please report this");
                }
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

    fn run(&mut self, session: &Session, state: &State, ended: &Receiver<()>) {
        let frame = *session.film().frame();
        let picture = PIXEL.saturating_mul(frame.pixel_count() as u32);
        let mut pictures = BudgetedTimer::new(self.every, FOR_PICTURES, session.threads(), picture);
        while ended.recv_timeout(TICK) == Err(RecvTimeoutError::Timeout) {
            // While what it came to is being saved, nobody takes a thread away.
            if !state.is_saving.load(Ordering::Relaxed) {
                pictures.run_if_due(|| self.show(session));
            }
        }
        match state.picture.lock().ok().and_then(|mut picture| picture.take()) {
            Some(picture) => self.update(&picture, &frame),
            None => self.show(session),
        }
    }

    /// Shows the picture so far, if somebody sees it.
    fn show(&mut self, session: &Session) {
        if !self.is_empty() && session.film().sample_count() > 0 {
            self.update(&session.preview(), session.film().frame());
        }
    }
}

/// Who is there to look on.
fn there<T>(found: Option<Result<T>>, is_resumed: bool) -> Result<Option<T>> {
    match found {
        Some(Err(e)) if is_resumed => {
            print::warning(format_args!("{e}; the render goes on without it"));
            Ok(None)
        }
        found => found.transpose(),
    }
}

/// What those who look on are told.
#[derive(Default)]
struct State {
    /// Set when nothing more is rendered.
    is_saving: AtomicBool,
    /// The picture that it came to: so nobody needs to make it again.
    picture: Mutex<Option<Picture>>,
}

/// The end of watching, which whoever works may bring about: the pictures are brought up to date
/// once more.
pub(super) struct FinalUpdate<'a> {
    on: Mutex<Option<Looking>>,
    state: &'a State,
    interrupt: &'a Interrupt,
}

/// What holds those who look on, and what they answer.
struct Looking {
    /// Dropped to end them.
    _end: Sender<()>,
    all_shown: Receiver<()>,
    hang_up: Option<Box<dyn FnOnce() + Send>>,
}

impl FinalUpdate<'_> {
    /// Nothing more is rendered from now on.
    pub(super) fn begin_saving(&self) {
        self.state.is_saving.store(true, Ordering::Relaxed);
    }

    /// The picture that it came to.
    pub(super) fn set_picture(&self, picture: Picture) {
        if let Ok(mut shown) = self.state.picture.lock() {
            *shown = Some(picture);
        }
    }

    /// Waits for the last look; a viewer that does not take its picture is left after a while.
    /// Nothing happens where it has been before.
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
