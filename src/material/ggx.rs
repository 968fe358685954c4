//! The Trowbridge-Reitz (GGX) microsurface: tiny facets, each a smooth mirror or interface, whose
//! normals scatter around the surface normal.
//!
//! Everything is in the local frame, z being the surface normal, and in f64. `m` is a facet's
//! normal. The distribution is that of Trowbridge and Reitz (1975), as written by Walter et al.
//! (2007, "Microfacet Models for Refraction through Rough Surfaces", section 5.2); masking is
//! Smith's, with height correlation (Heitz 2014, "Understanding the Masking-Shadowing Function in
//! Microfacet-Based BRDFs", JCGT 3(2), sections 5 and 6). Visible normals are sampled by spherical
//! caps (Dupuy and Benyoub 2023, "Sampling Visible GGX Normals with Spherical Caps").
//!
//! The formulas never divide by a cosine, so they hold at grazing angles.

use std::f64::consts::{FRAC_1_PI, TAU};

use crate::fault::fault;
use crate::math::DVec3;
use crate::sampling::sin_cos;

/// A rough microsurface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ggx {
    alpha: f64,
}

impl Ggx {
    /// Roughness below which a surface is smooth, a delta lobe: its highlights would be narrower
    /// than 0.02 degrees.
    pub const SMOOTH_BELOW: f64 = 0.01;

    /// Creates the microsurface of a perceptually uniform roughness in `[0, 1]`:
    /// `alpha = roughness^2` (Burley 2012). `None` if the surface is smooth.
    pub fn new(roughness: f64) -> Option<Self> {
        let alpha = if fault!(AlphaIsRoughness) { roughness } else { roughness * roughness };
        (roughness >= Self::SMOOTH_BELOW).then_some(Self { alpha })
    }

    /// The width parameter: half of the surface is less steep than this slope.
    pub fn alpha(self) -> f64 {
        self.alpha
    }

    /// Distribution of normals D(m): the area of facets facing `m`, per solid angle and per area of
    /// the surface. Weighted with the cosine `m.z` it integrates to 1.
    pub fn d(self, m: DVec3) -> f64 {
        if m.z <= 0.0 {
            return 0.0;
        }
        let alpha_squared = self.alpha * self.alpha;
        // The sine from x and y: 1 - z^2 would lose the digits of a narrow lobe.
        let spread = m.x * m.x + m.y * m.y + alpha_squared * m.z * m.z;
        FRAC_1_PI * alpha_squared / (spread * spread)
    }

    /// Masking G1(w): the fraction of facets facing `w` that are not masked by others.
    pub fn g1(self, w: DVec3) -> f64 {
        2.0 * w.z.abs() / (w.z.abs() + self.stretch(w))
    }

    /// Masking-shadowing G2: the fraction of facets visible from both `wo` and `wi`, with height
    /// correlation, `1 / (1 + Lambda(wo) + Lambda(wi))`. For transmission, where `wi` is below, the
    /// same formula is used with the absolute cosines.
    pub fn g2(self, wo: DVec3, wi: DVec3) -> f64 {
        4.0 * wo.z.abs() * wi.z.abs() * self.g2_over_cosines(wo, wi)
    }

    /// `G2 / (4 |cos_o cos_i|)`, finite unless both directions graze.
    pub fn g2_over_cosines(self, wo: DVec3, wi: DVec3) -> f64 {
        let sum = wi.z.abs() * self.stretch(wo) + wo.z.abs() * self.stretch(wi);
        0.5 / sum.max(f64::MIN_POSITIVE)
    }

    /// `G2 / G1(wo)`: the fraction of light leaving towards `wi` from a facet visible from `wo`. At
    /// most 1.
    pub fn shadowing(self, wo: DVec3, wi: DVec3) -> f64 {
        let (cos_o, cos_i) = (wo.z.abs(), wi.z.abs());
        let (stretch_o, stretch_i) = (self.stretch(wo), self.stretch(wi));
        let sum = cos_i * stretch_o + cos_o * stretch_i;
        cos_i * (cos_o + stretch_o) / sum.max(f64::MIN_POSITIVE)
    }

