//! Plastic, varnished wood, glazed clay: a matt base under a clear dielectric coat.
//!
//! The coat reflects by Fresnel's equations (see [`super::coat`]). What it lets through the base
//! scatters evenly, and of that a part is thrown back by the coat from inside, scattered again, and
//! so on: with the internal reflectance `r` the base of albedo `a` appears with
//! `a (1 - r) (1 + a r + a^2 r^2 + ...) = a (1 - r) / (1 - a r)` (Saunderson 1942, "Calculation of the
//! Color of Pigmented Plastics"). So colours are deeper than those of the bare base, a white base
//! sends back all light, and light may go both ways.

use crate::color::{Rgb, luminance};
use crate::math::DVec3;
use crate::sampling::Hemisphere;

use super::{BsdfSample, Coat, Lobe};

/// A matt base under a coat.
#[derive(Clone, Debug)]
pub struct Plastic {
    /// The share of light that the base scatters, in `[0, 1]`.
    pub albedo: Rgb,
    /// What covers it.
    pub coat: Coat,
}

/// A matt base under a coat at a point.
#[derive(Clone, Copy, Debug)]
pub struct PlasticBsdf<'a> {
    albedo: Rgb,
    coat: &'a Coat,
}

impl Plastic {
    /// This surface at a point, with a sphere's own colour as its base.
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
        let glossy = self.coat_probability(wo);
        (1.0 - glossy) * Hemisphere::Cosine.pdf(wi.z) + glossy * self.coat.pdf(wo, wi)
    }

    pub(super) fn sample(&self, wo: DVec3, u_lobe: f64, u: [f64; 2]) -> Option<BsdfSample> {
        let glossy = self.coat_probability(wo);
        let (wi, lobe) = if u_lobe < glossy {
            let coat = self.coat.sample(wo, u)?;
            if coat.lobe == Lobe::Delta {
                let weight = coat.weight / glossy as f32;
                return Some(BsdfSample { weight, pdf: glossy, ..coat });
            }
            (coat.wi, coat.lobe)
        } else {
            (Hemisphere::Cosine.sample(u), Lobe::Diffuse)
        };
        let pdf = self.pdf(wo, wi);
        let weight = self.eval(wo, wi) * (wi.z / pdf) as f32;
        (pdf > 0.0).then_some(BsdfSample { wi, weight, pdf, lobe, eta: 1.0 })
    }

    /// The colour of the base as seen through the coat.
    fn base_albedo(&self) -> Rgb {
        let escaping = self.coat.internal_escape() as f32;
        self.albedo * escaping / (Rgb::ONE - self.albedo * (1.0 - escaping))
    }

    /// The probability of sampling the coat.
    fn coat_probability(&self, wo: DVec3) -> f64 {
        let through = self.coat.transmittance(wo.z);
        let base = f64::from(luminance(self.base_albedo())) * through;
        let sum = 1.0 - through + base;
        if sum > 0.0 { (1.0 - through) / sum } else { 0.0 }
    }
}
