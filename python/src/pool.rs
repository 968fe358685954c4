//! The threads for work outside renders, which have their own: one pool for each process, made when
//! it is needed first. A forked process has none of the threads of its parent, so it makes new
//! ones.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use photosphere::Error;
use pyo3::prelude::*;
use rayon::ThreadPool;

/// The pool of this process. It is locked only while the GIL is held, so that it is free whenever
/// Python forks.
static POOL: Mutex<Option<Arc<ThreadPool>>> = Mutex::new(None);

/// True in a forked process.
static IS_FORKED: AtomicBool = AtomicBool::new(false);

/// Returns true in a forked process, where rayon's global pool may have no threads.
pub(crate) fn is_forked() -> bool {
    IS_FORKED.load(Ordering::Relaxed)
}

/// Forgets the pool of the parent process. Python calls this in a forked process.
#[pyfunction]
pub(crate) fn after_fork() {
    IS_FORKED.store(true, Ordering::Relaxed);
    let parent = POOL.lock().unwrap_or_else(PoisonError::into_inner).take();
    // Its threads are in the parent: to drop it would wait for them.
    std::mem::forget(parent);
}

/// Runs `work` on the pool without the GIL.
///
/// # Errors
/// If no threads can be started, and the errors of `work`.
pub(crate) fn run<T: Send>(
    py: Python<'_>,
    work: impl FnOnce() -> photosphere::Result<T> + Send,
) -> PyResult<T> {
    let pool = get(py)?;
    py.detach(|| pool.install(work)).map_err(|error| crate::error::raise(py, &error))
}

/// Returns the pool of this process.
///
/// # Errors
/// If no threads can be started.
pub(crate) fn get(py: Python<'_>) -> PyResult<Arc<ThreadPool>> {
    let mut pool = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(pool) = &*pool {
        return Ok(Arc::clone(pool));
    }
    let new = rayon::ThreadPoolBuilder::new().thread_name(|_| "photosphere".to_owned()).build();
    let new = new.map_err(|error| {
        crate::error::raise(py, &Error::input(format!("cannot start the threads: {error}")))
    })?;
    Ok(Arc::clone(pool.insert(Arc::new(new))))
}
