//! Those who look on while a render runs.

use std::ops::Range;
use std::time::Duration;

use super::pace::{self, Pace};
use super::session::Work;

/// Told of a render while it runs, always on the thread that runs it. `()` does not look on.
pub trait Observer {
    /// Whether [`Self::progress`] is wanted: estimating the error takes a little time.
    fn wants_progress(&self) -> bool {
        false
    }

    /// Told about ten times a second how far the render is.
    fn progress(&self, _progress: &Progress) {}

    /// Told what the user should know at once, such as that a checkpoint cannot be written.
    fn warning(&self, _text: &str) {}
}

impl Observer for () {}

/// How far a render is.
#[derive(Clone, Debug, PartialEq)]
pub struct Progress {
    /// Samples so far, those of earlier runs included.
    pub samples_done: u64,
    /// Samples of the whole render; the most where only an estimate is known.
    pub samples_total: u64,
    /// Samples per second; 0 before the first.
    pub rate: f64,
    /// The error of the picture so far, as a share of the brightness of its pixels.
    pub error: Option<f64>,
    /// Squares that meet the noise target, and all of them.
    pub squares: Option<[usize; 2]>,
    /// The shortest and the longest time that it may still take; `None` before anything is known.
    pub left: Option<Range<Duration>>,
}

impl Work {
    /// How far it is; `error` is the last estimate of the error.
    pub(super) fn progress(&self, error: Option<f64>) -> Progress {
        let done = self.counters.samples_done().max(self.samples_before);
        let standing = self.standing();
        let mut total = match &standing {
            Some(standing) => standing.samples.clone(),
            None => {
                let total = self.counters.samples_total();
                total..total
            }
        };
        let (elapsed, samples) = (self.elapsed(), done - self.samples_before);
        let rest = self.time_left();
        if let Some(rest) = rest {
            let in_time = done + pace::samples_in(rest, samples, elapsed);
            total = pace::total_in_time(&total, in_time, self.samples_at_least());
        }
        let left = total.start.saturating_sub(done)..total.end.saturating_sub(done);
        let pace = Pace { elapsed, samples, left };
        // Before the first decisions nobody knows.
        let is_known = standing.as_ref().is_none_or(|standing| standing.worst.is_finite());
        Progress {
            samples_done: done,
            samples_total: total.end,
            rate: pace.rate(),
            error,
            squares: standing.map(|standing| [standing.done, standing.squares]),
            left: pace.time_left().filter(|_| is_known || rest.is_some()),
        }
    }
}
