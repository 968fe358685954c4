//! A perfect mirror.

use crate::color::Rgb;
use crate::math::DVec3;

use super::{BsdfSample, Lobe};

/// A surface that reflects light in the mirror direction only.
#[derive(Clone, Copy, Debug)]
pub struct Mirror {
    /// The fraction of light that is reflected, in `[0, 1]`.
    pub reflectance: Rgb,
}

impl Mirror {
    /// Returns this mirror with a sphere's own colour, if it has one.
    pub(super) fn with_color(self, reflectance: Option<Rgb>) -> Self {
        Self { reflectance: reflectance.unwrap_or(self.reflectance) }
    }

    /// Returns the mirror direction of `wo`.
    #[inline(always)]
    pub fn reflect(wo: DVec3) -> DVec3 {
        reflect(wo)
    }

    /// Samples the mirror direction; its weight is the reflectance, without cosine or pdf.
    pub(super) fn sample(&self, wo: DVec3) -> BsdfSample {
        BsdfSample {
            wi: reflect(wo),
            weight: self.reflectance,
            pdf: 1.0,
            lobe: Lobe::Delta,
            eta: 1.0,
        }
    }
}

/// Returns the mirror direction of `wo` about the local z axis.
#[inline(always)]
pub(super) fn reflect(wo: DVec3) -> DVec3 {
    DVec3::new(-wo.x, -wo.y, wo.z)
}
