//! Runs a render with monitoring. The calling thread handles the time limit, stop requests and the
//! observer; another thread saves the samples periodically. Render threads never wait for either.

use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::time::{Duration, Instant};

use rayon::ThreadPool;

use crate::error::Result;
use crate::image_io::AtomicFile;

use super::budgeted_timer::BudgetedTimer;
use super::observer::Observer;
use super::outcome::{RunOutcome, StopReason};
use super::render_state::RenderState;

/// Grace period for render threads to follow a stop request. The program should exit within two
/// seconds, and saving needs most of that. Abandoning the threads loses only samples in flight.
const STOP_TIMEOUT: Duration = Duration::from_millis(500);
/// Time between two checks; shorter when the time limit is near.
const POLL_INTERVAL: Duration = Duration::from_millis(40);
const MIN_POLL_INTERVAL: Duration = Duration::from_millis(5);
/// Time between two progress reports.
const PROGRESS_INTERVAL: Duration = Duration::from_millis(100);
/// Time between two error estimates.
const ERROR_INTERVAL: Duration = Duration::from_secs(2);
/// Largest share of the time of all threads that error estimates may use.
const ERROR_BUDGET: f64 = 1.0 / 256.0;
/// Cost of an error estimate, assumed until the first is measured.
const ERROR_COST_GUESS: Duration = Duration::from_millis(5);
/// Maximum time before a failed save is retried.
const MAX_RETRY_INTERVAL: Duration = Duration::from_secs(10);

/// Warning text for a panic.
fn panic_warning(what: &str) -> String {
    format!("{what} failed in an unexpected way; please report this")
}

/// Where and how often samples are saved during a render.
#[derive(Clone, Debug)]
pub(super) struct Autosave {
    pub(super) file: AtomicFile,
    pub(super) interval: Duration,
}

/// Renders on the pool while this thread monitors.
pub(super) fn run(
    state: &Arc<RenderState>,
    pool: &ThreadPool,
    autosave: Option<&Autosave>,
    observer: &dyn Observer,
) -> Result<RunOutcome> {
    state.check_time_limit();
    let (end, ended) = mpsc::channel();
    let rendering = Arc::clone(state);
    pool.spawn(move || {
        // A panic ends the render; the samples so far are kept.
        let ended = catch_unwind(AssertUnwindSafe(|| rendering.render()));
        drop(rendering);
        let _ = end.send(ended);
    });
    let (warn, warnings) = mpsc::channel();
    let saver = autosave.map(|autosave| AutosaveThread::start(state, autosave, warn));
    let threads = pool.current_num_threads();
    let ended = wait_for_end(state, &ended, &warnings, threads, saver.as_ref(), observer);
    // Wait for the autosave thread, so that the file is complete before it is written for the last
    // time.
    if let Some(saver) = saver {
        saver.join(observer);
    }
    warnings.try_iter().for_each(|text| observer.on_warning(&text));
    match ended {
        Some(Ok(ended)) => Ok(state.outcome(ended?)),
        Some(Err(_)) => {
            observer.on_warning(&panic_warning("rendering"));
            Ok(RunOutcome { stop_reason: StopReason::Failed, ..state.outcome(false) })
        }
        None => {
            state.is_abandoned.store(true, Ordering::Relaxed);
            Ok(state.outcome(false))
        }
    }
}

type RenderThreadResult = std::thread::Result<Result<bool>>;

/// Waits for the render to end. `None` if the render threads were abandoned.
fn wait_for_end(
    state: &RenderState,
    ended: &Receiver<RenderThreadResult>,
    warnings: &Receiver<String>,
    threads: usize,
    saver: Option<&AutosaveThread>,
    observer: &dyn Observer,
) -> Option<RenderThreadResult> {
    let mut errors = BudgetedTimer::new(ERROR_INTERVAL, ERROR_BUDGET, threads, ERROR_COST_GUESS);
    let (mut error, mut next_words) = (None, Instant::now() + PROGRESS_INTERVAL);
    let mut asked_to_stop = None;
    let mut wants_progress = observer.wants_progress();
    loop {
        let left = state.time_left().unwrap_or(POLL_INTERVAL);
        match ended.recv_timeout(left.clamp(MIN_POLL_INTERVAL, POLL_INTERVAL)) {
            Ok(end) => return Some(end),
            Err(RecvTimeoutError::Disconnected) => return None,
            Err(RecvTimeoutError::Timeout) => {}
        }
        warnings.try_iter().for_each(|text| observer.on_warning(&text));
        state.check_time_limit();
        if state.save_request.take() {
            match saver {
                Some(saver) => saver.save_now(),
                None => observer.on_warning("nothing was saved: the render keeps no checkpoint"),
            }
        }
        if state.should_stop() {
            let since = *asked_to_stop.get_or_insert_with(Instant::now);
            if since.elapsed() >= STOP_TIMEOUT {
                return None;
            }
        } else if wants_progress && Instant::now() >= next_words {
            errors.run_if_due(|| error = state.estimate_error());
            let progress = state.progress(error);
            match catch_unwind(AssertUnwindSafe(|| observer.on_progress(&progress))) {
                Ok(ControlFlow::Continue(())) => {}
                Ok(ControlFlow::Break(())) => state.stop_token().cancel(),
                // A panic in the observer does not end the render.
                Err(_) => {
                    observer.on_warning(&panic_warning("telling the progress"));
                    wants_progress = false;
                }
            }
            next_words = Instant::now() + PROGRESS_INTERVAL;
        }
    }
}

