//! A request to save a render while it goes on.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A request to save the samples so far at once, shared between threads.
#[derive(Clone, Debug, Default)]
pub struct SaveRequest(Arc<AtomicBool>);

impl SaveRequest {
    /// Asks the render that holds this to write its checkpoint soon.
    pub fn request(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether somebody asked since the last time.
    pub(super) fn take(&self) -> bool {
        self.0.swap(false, Ordering::Relaxed)
    }
}
