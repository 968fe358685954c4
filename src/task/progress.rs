//! How far something is, told to whoever wants to know.

use std::fmt;
use std::sync::Arc;

/// Whoever wants to know how far something is, such as a build.
#[derive(Clone, Default)]
pub struct ProgressCallback(Option<Arc<dyn Fn(f64) + Send + Sync>>);

impl ProgressCallback {
    /// Calls `listener`, from any thread, with the share that is done.
    pub fn new(listener: impl Fn(f64) + Send + Sync + 'static) -> Self {
        Self(Some(Arc::new(listener)))
    }

    /// Tells the share that is done, in 0 to 1.
    pub fn report(&self, done: f64) {
        if let Some(listener) = &self.0 {
            listener(done);
        }
    }
}

impl fmt::Debug for ProgressCallback {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.0.is_some() { "Progress(listened to)" } else { "Progress(none)" })
    }
}
