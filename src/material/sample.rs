//! A direction drawn from a BSDF.

use crate::color::Rgb;
use crate::math::DVec3;

/// A second pair of random numbers in `[0, 1)`, made when asked for.
pub type ExtraUniforms<'a> = &'a dyn Fn() -> [f64; 2];

/// How sharply a sampled direction is defined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lobe {
    /// Spread over the hemisphere.
    Diffuse,
    /// Concentrated around a direction.
    Glossy,
    /// Exactly one direction: `eval` and `pdf` are 0 for it, light sampling cannot find it.
    Delta,
}

/// A direction drawn from a BSDF.
#[derive(Clone, Copy, Debug)]
pub struct BsdfSample {
    /// The direction, in the local frame; below the surface (`z < 0`) when it is transmitted.
    pub wi: DVec3,
    /// What the path's throughput is multiplied with: `f |cos| / pdf`.
    pub weight: Rgb,
    /// Density of `wi`; for a delta lobe the probability of having chosen it.
    pub pdf: f64,
    /// Which kind of lobe it came from.
    pub lobe: Lobe,
    /// The index of refraction beyond over the one before where transmitted, else 1.
    pub eta: f64,
}
