//! What is done beside a render, at intervals, by a thread of its own: threads that render never wait
//! for it.
//!
//! The same thread sees to it that a request to stop is followed soon: where the threads that render are
//! stuck in a long batch, it saves what there is and ends the program without them.

use std::sync::{Condvar, Mutex, PoisonError};
use std::time::{Duration, Instant};

use crate::accel::Cancel;
use crate::error::Result;

/// Something to be done again and again.
pub(super) struct Chore<'a> {
    /// Completes "cannot ...".
    pub(super) what: String,
    pub(super) every: Duration,
    pub(super) work: Box<dyn FnMut() -> Result<()> + Send + 'a>,
}

/// What the thread that keeps is told.
pub(super) struct Orders<'a> {
    pub(super) chores: Vec<Chore<'a>>,
    /// A request to stop.
    pub(super) cancel: &'a Cancel,
    /// Says a warning.
    pub(super) warn: &'a (dyn Fn(String) + Sync),
    /// Saves what there is and ends the program; called where a request to stop is not followed.
    pub(super) give_up: &'a (dyn Fn() + Sync),
}

/// How long the threads that render may take to follow a request to stop: most of the two seconds in which
/// a program should be gone are for saving. Nothing is lost with them but what is in flight.
const PATIENCE: Duration = Duration::from_millis(500);

/// How often the clock is looked at.
const TICK: Duration = Duration::from_millis(40);

/// What failed is tried again no later than this.
const LONGEST_RETRY: Duration = Duration::from_secs(10);

/// Does `work` with the chores beside it.
pub(super) fn beside<T>(orders: Orders<'_>, work: impl FnOnce() -> T) -> T {
    let done = Signal::default();
    std::thread::scope(|scope| {
        scope.spawn(|| keep(orders, &done));
        let ring = RingOnDrop(&done);
        let outcome = work();
        drop(ring);
        outcome
    })
}

fn keep(mut orders: Orders<'_>, done: &Signal) {
    let now = Instant::now();
    let mut states: Vec<State> = orders
        .chores
        .iter()
        .map(|chore| State { due: now + chore.every, has_failed: false })
        .collect();
    let mut asked_to_stop = None;
    while !done.wait(TICK) {
        if orders.cancel.is_cancelled() {
            // No chores any more: everything is about to be saved.
            let since = *asked_to_stop.get_or_insert_with(Instant::now);
            if since.elapsed() >= PATIENCE {
                (orders.give_up)();
                return;
            }
            continue;
        }
        for (chore, state) in orders.chores.iter_mut().zip(&mut states) {
            if Instant::now() >= state.due {
                state.do_it(chore, orders.warn);
            }
        }
    }
}

/// How a chore went last time, and when it is due again.
struct State {
    due: Instant,
    has_failed: bool,
}

impl State {
    fn do_it(&mut self, chore: &mut Chore<'_>, warn: &(dyn Fn(String) + Sync)) {
        let outcome = (chore.work)();
        let mut wait = chore.every;
        match outcome {
            Ok(()) if self.has_failed => warn(format!("can {} again", chore.what)),
            Ok(()) => {}
            Err(error) => {
                wait = wait.min(LONGEST_RETRY);
                // Once is enough, until it works again.
                if !self.has_failed {
                    let what = &chore.what;
                    warn(format!("{error}; the render goes on and tries again to {what}"));
                }
                self.has_failed = true;
                self.due = Instant::now() + wait;
                return;
            }
        }
        self.has_failed = false;
        self.due = Instant::now() + wait;
    }
}

/// Whether the work is done.
#[derive(Default)]
struct Signal {
    done: Mutex<bool>,
    bell: Condvar,
}

impl Signal {
    /// Waits until the work is done, but not longer than this; returns whether it is.
    fn wait(&self, longest: Duration) -> bool {
        let done = self.done.lock().unwrap_or_else(PoisonError::into_inner);
        let waited = self.bell.wait_timeout_while(done, longest, |done| !*done);
        *waited.unwrap_or_else(PoisonError::into_inner).0
    }
}

/// Tells that the work is done, also where it panicked: the scope waits for the other thread.
struct RingOnDrop<'a>(&'a Signal);

impl Drop for RingOnDrop<'_> {
    fn drop(&mut self) {
        *self.0.done.lock().unwrap_or_else(PoisonError::into_inner) = true;
        self.0.bell.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Error;
    use std::sync::atomic::{AtomicUsize, Ordering};

    fn wait_for(condition: impl Fn() -> bool) {
        while !condition() {
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    #[test]
    fn chores_that_fail_are_warned_of_once_and_tried_again() {
        let (tries, warnings) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
        let work = || match tries.fetch_add(1, Ordering::SeqCst) {
            0..3 => Err(Error::input("no room")),
            _ => Ok(()),
        };
        let chore = Chore {
            what: "write".to_owned(),
            every: Duration::from_millis(1),
            work: Box::new(work),
        };
        let orders = Orders {
            chores: vec![chore],
            cancel: &Cancel::default(),
            warn: &|text| warnings.lock().unwrap().push(text),
            give_up: &|| panic!("nobody asked to stop"),
        };
        assert_eq!(beside(orders, || wait_for(|| tries.load(Ordering::SeqCst) >= 6)), ());
        let expected = ["no room; the render goes on and tries again to write", "can write again"];
        assert_eq!(*warnings.lock().unwrap(), expected);
    }

    #[test]
    fn a_request_that_nobody_follows_ends_in_giving_up() {
        let (cancel, given_up) = (Cancel::default(), AtomicUsize::new(0));
        let give_up = || {
            given_up.fetch_add(1, Ordering::SeqCst);
        };
        let orders =
            Orders { chores: Vec::new(), cancel: &cancel, warn: &|_| {}, give_up: &give_up };
        cancel.cancel();
        beside(orders, || wait_for(|| given_up.load(Ordering::SeqCst) > 0));
        assert_eq!(given_up.load(Ordering::SeqCst), 1);
    }
}
