//! A thin clear coat: a dielectric layer, smooth or rough, that reflects light by Fresnel's
//! equations and transmits the rest to the base.
//!
//! `E(cos)` is the fraction of light from a direction that the coat reflects, `1 - E(cos)` the
//! fraction that it transmits; light lost between the facets of a rough coat by single scattering
//! counts as transmitted. A diffuse base seen through the coat has the reciprocal lobe
//! `(1 - E_o)(1 - E_i) / (pi mean(1 - E))`, which integrates to `1 - E_o` (Kelemen and
//! Szirmay-Kalos 2001, "A Microfacet Based Coupled Specular-Matte BRDF Model with Importance
//! Sampling"). Of the light that the base scatters diffusely, the coat reflects the fraction
//! `1 - mean(1 - E) / ior^2` back internally: transmittance into and out of the coat differ by the
//! squared index, as radiance does.

use std::f64::consts::FRAC_1_PI;

use crate::color::Rgb;
use crate::math::DVec3;

use super::energy_compensation::{hemispherical_mean, mean_over_visible_normals};
use super::ggx::half_vector;
use super::mirror::reflect;
use super::{BsdfSample, EnergyCompensation, Ggx, Lobe, fresnel};

/// A clear coat.
#[derive(Clone, Debug)]
pub struct Coat {
    ior: f64,
    /// `None` if smooth.
    ggx: Option<Ggx>,
    /// The table of `1 - E`. A smooth coat uses it only for sampling; Fresnel's equations give its
    /// value.
    compensation: Box<EnergyCompensation>,
    /// The cosine-weighted mean of `1 - E`.
    mean_transmittance: f64,
}

impl Coat {
    /// Creates a coat with an index of refraction relative to the surroundings, at least 1, and a
    /// roughness in `[0, 1]`.
    pub fn new(ior: f64, roughness: f64) -> Self {
        let reflectance = |cos: f64| fresnel(cos.min(1.0), ior).reflectance;
        let ggx = Ggx::new(roughness);
        let table = match ggx {
            Some(ggx) => rough_transmittance(ggx, ior),
            None => EnergyCompensation::new([0.5; 2], |wo| reflectance(wo.z)),
        };
        let mean_transmittance = match ggx {
            Some(_) => table.mean_missing(),
            None => hemispherical_mean(|cos| 1.0 - reflectance(cos)),
        };
        Self { ior, ggx, compensation: Box::new(table), mean_transmittance }
    }

    /// Returns the transmitted fraction `1 - E` for a direction of this cosine.
    pub(super) fn transmittance(&self, cos: f64) -> f64 {
        match self.ggx {
            Some(_) => self.compensation.missing(cos),
            None => 1.0 - fresnel(cos.min(1.0), self.ior).reflectance,
        }
    }

    /// Evaluates a white diffuse base seen through the coat: `f` without the cosine.
    pub(super) fn eval_base(&self, cos_o: f64, cos_i: f64) -> f64 {
        self.transmittance(cos_o) * self.transmittance(cos_i) * FRAC_1_PI / self.mean_transmittance
    }

    /// Returns the fraction of diffuse light from the base that escapes without internal
    /// reflection.
    pub(super) fn internal_escape(&self) -> f64 {
        (self.mean_transmittance / (self.ior * self.ior)).min(1.0)
    }

    /// Evaluates the coat's own reflection, without delta lobes.
    pub(super) fn eval(&self, wo: DVec3, wi: DVec3) -> f64 {
        let Some(ggx) = self.ggx else { return 0.0 };
        let cos = wo.dot(half_vector(wo, wi)).clamp(0.0, 1.0);
        ggx.eval_reflection(wo, wi) * fresnel(cos, self.ior).reflectance
    }

    /// Returns the pdf of [`Self::sample`], without delta lobes.
    pub(super) fn pdf(&self, wo: DVec3, wi: DVec3) -> f64 {
        self.ggx.map_or(0.0, |ggx| ggx.reflection_pdf(wo, wi))
    }

    pub(super) fn is_delta(&self) -> bool {
        self.ggx.is_none()
    }

    /// Samples only the coat's reflection; `None` if a facet reflects light into the surface.
    pub(super) fn sample(&self, wo: DVec3, u: [f64; 2]) -> Option<BsdfSample> {
        let Some(ggx) = self.ggx else {
            let weight = Rgb::splat(fresnel(wo.z.min(1.0), self.ior).reflectance as f32);
            let (wi, lobe) = (reflect(wo), Lobe::Delta);
            return Some(BsdfSample { wi, weight, pdf: 1.0, lobe, eta: 1.0 });
        };
        let (wi, m) = ggx.sample_reflection(wo, u)?;
        let reflectance = fresnel(wo.dot(m).clamp(0.0, 1.0), self.ior).reflectance;
        let weight = Rgb::splat((reflectance * ggx.shadowing(wo, wi)) as f32);
        let (pdf, lobe) = (ggx.reflection_pdf(wo, wi), Lobe::Glossy);
        Some(BsdfSample { wi, weight, pdf, lobe, eta: 1.0 })
    }

