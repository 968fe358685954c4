//! How many hands there are for what is done to something as a whole, such as a film or a picture.
//!
//! On a thread of a pool all of its threads help: that is so where a render has come to its end. Any other
//! thread, such as one that looks on while a render is at work, does it alone and takes nobody away.

use rayon::prelude::*;

/// What comes of each, in order.
pub(crate) fn map<T: Send, R: Send>(all: Vec<T>, of: impl Fn(T) -> R + Send + Sync) -> Vec<R> {
    match rayon::current_thread_index() {
        Some(_) => all.into_par_iter().map(of).collect(),
        None => all.into_iter().map(of).collect(),
    }
}

/// How many there are.
pub(crate) fn thread_count() -> usize {
    rayon::current_thread_index().map_or(1, |_| rayon::current_num_threads())
}

/// Does both, at once where there are hands for it.
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
