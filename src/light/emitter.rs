//! Emissive spheres.

use crate::color::Rgb;

/// An emissive sphere.
#[derive(Clone, Copy, Debug)]
pub struct Emitter {
    /// The sphere's id.
    pub id: u32,
    /// Emitted radiance.
    pub emission: Rgb,
    /// Fraction of light from the far wall that passes the near one: 1 - opacity. For a dielectric
    /// 1 if it bends no light, else 0, which leaves the far wall to BSDF sampling.
    pub transmittance: f32,
    /// Light from the far wall as a fraction of that from the near one, as expected behind what the
    /// inside absorbs. Only the choice between the walls depends on it.
    pub far_wall_fraction: f32,
}

impl Emitter {
    /// An emitter whose far wall is not seen from outside.
    pub fn opaque(id: u32, emission: Rgb) -> Self {
        Self { id, emission, transmittance: 0.0, far_wall_fraction: 0.0 }
    }
}
