//! What there is to be seen.

use crate::accel::Accel;
use crate::scene::{Scene, Shot};
use crate::task::Cancel;

/// What there is to be seen.
#[derive(Clone, Copy)]
pub struct World<'a> {
    /// The scene as the picture has it.
    pub shot: &'a Shot,
    /// The scene.
    pub scene: &'a Scene,
    /// An intersector over the scene's spheres.
    pub accel: &'a dyn Accel,
    /// Set from elsewhere to stop early; what is estimated then is to be thrown away.
    pub cancel: &'a Cancel,
}

impl<'a> World<'a> {
    /// A shot, with an intersector over its spheres.
    pub fn new(shot: &'a Shot, accel: &'a dyn Accel, cancel: &'a Cancel) -> Self {
        Self { shot, scene: shot.scene(), accel, cancel }
    }
}
