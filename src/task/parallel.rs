//! Parallel helpers for whole-film and whole-picture operations.
//!
//! On a rayon pool thread, all threads of the pool take part; that is the case when a render
//! finishes. On any other thread, such as a monitor during a render, the work runs serially and
//! does not take threads from the render.

use rayon::prelude::*;

/// Maps all items, in order.
pub(crate) fn map<T: Send, R: Send>(all: Vec<T>, of: impl Fn(T) -> R + Send + Sync) -> Vec<R> {
    match rayon::current_thread_index() {
        Some(_) => all.into_par_iter().map(of).collect(),
        None => all.into_iter().map(of).collect(),
    }
}

/// Number of threads that take part.
pub(crate) fn thread_count() -> usize {
    rayon::current_thread_index().map_or(1, |_| rayon::current_num_threads())
}

/// Runs both closures, in parallel on a pool thread.
pub(crate) fn join<A: Send, B: Send>(
    first: impl FnOnce() -> A + Send,
    second: impl FnOnce() -> B + Send,
) -> (A, B) {
    match rayon::current_thread_index() {
        Some(_) => rayon::join(first, second),
        None => {
            let first = first();
            (first, second())
        }
    }
}
