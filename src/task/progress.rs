//! Progress reports.

use std::fmt;
use std::sync::Arc;

/// An optional callback that receives the progress of an operation, such as a build.
#[derive(Clone, Default)]
pub struct ProgressCallback(Option<Arc<dyn Fn(f64) + Send + Sync>>);

impl ProgressCallback {
    /// Creates a callback. `listener` is called from any thread with the fraction done, in [0, 1].
    pub fn new(listener: impl Fn(f64) + Send + Sync + 'static) -> Self {
        Self(Some(Arc::new(listener)))
    }

    /// Reports the fraction done, in [0, 1].
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
