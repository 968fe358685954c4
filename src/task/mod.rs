//! Support for long-running operations: cancellation, progress, free memory and parallel helpers.

mod cancel;
mod memory;
pub mod memory_limits;
#[allow(unsafe_code, reason = "advises the system about memory")]
pub(crate) mod pages;
pub(crate) mod parallel;
mod progress;

pub use cancel::CancelToken;
pub use memory::{available_memory, peak_memory, total_memory};
pub use progress::ProgressCallback;
