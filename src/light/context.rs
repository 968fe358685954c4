//! The shading point of a light sample.

use crate::geometry::{Sphere, SurfaceHit};

/// A shading point that samples lights.
#[derive(Clone, Copy, Debug)]
pub struct LightSampleContext {
    /// The hit point.
    pub hit: SurfaceHit,
    /// True if light from both sides of the surface contributes, not only from the side that
    /// [`SurfaceHit::facing_normal`] points to.
    pub is_two_sided: bool,
    /// True if the surface is Lambertian and samples directions by the cosine. Emitters are then
    /// sampled in proportion to the cosine, too.
    pub is_lambertian: bool,
}

impl LightSampleContext {
    /// Returns true if the shading point is inside the emitter or on its surface. Light sampling
    /// then targets the emitter's inner side.
    #[inline(always)]
    pub fn is_inside(&self, id: u32, emitter: &Sphere) -> bool {
        self.hit.id == id || emitter.contains(self.hit.point)
    }
}
