//! Support for long-running operations: cancellation, progress and parallel helpers.

mod cancel;
pub(crate) mod parallel;
mod progress;

pub use cancel::CancelToken;
pub use progress::ProgressCallback;
