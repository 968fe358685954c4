//! Everything an integrator needs to trace paths.

use crate::accel::Accel;
use crate::scene::{PreparedScene, Scene};
use crate::task::CancelToken;

/// Everything an integrator needs to trace paths.
#[derive(Clone, Copy)]
pub struct RenderContext<'a> {
    /// The prepared scene.
    pub prepared: &'a PreparedScene,
    /// The scene.
    pub scene: &'a Scene,
    /// An intersector over the scene's spheres.
    pub accel: &'a dyn Accel,
    /// Cancellation token; estimates made after cancellation must be discarded.
    pub cancel: &'a CancelToken,
}

impl<'a> RenderContext<'a> {
    /// Creates a context from a prepared scene and an intersector over its spheres.
    pub fn new(prepared: &'a PreparedScene, accel: &'a dyn Accel, cancel: &'a CancelToken) -> Self {
        Self { prepared, scene: prepared.scene(), accel, cancel }
    }
}
