//! Those who look on while a render runs.

use std::ops::Range;
use std::time::Duration;

/// Told of a render while it runs, always on the thread that runs it. `()` does not look on.
pub trait Observer {
    /// Whether [`Self::on_progress`] is wanted: estimating the error takes a little time.
    fn wants_progress(&self) -> bool {
        false
    }

    /// Told about ten times a second how far the render is.
    fn on_progress(&self, _progress: &RenderProgress) {}

    /// Told what the user should know at once, such as that a checkpoint cannot be written.
    fn on_warning(&self, _text: &str) {}
}

impl Observer for () {}

/// How far a render is.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderProgress {
    /// Samples so far, those of earlier runs included.
    pub samples_done: u64,
    /// Samples of the whole render; the most where only an estimate is known.
    pub samples_total: u64,
    /// Samples per second; 0 before the first.
    pub rate: f64,
    /// The error of the picture so far, as a share of the brightness of its pixels.
    pub error: Option<f64>,
    /// Squares that meet the noise target, and all of them.
    pub tiles_converged: Option<[usize; 2]>,
    /// The shortest and the longest time that it may still take; `None` before anything is known.
    pub time_left: Option<Range<Duration>>,
}
