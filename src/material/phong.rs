//! Phong's shading model, the starting point of the paper (its section 1.1), for teaching.
//!
//! Two forms. `normalized` is the modified Phong BRDF of Lafortune and Willems (1994, "Using the
//! Modified Phong Reflectance Model for Physically Based Rendering"):
//! `albedo / pi + specular (n + 2) / (2 pi) cos^n(alpha)`, with `alpha` the angle between `wi` and
//! the mirror direction; it is reciprocal, and conserves energy if `albedo + specular <= 1`. The
//! classic form is Phong's (1975), where the highlight is not multiplied by the cosine:
//! `albedo / pi + specular cos^n(alpha) / cos(theta_i)`; it is neither reciprocal nor
//! energy-conserving, as a furnace test shows.

use std::f32::consts::FRAC_1_PI;
use std::f64::consts::TAU;

use crate::color::{Rgb, luminance};
use crate::fault::fault;
use crate::math::{DVec3, Frame};
use crate::sampling::{Hemisphere, hemisphere, powf};

use super::mirror::reflect;
use super::{BsdfSample, Lobe};

/// A Phong surface: diffuse with a highlight.
#[derive(Clone, Copy, Debug)]
pub struct Phong {
    /// Diffuse reflectance.
    pub albedo: Rgb,
    /// Glossy reflectance.
    pub specular: Rgb,
    /// Phong exponent n: larger values give narrower highlights.
    pub exponent: f64,
    /// True for the normalized form, false for the classic form.
    pub normalized: bool,
}

impl Phong {
    /// Returns this surface with a sphere's own colour as its diffuse reflectance, if it has one.
    pub(super) fn with_color(self, albedo: Option<Rgb>) -> Self {
        Self { albedo: albedo.unwrap_or(self.albedo), ..self }
    }

    pub(super) fn eval(&self, wo: DVec3, wi: DVec3) -> Rgb {
        if wi.z <= 0.0 {
            return Rgb::ZERO;
        }
        let lobe = powf(wi.dot(reflect(wo)).max(0.0), self.exponent);
        let scale = if self.normalized { (self.exponent + 2.0) / TAU } else { 1.0 / wi.z };
        self.albedo * FRAC_1_PI + self.specular * (scale * lobe) as f32
    }

    pub(super) fn pdf(&self, wo: DVec3, wi: DVec3) -> f64 {
        if wi.z <= 0.0 {
            return 0.0;
        }
        let glossy = self.glossy_probability();
        let glossy = if fault!(LobePdfsSwapped) { 1.0 - glossy } else { glossy };
        let cos_alpha = wi.dot(reflect(wo)).clamp(0.0, 1.0);
        (1.0 - glossy) * Hemisphere::Cosine.pdf(wi.z)
            + glossy * hemisphere::power_cosine_pdf(self.exponent, cos_alpha)
    }

    /// Samples a direction; `None` in the part of the glossy lobe that lies below the surface.
    pub(super) fn sample(&self, wo: DVec3, u_lobe: f64, u: [f64; 2]) -> Option<BsdfSample> {
        let is_glossy = u_lobe < self.glossy_probability();
        let wi = if is_glossy {
            let frame = Frame::from_z(reflect(wo));
            frame.to_world(hemisphere::sample_power_cosine(self.exponent, u))
        } else {
            Hemisphere::Cosine.sample(u)
        };
        let pdf = self.pdf(wo, wi);
        let weight = self.eval(wo, wi) * (wi.z / pdf) as f32;
        let lobe = if is_glossy { Lobe::Glossy } else { Lobe::Diffuse };
        (pdf > 0.0).then_some(BsdfSample { wi, weight, pdf, lobe, eta: 1.0 })
    }

    /// Returns the maximum directional albedo: the one at normal incidence, where none of the
    /// highlight lies below the surface. The integral of `cos^n` there is `2 pi / (n + 1)`. More
    /// than 1 for most classic highlights.
    pub fn max_albedo(&self) -> Rgb {
        let lobe = if self.normalized { 1.0 } else { TAU / (self.exponent + 1.0) };
        self.albedo + self.specular * lobe as f32
    }

    /// Returns the probability of sampling the highlight.
    fn glossy_probability(&self) -> f64 {
        let (diffuse, glossy) = (luminance(self.albedo), luminance(self.specular));
        let sum = diffuse + glossy;
        if sum > 0.0 { f64::from(glossy / sum) } else { 0.0 }
    }
}
