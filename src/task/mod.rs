//! What long work has in common: a request to stop it, how far it is, and the threads that help.

mod cancel;
pub(crate) mod parallel;
mod progress;

pub use cancel::CancelToken;
pub use progress::ProgressCallback;
