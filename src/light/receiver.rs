//! Who gathers light.

use crate::geometry::{Sphere, SurfaceHit};

/// A point that light is gathered at.
#[derive(Clone, Copy, Debug)]
pub struct LightSampleContext {
    /// The point.
    pub hit: SurfaceHit,
    /// Whether light is gathered from both sides of the surface and not only from the side that
    /// [`SurfaceHit::facing_normal`] points to.
    pub is_two_sided: bool,
}

impl LightSampleContext {
    /// Whether a lamp is seen from its inside here, so that light is aimed at its far wall. A
    /// receiver on the lamp itself sees nothing else of it.
    pub fn is_inside(&self, id: u32, lamp: &Sphere) -> bool {
        self.hit.id == id || lamp.contains(self.hit.point)
    }
}
