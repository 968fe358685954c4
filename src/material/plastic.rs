//! Plastic, varnished wood, glazed clay: a diffuse base under a clear dielectric coat.
//!
//! The coat reflects by Fresnel's equations (see [`super::coat`]). The base scatters the
//! transmitted light diffusely; the coat reflects a part of that back internally, it is scattered
//! again, and so on: with the internal reflectance `r` a base of albedo `a` appears with
//! `a (1 - r) (1 + a r + a^2 r^2 + ...) = a (1 - r) / (1 - a r)` (Saunderson 1942, "Calculation of
//! the Color of Pigmented Plastics"). So colours are deeper than those of the bare base, a white
//! base reflects all light, and the BRDF is reciprocal.

use crate::color::{Rgb, luminance};
use crate::math::DVec3;
use crate::sampling::Hemisphere;

use super::{BsdfSample, Coat, Lobe};

/// A diffuse base under a coat.
#[derive(Clone, Debug)]
pub struct Plastic {
    /// The fraction of light that the base scatters, in `[0, 1]`.
    pub albedo: Rgb,
    /// The coat on the base.
    pub coat: Coat,
}

/// A diffuse base under a coat at a point.
#[derive(Clone, Copy, Debug)]
pub struct PlasticBsdf<'a> {
    albedo: Rgb,
    coat: &'a Coat,
}

impl Plastic {
    /// Returns the BSDF at a point; `albedo` is the sphere's own colour, if it has one.
    pub(super) fn bsdf(&self, albedo: Option<Rgb>) -> PlasticBsdf<'_> {
        PlasticBsdf { albedo: albedo.unwrap_or(self.albedo), coat: &self.coat }
    }
}

impl PlasticBsdf<'_> {
    pub(super) fn eval(&self, wo: DVec3, wi: DVec3) -> Rgb {
        if wi.z <= 0.0 {
            return Rgb::ZERO;
        }
        let base = self.base_albedo() * self.coat.eval_base(wo.z, wi.z) as f32;
        base + Rgb::splat(self.coat.eval(wo, wi) as f32)
    }

    pub(super) fn pdf(&self, wo: DVec3, wi: DVec3) -> f64 {
        if wi.z <= 0.0 {
            return 0.0;
        }
        let coat_probability = self.coat_probability(wo);
        (1.0 - coat_probability) * Hemisphere::Cosine.pdf(wi.z)
            + coat_probability * self.coat.pdf(wo, wi)
    }

    pub(super) fn sample(&self, wo: DVec3, u_lobe: f64, u: [f64; 2]) -> Option<BsdfSample> {
        let coat_probability = self.coat_probability(wo);
        let (wi, lobe) = if u_lobe < coat_probability {
            let coat = self.coat.sample(wo, u)?;
            if coat.lobe == Lobe::Delta {
                let weight = coat.weight / coat_probability as f32;
                return Some(BsdfSample { weight, pdf: coat_probability, ..coat });
            }
            (coat.wi, coat.lobe)
        } else {
            (Hemisphere::Cosine.sample(u), Lobe::Diffuse)
        };
        let pdf = self.pdf(wo, wi);
        let weight = self.eval(wo, wi) * (wi.z / pdf) as f32;
        (pdf > 0.0).then_some(BsdfSample { wi, weight, pdf, lobe, eta: 1.0 })
    }

    /// Returns the colour of the base as seen through the coat.
    fn base_albedo(&self) -> Rgb {
        let escape = self.coat.internal_escape() as f32;
        self.albedo * escape / (Rgb::ONE - self.albedo * (1.0 - escape))
    }

    /// Returns the probability of sampling the coat.
    fn coat_probability(&self, wo: DVec3) -> f64 {
        let transmittance = self.coat.transmittance(wo.z);
        let base = f64::from(luminance(self.base_albedo())) * transmittance;
        let sum = 1.0 - transmittance + base;
        if sum > 0.0 { (1.0 - transmittance) / sum } else { 0.0 }
    }
}
