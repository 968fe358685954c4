//! What there is to be seen.

use crate::accel::Accel;
use crate::scene::{PreparedScene, Scene};
use crate::task::CancelToken;

/// What there is to be seen.
#[derive(Clone, Copy)]
pub struct RenderContext<'a> {
    /// The scene as the picture has it.
    pub shot: &'a PreparedScene,
    /// The scene.
    pub scene: &'a Scene,
    /// An intersector over the scene's spheres.
    pub accel: &'a dyn Accel,
    /// Set from elsewhere to stop early; what is estimated then is to be thrown away.
    pub cancel: &'a CancelToken,
}

impl<'a> RenderContext<'a> {
    /// A shot, with an intersector over its spheres.
    pub fn new(shot: &'a PreparedScene, accel: &'a dyn Accel, cancel: &'a CancelToken) -> Self {
        Self { shot, scene: shot.scene(), accel, cancel }
    }
}
