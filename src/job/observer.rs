//! Callbacks during a render.

use std::ops::{ControlFlow, Range};
use std::time::Duration;

/// Receives reports about a running render, always on the thread that called `run`. `()` ignores
/// all reports.
pub trait Observer {
    /// Returns true if [`Self::on_progress`] should be called. Estimating the error takes a little
    /// time.
    fn wants_progress(&self) -> bool {
        false
    }

    /// Called about ten times per second with the progress. `Break` stops the render as
    /// [`Session::stop`](crate::job::Session::stop) does.
    fn on_progress(&self, _progress: &RenderProgress) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    /// Called with a warning that the user should see at once, for example that a checkpoint cannot
    /// be written.
    fn on_warning(&self, _text: &str) {}
}

impl Observer for () {}

/// The way to the first estimate of the noise, before which the end of a render is not known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstEstimate {
    /// Samples per pixel so far, on average.
    pub samples: f64,
    /// Samples per pixel that it takes.
    pub needed: u32,
    /// The time that a sample of every pixel takes.
    pub time_per_sample: Duration,
    /// The time until then.
    pub time_left: Duration,
}

/// Progress of a render.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderProgress {
    /// Samples so far, including those of earlier runs.
    pub samples_done: u64,
    /// Samples of the whole render; an upper estimate if the total is not known.
    pub samples_total: u64,
    /// Samples per second; 0 before the first sample.
    pub rate: f64,
    /// Error of the picture so far, relative to the brightness of its pixels.
    pub error: Option<f64>,
    /// The largest error of any tile, with a noise target and once every tile has one.
    pub worst_error: Option<f64>,
    /// Number of tiles that meet the noise target, and of all tiles.
    pub tiles_converged: Option<[usize; 2]>,
    /// With a noise target, until tiles have the samples that a first estimate takes: how far they
    /// are.
    pub to_first_estimate: Option<FirstEstimate>,
    /// Lower and upper bound of the remaining time; `None` if unknown.
    pub time_left: Option<Range<Duration>>,
}
