//! Requests to save a running render.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A request to save the samples so far, shared between threads.
#[derive(Clone, Debug, Default)]
pub struct SaveRequest(Arc<AtomicBool>);

impl SaveRequest {
    /// Requests that the render write its checkpoint soon.
    pub fn request(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Returns true if a save was requested since the last call.
    pub(super) fn take(&self) -> bool {
        self.0.swap(false, Ordering::Relaxed)
    }
}
