//! A rough diffuse surface: tiny Lambertian facets that shade and light each other. It looks
//! flatter than a Lambertian surface: the full moon has no dark rim.
//!
//! The energy-preserving Oren-Nayar model (Portsmouth, Kutz and Hill 2024, "EON: A Practical
//! Energy-Preserving Rough Diffuse BRDF"). Single scattering has the form of Oren and Nayar (1994)
//! with Fujii's parameter `r` in `[0, 1]`,
//!
//! ```text
//! albedo / pi  A (1 + r s / t),    A = 1 / (1 + c1 r),    s = wi.wo - cos_i cos_o,
//! t = max(cos_i, cos_o) where s > 0, else 1,
//! ```
//!
//! which scatters the fraction `E(cos) = A (1 + r G(cos) / pi)`. Multiple scattering is added as a
//! product of the missing energy in both directions, so that the model is reciprocal and a white
//! surface reflects everything.

use std::f64::consts::{FRAC_1_PI, PI};

use crate::color::Rgb;
use crate::math::DVec3;
use crate::sampling::{Hemisphere, safe_acos};

use super::{BsdfSample, Lobe, diffuse};

/// `E` is `A (1 + c1 r)` = 1 at the horizon.
const C1: f64 = 0.5 - 2.0 / (3.0 * PI);
/// The mean of `E`, weighted with the cosine, is `A (1 + c2 r)`.
const C2: f64 = 2.0 / 3.0 - 28.0 / (15.0 * PI);

/// A rough diffuse surface.
#[derive(Clone, Copy, Debug)]
pub struct OrenNayar {
    /// The fraction of light that each facet scatters, in `[0, 1]`.
    pub albedo: Rgb,
    /// The roughness `r`, in `[0, 1]`; 0 is Lambertian.
    pub roughness: f64,
}

impl OrenNayar {
    /// Returns this surface with a sphere's own colour, if it has one.
    pub(super) fn with_color(self, albedo: Option<Rgb>) -> Self {
        Self { albedo: albedo.unwrap_or(self.albedo), ..self }
    }

    pub(super) fn eval(&self, wo: DVec3, wi: DVec3) -> Rgb {
        if wi.z <= 0.0 {
            return Rgb::ZERO;
        }
        let r = self.roughness;
        let scale = FRAC_1_PI / (1.0 + C1 * r);
        let s = wo.x * wi.x + wo.y * wi.y;
        let t = if s > 0.0 { wo.z.max(wi.z) } else { 1.0 };
        let single = scale * (1.0 + r * s / t);
        // (1 - E_o)(1 - E_i) / (1 - mean E), with the factors A r cancelled.
        let multiple = scale * r * missing_energy(wo.z) * missing_energy(wi.z) / (C1 - C2);
        self.albedo * single as f32 + self.multiscatter_albedo() * multiple as f32
    }

    /// Returns the colour of multiply scattered light: the geometric series over the facets'
    /// albedo, of which the mean of `E` escapes each time.
    fn multiscatter_albedo(&self) -> Rgb {
        let escape = ((1.0 + C2 * self.roughness) / (1.0 + C1 * self.roughness)) as f32;
        self.albedo * self.albedo * escape / (Rgb::ONE - self.albedo * (1.0 - escape))
    }

    /// Samples a direction over the hemisphere, as for a Lambertian surface.
    pub(super) fn sample(
        &self,
        hemisphere: Hemisphere,
        wo: DVec3,
        u: [f64; 2],
    ) -> Option<BsdfSample> {
        let wi = hemisphere.sample(u);
        let pdf = diffuse::pdf(hemisphere, wi);
        let weight = self.eval(wo, wi) * (wi.z / pdf) as f32;
        (pdf > 0.0).then_some(BsdfSample { wi, weight, pdf, lobe: Lobe::Diffuse, eta: 1.0 })
    }
}

/// Returns `(1 - E(cos)) / (A r) = c1 - G(cos) / pi`, which is 0 at the horizon. `G` is written
/// without its division by the cosine.
fn missing_energy(cos: f64) -> f64 {
    let cos = cos.min(1.0);
    let sin = ((1.0 - cos) * (1.0 + cos)).sqrt();
    let cubic = sin * cos * (1.0 + sin + sin * sin) / (1.0 + sin);
    let g = sin * (safe_acos(cos) - sin * cos) + 2.0 / 3.0 * (cubic - sin);
    (C1 - FRAC_1_PI * g).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    /// The fraction of light scattered, by the midpoint rule over azimuth and squared sine.
    fn energy(surface: &OrenNayar, wo: DVec3) -> f64 {
        let n = 400;
        let middle = |i: u32| (f64::from(i) + 0.5) / f64::from(n);
        let weight = |i: u32| {
            let wi = Hemisphere::Cosine.sample([middle(i / n), middle(i % n)]);
            f64::from(surface.eval(wo, wi).x) * PI
        };
        (0..n * n).map(weight).sum::<f64>() / f64::from(n * n)
    }

    #[test]
    fn a_white_surface_sends_back_everything() {
        for roughness in [0.01, 0.3, 1.0] {
            let white = OrenNayar { albedo: Rgb::ONE, roughness };
            for cos in [1.0, 0.7, 0.2, 0.1] {
                let wo = DVec3::new(f64::sqrt(1.0 - cos * cos), 0.0, cos);
                assert_relative_eq!(energy(&white, wo), 1.0, max_relative = 2e-4);
            }
        }
    }

    #[test]
    fn without_roughness_it_is_lamberts_surface() {
        let smooth = OrenNayar { albedo: Rgb::splat(0.5), roughness: 0.0 };
        let wo = DVec3::new(0.6, 0.0, 0.8);
        let f = smooth.eval(wo, DVec3::new(0.0, 0.8, 0.6));
        assert_relative_eq!(f.x, 0.5 / std::f32::consts::PI, max_relative = 1e-6);
    }

    #[test]
    fn light_from_behind_the_eye_comes_back_strongest() {
        let rough = OrenNayar { albedo: Rgb::splat(0.8), roughness: 1.0 };
        let wo = DVec3::new(0.8, 0.0, 0.6);
        let back = rough.eval(wo, wo).x;
        let forth = rough.eval(wo, DVec3::new(-0.8, 0.0, 0.6)).x;
        assert!(back > 2.0 * forth, "{back} {forth}");
    }
}
