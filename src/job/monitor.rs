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
/// Maximum fraction of the time of all threads that error estimates may use.
const ERROR_BUDGET: f64 = 1.0 / 256.0;
/// Cost of an error estimate, assumed until the first is measured.
const ERROR_COST_GUESS: Duration = Duration::from_millis(5);
/// Maximum time before a failed save is retried.
const MAX_RETRY_INTERVAL: Duration = Duration::from_secs(10);

/// Warning text for a panic.
fn panic_warning(activity: &str) -> String {
    format!("{activity} failed in an unexpected way; please report this")
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
    let (sender, receiver) = mpsc::channel();
    let rendering = Arc::clone(state);
    pool.spawn(move || {
        // A panic ends the render; the samples so far are kept.
        let result = catch_unwind(AssertUnwindSafe(|| rendering.render()));
        drop(rendering);
        let _ = sender.send(result);
    });
    let (warn, warnings) = mpsc::channel();
    let saver = autosave.map(|autosave| AutosaveThread::start(state, autosave, warn));
    let threads = pool.current_num_threads();
    let result = wait_for_end(state, &receiver, &warnings, threads, saver.as_ref(), observer);
    // Wait for the autosave thread, so that the file is complete before it is written for the last
    // time.
    if let Some(saver) = saver {
        saver.join(observer);
    }
    warnings.try_iter().for_each(|message| observer.on_warning(&message));
    match result {
        Some(Ok(result)) => Ok(state.outcome(result?)),
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
    receiver: &Receiver<RenderThreadResult>,
    warnings: &Receiver<String>,
    threads: usize,
    saver: Option<&AutosaveThread>,
    observer: &dyn Observer,
) -> Option<RenderThreadResult> {
    let mut error_timer =
        BudgetedTimer::new(ERROR_INTERVAL, ERROR_BUDGET, threads, ERROR_COST_GUESS);
    let (mut error, mut next_report) = (None, Instant::now() + PROGRESS_INTERVAL);
    let mut stop_requested = None;
    let mut wants_progress = observer.wants_progress();
    loop {
        let time_left = state.time_left().unwrap_or(POLL_INTERVAL);
        match receiver.recv_timeout(time_left.clamp(MIN_POLL_INTERVAL, POLL_INTERVAL)) {
            Ok(result) => return Some(result),
            Err(RecvTimeoutError::Disconnected) => return None,
            Err(RecvTimeoutError::Timeout) => {}
        }
        warnings.try_iter().for_each(|message| observer.on_warning(&message));
        state.check_time_limit();
        if state.save_request.take() {
            match saver {
                Some(saver) => saver.save_now(),
                None => observer.on_warning("nothing was saved: the render has no checkpoint"),
            }
        }
        if state.should_stop() {
            let since = *stop_requested.get_or_insert_with(Instant::now);
            if since.elapsed() >= STOP_TIMEOUT {
                return None;
            }
        } else if wants_progress && Instant::now() >= next_report {
            error_timer.run_if_due(|| error = state.estimate_error());
            let progress = state.progress(error);
            match catch_unwind(AssertUnwindSafe(|| observer.on_progress(&progress))) {
                Ok(ControlFlow::Continue(())) => {}
                Ok(ControlFlow::Break(())) => state.stop_token().cancel(),
                // A panic in the observer does not end the render.
                Err(_) => {
                    observer.on_warning(&panic_warning("reporting the progress"));
                    wants_progress = false;
                }
            }
            next_report = Instant::now() + PROGRESS_INTERVAL;
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
        let (wake, wakeups) = mpsc::channel();
        let (state, Autosave { file, interval }) = (Arc::clone(state), autosave.clone());
        let save = move || {
            autosave_loop(interval, &wakeups, &warn, &file, &|| state.write_checkpoint(&file, None))
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
            Err(e) => observer.on_warning(&format!("nothing was saved during the render: {e}")),
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
    interval: Duration,
    wakeups: &Receiver<()>,
    warn: &Sender<String>,
    file: &AtomicFile,
    save: &dyn Fn() -> Result<()>,
) {
    let (mut wait, mut is_failing) = (interval, false);
    while wakeups.recv_timeout(wait) != Err(RecvTimeoutError::Disconnected) {
        let saved = catch_unwind(AssertUnwindSafe(save));
        let name = file.path().display().to_string();
        let failure = match saved {
            Ok(Ok(())) => None,
            Ok(Err(error)) => Some(error.to_string()),
            Err(_) => Some(format!("writing `{name}` failed in an unexpected way")),
        };
        wait = if failure.is_some() { interval.min(MAX_RETRY_INTERVAL) } else { interval };
        let message = match (&failure, is_failing) {
            (Some(error), false) => {
                Some(format!("{error}; the render continues and retries `{name}`"))
            }
            (None, true) => Some(format!("writing `{name}` works again")),
            _ => None,
        };
        is_failing = failure.is_some();
        // Nobody receives warnings after the render has ended.
        message.into_iter().for_each(|message| drop(warn.send(message)));
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
        let ((sender, wakeups), (warn, warnings)) = (mpsc::channel::<()>(), mpsc::channel());
        let counted = Arc::clone(&tries);
        let saver = std::thread::spawn(move || {
            let save = || match counted.fetch_add(1, Ordering::SeqCst) {
                0..2 => Err(Error::input("no room")),
                2 => panic!("a mistake"),
                _ => Ok(()),
            };
            autosave_loop(Duration::from_millis(1), &wakeups, &warn, &file, &save);
        });
        while tries.load(Ordering::SeqCst) < 6 {
            std::thread::sleep(Duration::from_millis(1));
        }
        drop(sender);
        saver.join().unwrap();
        let messages: Vec<String> = warnings.iter().collect();
        assert_eq!(messages.len(), 2, "{messages:?}");
        assert!(messages[0].starts_with("no room; the render continues and retries `"));
        assert!(messages[1].starts_with("writing `") && messages[1].ends_with("` works again"));
    }
}