    /// Samples the normal of a facet visible from `wo` (`wo.z >= 0`).
    pub fn sample_visible_normal(self, wo: DVec3, u: [f64; 2]) -> DVec3 {
        // Stretched along z, the microsurface is a hemisphere; the directions in which it reflects
        // `wo` fill a spherical cap uniformly.
        let standard =
            DVec3::new(self.alpha * wo.x, self.alpha * wo.y, wo.z).normalize_or(DVec3::Z);
        let (sin_phi, cos_phi) = sin_cos(TAU * u[0]);
        let z = (1.0 - u[1]) * (1.0 + standard.z) - standard.z;
        let sin = ((1.0 - z) * (1.0 + z)).max(0.0).sqrt();
        let half = DVec3::new(sin * cos_phi, sin * sin_phi, z) + standard;
        DVec3::new(self.alpha * half.x, self.alpha * half.y, half.z).normalize_or(DVec3::Z)
    }

    /// Returns the pdf of [`Self::sample_visible_normal`], per solid angle of `m`:
    /// `G1(wo) (wo.m) D(m) / wo.z`.
    pub fn visible_normal_pdf(self, wo: DVec3, m: DVec3) -> f64 {
        2.0 * wo.dot(m).max(0.0) * self.d(m) / (wo.z.abs() + self.stretch(wo))
    }

    /// Samples a reflection at a facet from [`Self::sample_visible_normal`]; returns the direction
    /// and the facet's normal. `None` if the direction leads into the surface. The weight of a
    /// lossless facet is [`Self::shadowing`].
    pub fn sample_reflection(self, wo: DVec3, u: [f64; 2]) -> Option<(DVec3, DVec3)> {
        let m = self.sample_visible_normal(wo, u);
        let wi = (m * (2.0 * wo.dot(m)) - wo).normalize();
        (wi.z > 0.0).then_some((wi, m))
    }

    /// Returns the pdf of [`Self::sample_reflection`], per solid angle of `wi`.
    pub fn reflection_pdf(self, wo: DVec3, wi: DVec3) -> f64 {
        if wi.z <= 0.0 {
            return 0.0;
        }
        let jacobian =
            if fault!(HalfVectorJacobianLost) { 2.0 * wo.dot(half_vector(wo, wi)) } else { 0.5 };
        jacobian * self.d(half_vector(wo, wi)) / (wo.z.abs() + self.stretch(wo))
    }

    /// Evaluates the BRDF of lossless facets, `D G2 / (4 cos_o cos_i)`. Multiply by the Fresnel
    /// reflectance at `wo.m` for real ones.
    pub fn eval_reflection(self, wo: DVec3, wi: DVec3) -> f64 {
        if wi.z <= 0.0 || wo.z < 0.0 {
            return 0.0;
        }
        self.d(half_vector(wo, wi)) * self.g2_over_cosines(wo, wi)
    }

    /// `sqrt(cos^2 + alpha^2 sin^2)`: `|cos| (1 + 2 Lambda)` in Smith's masking.
    fn stretch(self, w: DVec3) -> f64 {
        let (x, y) = (self.alpha * w.x, self.alpha * w.y);
        (w.z * w.z + x * x + y * y).sqrt()
    }
}