/// The thread that saves samples periodically.
struct AutosaveThread {
    /// Wakes the thread to save at once. Dropping it ends the thread.
    wake: Sender<()>,
    thread: std::io::Result<std::thread::JoinHandle<()>>,
}

impl AutosaveThread {
    fn start(state: &Arc<RenderState>, autosave: &Autosave, warn: Sender<String>) -> Self {
        let (wake, woken) = mpsc::channel();
        let (state, Autosave { file, interval: every }) = (Arc::clone(state), autosave.clone());
        let save = move || {
            autosave_loop(every, &woken, &warn, &file, &|| state.write_checkpoint(&file, None))
        };
        let thread = std::thread::Builder::new().name("autosave".to_owned()).spawn(save);
        Self { wake, thread }
    }

    fn save_now(&self) {
        // If the thread has ended, it has saved for the last time.
        let _ = self.wake.send(());
    }

    /// Ends the thread and waits for it. A failure becomes a warning and does not end the render.
    fn join(self, observer: &dyn Observer) {
        drop(self.wake);
        match self.thread {
            Err(e) => observer.on_warning(&format!("nothing was saved while it rendered: {e}")),
            Ok(thread) => {
                if thread.join().is_err() {
                    observer.on_warning(&panic_warning("saving"));
                }
            }
        }
    }
}

/// Saves at intervals, and when woken, until the sender is dropped. Reports a failure once, until
/// saving works again.
fn autosave_loop(
    every: Duration,
    woken: &Receiver<()>,
    warn: &Sender<String>,
    file: &AtomicFile,
    save: &dyn Fn() -> Result<()>,
) {
    let (mut wait, mut is_failing) = (every, false);
    while woken.recv_timeout(wait) != Err(RecvTimeoutError::Disconnected) {
        let saved = catch_unwind(AssertUnwindSafe(save));
        let name = file.path().display().to_string();
        let failure = match saved {
            Ok(Ok(())) => None,
            Ok(Err(error)) => Some(error.to_string()),
            Err(_) => Some(format!("writing `{name}` failed in an unexpected way")),
        };
        wait = if failure.is_some() { every.min(MAX_RETRY_INTERVAL) } else { every };
        let text = match (&failure, is_failing) {
            (Some(error), false) => {
                Some(format!("{error}; the render goes on and tries again to write `{name}`"))
            }
            (None, true) => Some(format!("can write `{name}` again")),
            _ => None,
        };
        is_failing = failure.is_some();
        // Nobody receives warnings after the render has ended.
        text.into_iter().for_each(|text| drop(warn.send(text)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Error;
    use std::sync::atomic::AtomicUsize;

    #[test]
    fn what_cannot_be_saved_is_told_of_once_and_tried_again_even_after_a_panic() {
        let folder = tempfile::tempdir().unwrap();
        let file = AtomicFile::new(&folder.path().join("a.part")).unwrap();
        let tries = Arc::new(AtomicUsize::new(0));
        let ((end, ended), (warn, warnings)) = (mpsc::channel::<()>(), mpsc::channel());
        let counted = Arc::clone(&tries);
        let saver = std::thread::spawn(move || {
            let save = || match counted.fetch_add(1, Ordering::SeqCst) {
                0..2 => Err(Error::input("no room")),
                2 => panic!("a mistake"),
                _ => Ok(()),
            };
            autosave_loop(Duration::from_millis(1), &ended, &warn, &file, &save);
        });
        while tries.load(Ordering::SeqCst) < 6 {
            std::thread::sleep(Duration::from_millis(1));
        }
        drop(end);
        saver.join().unwrap();
        let texts: Vec<String> = warnings.iter().collect();
        assert_eq!(texts.len(), 2, "{texts:?}");
        assert!(texts[0].starts_with("no room; the render goes on and tries again to write `"));
        assert!(texts[1].starts_with("can write `") && texts[1].ends_with("` again"));
    }
}
