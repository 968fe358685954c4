//! Lambertian reflection: the same radiance in all directions.

use std::f32::consts::FRAC_1_PI;

use crate::color::Rgb;
use crate::fault::fault;
use crate::math::DVec3;
use crate::sampling::Hemisphere;

use super::{BsdfSample, Lobe};

/// A Lambertian diffuse surface.
#[derive(Clone, Copy, Debug)]
pub struct Diffuse {
    /// The fraction of light that is scattered, in `[0, 1]`.
    pub albedo: Rgb,
}

/// Returns the pdf of [`Diffuse::sample`].
#[inline(always)]
pub(super) fn pdf(hemisphere: Hemisphere, wi: DVec3) -> f64 {
    if wi.z > 0.0 { hemisphere.pdf(wi.z) } else { 0.0 }
}

impl Diffuse {
    /// Returns this surface with a sphere's own colour, if it has one.
    pub fn with_color(self, albedo: Option<Rgb>) -> Self {
        Self { albedo: albedo.unwrap_or(self.albedo) }
    }

    /// Evaluates the BRDF.
    #[inline(always)]
    pub fn eval(&self, wi: DVec3) -> Rgb {
        let norm = if fault!(LambertWithoutPi) { 1.0 } else { FRAC_1_PI };
        if wi.z > 0.0 { self.albedo * norm } else { Rgb::ZERO }
    }

    /// Samples a cosine-weighted direction, from `u` in `[0, 1)`, and returns it with its pdf.
    #[inline(always)]
    pub fn sample_cosine(u: [f64; 2]) -> (DVec3, f64) {
        let wi = Hemisphere::Cosine.sample(u);
        (wi, Self::pdf_cosine(wi))
    }

    /// Returns the pdf of [`Self::sample_cosine`].
    #[inline(always)]
    pub fn pdf_cosine(wi: DVec3) -> f64 {
        pdf(Hemisphere::Cosine, wi)
    }

    /// Samples a direction over the hemisphere. With cosine sampling the weight is the albedo
    /// itself.
    pub(super) fn sample(&self, hemisphere: Hemisphere, u: [f64; 2]) -> Option<BsdfSample> {
        let wi = hemisphere.sample(u);
        let pdf = pdf(hemisphere, wi);
        let weight = match hemisphere {
            Hemisphere::Cosine if fault!(CosineTwice) => self.albedo * wi.z as f32,
            Hemisphere::Cosine => self.albedo,
            _ => self.eval(wi) * (wi.z / pdf) as f32,
        };
        (pdf > 0.0).then_some(BsdfSample { wi, weight, pdf, lobe: Lobe::Diffuse, eta: 1.0 })
    }
}
