//! A direction sampled from a BSDF.

use crate::color::Rgb;
use crate::math::DVec3;

/// A second pair of random numbers in `[0, 1)`, computed on demand.
pub type ExtraUniforms<'a> = &'a dyn Fn() -> [f64; 2];

/// The kind of a sampled lobe.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lobe {
    /// Spread over the hemisphere.
    Diffuse,
    /// Concentrated around a direction.
    Glossy,
    /// Exactly one direction: `eval` and `pdf` are 0 for it, and light sampling cannot find it.
    Delta,
}

/// A direction sampled from a BSDF.
#[derive(Clone, Copy, Debug)]
pub struct BsdfSample {
    /// The sampled direction, in the local frame; below the surface (`z < 0`) if transmitted.
    pub wi: DVec3,
    /// Throughput factor: `f |cos| / pdf`.
    pub weight: Rgb,
    /// Pdf of `wi`; for a delta lobe, the probability of selecting it.
    pub pdf: f64,
    /// The kind of lobe sampled.
    pub lobe: Lobe,
    /// Index of refraction beyond over that in front if transmitted, else 1.
    pub eta: f64,
}