/// Returns the normal of the facet that reflects `wi` to `wo`, both above the surface.
pub fn half_vector(wo: DVec3, wi: DVec3) -> DVec3 {
    (wo + wi).normalize_or(DVec3::Z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    const ROUGHNESS: [f64; 4] = [0.05, 0.3, 0.6, 1.0];

    fn direction(theta: f64, phi: f64) -> DVec3 {
        let ((sin, cos), (sin_phi, cos_phi)) = (sin_cos(theta), sin_cos(phi));
        DVec3::new(sin * cos_phi, sin * sin_phi, cos)
    }

    /// Mean of `f` over a fine grid in the unit square.
    fn mean(n: u32, f: impl Fn([f64; 2]) -> f64) -> f64 {
        let at = |i| (f64::from(i) + 0.5) / f64::from(n);
        let sum: f64 = (0..n * n).map(|i| f([at(i % n), at(i / n)])).sum();
        sum / f64::from(n * n)
    }

    #[test]
    fn the_facets_project_to_the_surface_itself() {
        // With tan = alpha t / (1 - t) the integrand is a rational function, smooth in t.
        for roughness in ROUGHNESS {
            let ggx = Ggx::new(roughness).expect("rough");
            let area = mean(1000, |[t, _]| {
                let tan = ggx.alpha() * t / (1.0 - t);
                let cos = 1.0 / (1.0 + tan * tan).sqrt();
                let m = DVec3::new(tan * cos, 0.0, cos);
                // dw = 2 pi sin dtheta, dtheta = cos^2 dtan, dtan = alpha / (1 - t)^2 dt.
                let measure = TAU * tan * cos * cos * cos * ggx.alpha() / (1.0 - t).powi(2);
                ggx.d(m) * cos * measure
            });
            assert_relative_eq!(area, 1.0, max_relative = 1e-5);
        }
    }

    #[test]
    fn masking_keeps_the_projected_area() {
        // Heitz 2014, equation 14: the visible facets together have the area cos_o. Slopes are
        // sampled with their own density here, P(slope) dslope = m.z D(m) dm.
        for (roughness, theta) in [(0.3, 0.2), (0.6, 1.0), (1.0, 1.3), (1.0, 1.55)] {
            let ggx = Ggx::new(roughness).expect("rough");
            let wo = direction(theta, 0.0);
            let area = mean(1500, |[u, v]| {
                let tan = ggx.alpha() * (u / (1.0 - u)).sqrt();
                let m = direction(libm::atan(tan), TAU * v);
                ggx.g1(wo) * wo.dot(m).max(0.0) / m.z
            });
            assert_relative_eq!(area, wo.z, max_relative = 2e-2);
        }
    }

    #[test]
    fn g2_is_symmetric_and_below_both_maskings() {
        for roughness in ROUGHNESS {
            let ggx = Ggx::new(roughness).expect("rough");
            for (a, b) in [(0.0, 0.0), (0.3, 1.2), (1.5, 1.5), (1.57, 0.4)] {
                let (wo, wi) = (direction(a, 0.1), direction(b, 2.0));
                assert_eq!(ggx.g2(wo, wi), ggx.g2(wi, wo));
                assert!(ggx.g2(wo, wi) <= ggx.g1(wo).min(ggx.g1(wi)) * (1.0 + 1e-12));
                let ratio = ggx.g2(wo, wi) / ggx.g1(wo);
                assert_relative_eq!(ggx.shadowing(wo, wi), ratio, max_relative = 1e-12);
                let f = ggx.d(half_vector(wo, wi)) * ggx.g2(wo, wi) / (4.0 * wo.z * wi.z);
                assert_relative_eq!(ggx.eval_reflection(wo, wi), f, max_relative = 1e-9);
            }
        }
    }

    #[test]
    fn what_is_drawn_weighs_f_cos_over_pdf() {
        for roughness in ROUGHNESS {
            let ggx = Ggx::new(roughness).expect("rough");
            for (theta, u) in [(0.0, [0.1, 0.2]), (0.8, [0.7, 0.6]), (1.5, [0.3, 0.1])] {
                let wo = direction(theta, 1.0);
                let Some((wi, m)) = ggx.sample_reflection(wo, u) else { continue };
                let weight = ggx.eval_reflection(wo, wi) * wi.z / ggx.reflection_pdf(wo, wi);
                assert_relative_eq!(weight, ggx.shadowing(wo, wi), max_relative = 1e-9);
                let jacobian = 1.0 / (4.0 * wo.dot(m));
                let pdf = ggx.visible_normal_pdf(wo, m) * jacobian;
                assert_relative_eq!(ggx.reflection_pdf(wo, wi), pdf, max_relative = 1e-6);
            }
        }
    }

    #[test]
    fn nothing_breaks_at_the_horizon() {
        for roughness in [0.01, 0.1, 1.0] {
            let ggx = Ggx::new(roughness).expect("rough");
            for wo in [DVec3::X, DVec3::new(1.0, 0.0, 1e-300), DVec3::Z] {
                for u in [[0.0, 0.0], [0.5, 0.5], [0.25, 1.0 - f64::EPSILON]] {
                    let m = ggx.sample_visible_normal(wo, u);
                    assert!(m.is_normalized() && m.z >= 0.0, "{m}");
                    assert!(ggx.visible_normal_pdf(wo, m).is_finite());
                    if let Some((wi, _)) = ggx.sample_reflection(wo, u) {
                        assert!((0.0..=1.0 + 1e-12).contains(&ggx.shadowing(wo, wi)));
                        assert!(ggx.eval_reflection(wo, wi).is_finite());
                    }
                }
            }
        }
    }
}
