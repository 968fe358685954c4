//! The shading point of a light sample.

use crate::geometry::{Sphere, SurfaceHit};

/// A shading point that samples lights.
#[derive(Clone, Copy, Debug)]
pub struct LightSampleContext {
    /// The hit point.
    pub hit: SurfaceHit,
    /// True if light is gathered from both sides of the surface and not only from the side that
    /// [`SurfaceHit::facing_normal`] points to.
    pub is_two_sided: bool,
}

impl LightSampleContext {
    /// Returns true if the emitter is seen from its inside here, so that its far wall is sampled. A
    /// shading point on the emitter itself sees nothing else of it.
    pub fn is_inside(&self, id: u32, emitter: &Sphere) -> bool {
        self.hit.id == id || emitter.contains(self.hit.point)
    }
}
