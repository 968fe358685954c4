//! Threads for Embree's build, which TBB starts: it ends the process if one cannot start.

use std::io;
use std::num::NonZero;
use std::sync::{Mutex, PoisonError};
use std::thread;

use crate::error::{Error, Result, Suggestion};

/// Fails if the system denies this process so many more threads now; 0 means one per core.
pub(super) fn check(threads: usize) -> Result<()> {
    let all = || thread::available_parallelism().map_or(1, NonZero::get);
    let threads = if threads == 0 { all() } else { threads };
    start(threads).map_err(|e| {
        Error::input(format!("cannot start {threads} threads for Embree: {e}"))
            .with_help("use fewer threads, or raise the limits of the system (ulimit -a)")
            .with_suggestion(Suggestion::Threads, "")
    })
}

/// Starts so many threads, and ends them.
fn start(threads: usize) -> io::Result<()> {
    let gate = Mutex::new(());
    thread::scope(|scope| {
        // No thread ends before all have started.
        let _closed = gate.lock().unwrap_or_else(PoisonError::into_inner);
        let wait = || drop(gate.lock());
        (0..threads).try_for_each(|_| thread::Builder::new().spawn_scoped(scope, wait).map(drop))
    })
}
