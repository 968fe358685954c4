//! Emissive spheres.

use crate::color::Rgb;

/// An emissive sphere.
#[derive(Clone, Copy, Debug)]
pub struct Emitter {
    /// The sphere's id.
    pub id: u32,
    /// Emitted radiance.
    pub emission: Rgb,
    /// Fraction of light from the far wall that passes the near one: 1 - opacity, but 0 for a
    /// dielectric.
    pub transmittance: f32,
}
