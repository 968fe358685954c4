//! The threads for work outside renders, which have their own: one pool for each process, made when
//! it is needed first.

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use photosphere::{Error, Result};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rayon::ThreadPool;

use crate::error;

/// How often a wait looks for signals such as Ctrl-C.
pub(crate) const SIGNAL_INTERVAL: Duration = Duration::from_millis(50);

/// The pool, and the process that made it: a forked process has none of the threads of its parent.
/// It is locked only while the GIL is held, so that it is free whenever Python forks.
static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// Runs `work` on the pool without the GIL. For what takes a moment: signals wait for its end.
///
/// # Errors
/// If no threads can be started, and the errors of `work`.
pub(crate) fn run<T: Send>(py: Python<'_>, work: impl FnOnce() -> Result<T> + Send) -> PyResult<T> {
    let pool = get(py)?;
    py.detach(|| pool.install(work)).map_err(|error| error::raise(py, &error))
}

/// Runs `work` on the pool without the GIL. The exception of a signal handler ends the wait; the
/// pool finishes the work, and nobody gets the result.
///
/// # Errors
/// If no threads can be started, the errors of `work`, and exceptions of signal handlers.
pub(crate) fn run_interruptible<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce() -> Result<T> + Send + 'static,
) -> PyResult<T> {
    let (sender, mut receiver) = mpsc::channel();
    get(py)?.spawn(move || {
        let done = catch_unwind(AssertUnwindSafe(work));
        // Nobody receives it after an interrupt.
        let _ = sender.send(done);
    });
    loop {
        py.check_signals()?;
        let received;
        (receiver, received) = py.detach(move || {
            let received = receiver.recv_timeout(SIGNAL_INTERVAL);
            (receiver, received)
        });
        match received {
            Ok(Ok(done)) => return done.map_err(|error| error::raise(py, &error)),
            Ok(Err(panic)) => resume_unwind(panic),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => {
                return Err(PyRuntimeError::new_err("the threads of photosphere have ended"));
            }
        }
    }
}

/// Returns the pool of this process.
///
/// # Errors
/// If no threads can be started.
pub(crate) fn get(py: Python<'_>) -> PyResult<Arc<ThreadPool>> {
    let process = std::process::id();
    let mut pool = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((_, pool)) = pool.as_ref().filter(|(owner, _)| *owner == process) {
        return Ok(Arc::clone(pool));
    }
    let new = rayon::ThreadPoolBuilder::new().thread_name(|_| "photosphere".to_owned()).build();
    let new = new.map_err(|error| {
        error::raise(py, &Error::input(format!("cannot start the threads: {error}")))
    })?;
    let new = Arc::new(new);
    // The parent's threads are not here, and its locks may be held: nothing of it can be dropped.
    std::mem::forget(pool.replace((process, Arc::clone(&new))));
    Ok(new)
}
