//! What long work has in common: a request to stop it, how far it is, and the threads that help.

mod cancel;
pub(crate) mod hands;
mod progress;

pub use cancel::Cancel;
pub use progress::Progress;