    /// Samples a rough coat over a white diffuse base, exactly in proportion to their contribution:
    /// a facet with `u_facet` and, unless the light leaves by reflection, the base with `u_base`.
    /// For a smooth coat, whose reflection is a delta lobe, samples only the base.
    pub(super) fn sample_with_base(
        &self,
        wo: DVec3,
        u_lobe: f64,
        u_facet: impl FnOnce() -> [f64; 2],
        u_base: [f64; 2],
    ) -> (DVec3, Lobe) {
        let reflected = self.ggx.and_then(|ggx| {
            let (wi, m) = ggx.sample_reflection(wo, u_facet())?;
            let reflectance = fresnel(wo.dot(m).clamp(0.0, 1.0), self.ior).reflectance;
            (u_lobe < reflectance * ggx.shadowing(wo, wi)).then_some(wi)
        });
        let base_sample = || (self.compensation.sample(u_base), Lobe::Diffuse);
        reflected.map_or_else(base_sample, |wi| (wi, Lobe::Glossy))
    }

    /// Returns the pdf of [`Self::sample_with_base`].
    pub(super) fn pdf_with_base(&self, wo: DVec3, wi: DVec3) -> f64 {
        let base_weight = if self.is_delta() { 1.0 } else { self.transmittance(wo.z) };
        self.eval(wo, wi) * wi.z + base_weight * self.compensation.pdf(wi.z)
    }
}

/// Tabulates the transmittance of a rough coat: 1 minus the singly scattered reflection.
fn rough_transmittance(ggx: Ggx, ior: f64) -> EnergyCompensation {
    // Masking sets in at cosines below about alpha; Fresnel reflectance changes fast below about
    // 1/4, whatever the roughness.
    EnergyCompensation::new([2.0 * ggx.alpha(), f64::max(0.5, 2.0 * ggx.alpha())], |wo| {
        mean_over_visible_normals(ggx, wo, |m| {
            let cos = wo.dot(m).clamp(0.0, 1.0);
            let wi = m * (2.0 * cos) - wo;
            let reflectance = fresnel(cos, ior).reflectance;
            if wi.z > 0.0 { reflectance * ggx.shadowing(wo, wi) } else { 0.0 }
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::{assert_abs_diff_eq, assert_relative_eq};

    /// Mean reflectance from outside in closed form (Dunkle 1963; Egan and Hilgeman 1973).
    fn mean_reflectance(n: f64) -> f64 {
        let (n2, n4) = (n * n, n.powi(4));
        0.5 + (n - 1.0) * (3.0 * n + 1.0) / (6.0 * (n + 1.0).powi(2))
            + n2 * (n2 - 1.0).powi(2) / (n2 + 1.0).powi(3) * ((n - 1.0) / (n + 1.0)).ln()
            - 2.0 * n.powi(3) * (n2 + 2.0 * n - 1.0) / ((n2 + 1.0) * (n4 - 1.0))
            + 8.0 * n4 * (n4 + 1.0) / ((n2 + 1.0) * (n4 - 1.0).powi(2)) * n.ln()
    }

    #[test]
    fn the_mean_of_a_smooth_coat_is_known_in_closed_form() {
        for ior in [1.1, 1.5, 2.4] {
            let coat = Coat::new(ior, 0.0);
            assert_relative_eq!(
                coat.mean_transmittance,
                1.0 - mean_reflectance(ior),
                epsilon = 1e-5
            );
            // The mean from inside, over directions that include total internal reflection, is the
            // same number by reciprocity.
            let inside = hemispherical_mean(|cos| fresnel(cos, 1.0 / ior).reflectance);
            assert_abs_diff_eq!(1.0 - coat.internal_escape(), inside, epsilon = 1e-3);
        }
    }

    #[test]
    fn a_narrow_lobe_lets_through_what_a_smooth_coat_does() {
        let [smooth, narrow] = [0.0, 0.02].map(|roughness| Coat::new(1.5, roughness));
        for cos in [1.0, 0.6, 0.2, 0.1] {
            assert_abs_diff_eq!(
                smooth.transmittance(cos),
                narrow.transmittance(cos),
                epsilon = 1e-3
            );
        }
    }
}
