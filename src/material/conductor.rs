//! Metal: light that is not reflected is absorbed. Smooth, or rough as a GGX microsurface.
//!
//! Fresnel's equations for a complex index of refraction give the reflectance of a facet (Born and
//! Wolf, section 14.2). Multiple scattering between facets is compensated (see
//! [`super::energy_compensation`]) and coloured by the further bounces, so that rough metal does
//! not darken. The BRDF is reciprocal. With lossless facets it scatters all light: within 5e-4 as
//! evaluated, exactly as sampled.
//!
//! A metal may also be given by a colour, its reflectance at normal incidence; the rest follows
//! from Schlick (1994, "An Inexpensive BRDF Model for Physically-based Rendering").

use crate::color::Rgb;
use crate::math::DVec3;

use super::energy_compensation::{hemispherical_mean, multiscatter_tint};
use super::ggx::half_vector;
use super::mirror::reflect;
use super::{BsdfSample, EnergyCompensation, ExtraUniforms, Ggx, Lobe, Metal};

/// A metal surface.
#[derive(Clone, Debug)]
pub struct Conductor {
    fresnel: ConductorFresnel,
    /// Colour of multiply scattered light.
    multiscatter_tint: Rgb,
    /// `None` if smooth.
    rough: Option<Box<RoughConductor>>,
}

/// A metal surface at a point.
#[derive(Clone, Copy, Debug)]
pub struct ConductorBsdf<'a> {
    fresnel: ConductorFresnel,
    multiscatter_tint: Rgb,
    rough: Option<&'a RoughConductor>,
}

/// Fresnel reflectance of a facet.
#[derive(Clone, Copy, Debug)]
enum ConductorFresnel {
    /// By Fresnel's equations.
    Metal(Metal),
    /// By Schlick's approximation, from the reflectance at normal incidence.
    Schlick(Rgb),
}

#[derive(Clone, Copy, Debug)]
struct RoughConductor {
    ggx: Ggx,
    compensation: EnergyCompensation,
}

/// Returns the fraction of unpolarised light that a medium of complex index of refraction `n + ik`
/// reflects at the cosine `cos >= 0` from vacuum.
pub fn fresnel_conductor(cos: f64, n: f64, k: f64) -> f64 {
    let cos_squared = cos * cos;
    let sin_squared = (1.0 - cos) * (1.0 + cos);
    // a + ib is the complex root of (n + ik)^2 - sin^2.
    let real = n * n - k * k - sin_squared;
    let modulus = real.hypot(2.0 * n * k);
    let a = (0.5 * (modulus + real)).max(0.0).sqrt();
    let sum = modulus + cos_squared;
    let product = 2.0 * a * cos;
    let perpendicular = (sum - product) / (sum + product).max(f64::MIN_POSITIVE);
    let sum = cos_squared * modulus + sin_squared * sin_squared;
    let product = product * sin_squared;
    let parallel = perpendicular * (sum - product) / (sum + product).max(f64::MIN_POSITIVE);
    (0.5 * (perpendicular + parallel)).clamp(0.0, 1.0)
}

impl Metal {
    /// Returns the reflectance at the cosine `cos >= 0`.
    pub fn reflectance(&self, cos: f64) -> Rgb {
        self.per_channel(|n, k| fresnel_conductor(cos.min(1.0), n, k))
    }

    fn per_channel(&self, f: impl Fn(f64, f64) -> f64) -> Rgb {
        let channel = |i: usize| f(f64::from(self.ior[i]), f64::from(self.extinction[i])) as f32;
        Rgb::new(channel(0), channel(1), channel(2))
    }
}

impl ConductorFresnel {
    /// Returns the reflectance at the cosine `cos >= 0`.
    fn reflectance(&self, cos: f64) -> Rgb {
        match self {
            Self::Metal(metal) => metal.reflectance(cos),
            Self::Schlick(color) => {
                let rest = (1.0 - cos).clamp(0.0, 1.0).powi(5);
                *color + (Rgb::ONE - color) * rest as f32
            }
        }
    }

    /// Returns the cosine-weighted mean over the hemisphere.
    fn mean_reflectance(&self) -> Rgb {
        match self {
            Self::Metal(metal) => {
                metal.per_channel(|n, k| hemispherical_mean(|cos| fresnel_conductor(cos, n, k)))
            }
            Self::Schlick(color) => *color + (Rgb::ONE - color) / 21.0,
        }
    }
}

impl RoughConductor {
    /// Returns the colour of light scattered multiply between such facets.
    fn multiscatter_tint(&self, fresnel: &ConductorFresnel) -> Rgb {
        let missing = self.compensation.mean_missing();
        let multiscatter_tint = |mean: f32| multiscatter_tint(f64::from(mean), missing) as f32;
        Rgb::from_array(fresnel.mean_reflectance().to_array().map(multiscatter_tint))
    }
}

impl Conductor {
    /// Returns true if the surface has no microfacets.
    pub fn is_smooth(&self) -> bool {
        self.rough.is_none()
    }

    /// Creates a metal with a roughness in `[0, 1]`.
    pub fn new(metal: Metal, roughness: f64) -> Self {
        Self::from_fresnel(ConductorFresnel::Metal(metal), roughness)
    }

    /// Creates a metal that reflects `color` at normal incidence.
    pub fn from_color(color: Rgb, roughness: f64) -> Self {
        Self::from_fresnel(ConductorFresnel::Schlick(color), roughness)
    }

    fn from_fresnel(fresnel: ConductorFresnel, roughness: f64) -> Self {
        let rough = |ggx| {
            Box::new(RoughConductor { ggx, compensation: EnergyCompensation::for_reflection(ggx) })
        };
        let rough = Ggx::new(roughness).map(rough);
        let multiscatter_tint =
            rough.as_ref().map_or(Rgb::ZERO, |rough| rough.multiscatter_tint(&fresnel));
        Self { fresnel, multiscatter_tint, rough }
    }

    /// Returns the BSDF at a point; `color` is the sphere's own colour, if it has one.
    pub(super) fn bsdf(&self, color: Option<Rgb>) -> ConductorBsdf<'_> {
        let Self { fresnel, multiscatter_tint, rough } = self;
        let rough = rough.as_deref();
        let Some(color) = color else {
            return ConductorBsdf {
                fresnel: *fresnel,
                multiscatter_tint: *multiscatter_tint,
                rough,
            };
        };
        let fresnel = ConductorFresnel::Schlick(color);
        let multiscatter_tint = rough.map_or(Rgb::ZERO, |rough| rough.multiscatter_tint(&fresnel));
        ConductorBsdf { fresnel, multiscatter_tint, rough }
    }
}

impl ConductorBsdf<'_> {
    /// Returns the mean reflectance of the facets.
    pub(super) fn mean_reflectance(&self) -> Rgb {
        self.fresnel.mean_reflectance()
    }

    /// Returns the reflectance of the facets at the cosine `cos >= 0`.
    pub(super) fn reflectance(&self, cos: f64) -> Rgb {
        self.fresnel.reflectance(cos)
    }

    pub(super) fn is_delta(&self) -> bool {
        self.rough.is_none()
    }

    pub(super) fn eval(&self, wo: DVec3, wi: DVec3) -> Rgb {
        let Some(rough) = &self.rough else { return Rgb::ZERO };
        if wi.z <= 0.0 {
            return Rgb::ZERO;
        }
        let single = rough.ggx.eval_reflection(wo, wi) as f32;
        let multiple = rough.compensation.eval(wo.z, wi.z) as f32;
        self.fresnel.reflectance(wo.dot(half_vector(wo, wi))) * single
            + self.multiscatter_tint * multiple
    }

    pub(super) fn pdf(&self, wo: DVec3, wi: DVec3) -> f64 {
        let Some(rough) = &self.rough else { return 0.0 };
        if wi.z <= 0.0 {
            return 0.0;
        }
        let multiple = rough.compensation.missing(wo.z) * rough.compensation.pdf(wi.z);
        rough.ggx.eval_reflection(wo, wi) * wi.z + multiple
    }

    /// Samples a facet visible from `wo`; if its light hits another facet, samples the
    /// multiple-scattering lobe.
    pub(super) fn sample(
        &self,
        wo: DVec3,
        u_lobe: f64,
        u: [f64; 2],
        extra: ExtraUniforms<'_>,
    ) -> Option<BsdfSample> {
        let Some(rough) = &self.rough else {
            let (wi, weight) = (reflect(wo), self.fresnel.reflectance(wo.z));
            return Some(BsdfSample { wi, weight, pdf: 1.0, lobe: Lobe::Delta, eta: 1.0 });
        };
        let single = rough.ggx.sample_reflection(wo, u).map(|(wi, _)| wi);
        let single = single.filter(|wi| u_lobe < rough.ggx.shadowing(wo, *wi));
        let wi = single.unwrap_or_else(|| rough.compensation.sample(extra()));
        let pdf = self.pdf(wo, wi);
        let weight = self.eval(wo, wi) * (wi.z / pdf) as f32;
        (pdf > 0.0).then_some(BsdfSample { wi, weight, pdf, lobe: Lobe::Glossy, eta: 1.0 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::fresnel;
    use crate::sampling::{Hemisphere, Sampler};
    use approx::{assert_abs_diff_eq, assert_relative_eq};

    const ROUGHNESS: [f64; 6] = [0.01, 0.1, 0.3, 0.5, 0.8, 1.0];
    const COSINES: [f64; 5] = [1.0, 0.7, 0.3, 0.05, 0.001];

    fn direction(cos: f64) -> DVec3 {
        DVec3::new(((1.0 - cos) * (1.0 + cos)).sqrt(), 0.0, cos)
    }

    fn named(name: &str) -> Metal {
        Metal::NAMED.iter().find(|(known, _)| *known == name).expect("known").1
    }

    /// Facets that reflect everything.
    const LOSSLESS: Metal = Metal { ior: Rgb::ZERO, extinction: Rgb::ONE };

    #[test]
    fn without_extinction_a_conductor_is_a_dielectric() {
        for eta in [0.7, 1.5, 2.4] {
            for cos in [1.0, 0.9, 0.5, 0.1, 0.0] {
                let expected = fresnel(cos, eta).reflectance;
                assert_abs_diff_eq!(fresnel_conductor(cos, eta, 0.0), expected, epsilon = 1e-12);
            }
        }
        assert_eq!(fresnel_conductor(0.0, 1.0, 0.0), 0.0);
    }

    #[test]
    fn normal_incidence_and_grazing_are_known() {
        let (n, k): (f64, f64) = (0.14, 3.697);
        let expected = ((n - 1.0).powi(2) + k * k) / ((n + 1.0).powi(2) + k * k);
        assert_relative_eq!(fresnel_conductor(1.0, n, k), expected, max_relative = 1e-12);
        assert_relative_eq!(fresnel_conductor(0.0, n, k), 1.0, max_relative = 1e-12);
        assert_eq!(LOSSLESS.reflectance(0.4), Rgb::ONE);
    }

    #[test]
    fn the_named_metals_have_the_reflectance_of_their_spectra() {
        // Gold's red is from the measurement at 660 nm: 0.963.
        for (name, expected) in [
            ("gold", [0.963, 0.7299, 0.3644]),
            ("silver", [0.9893, 0.9840, 0.9779]),
            ("copper", [0.9292, 0.6237, 0.5223]),
            ("aluminium", [0.9075, 0.9158, 0.9223]),
            ("iron", [0.5294, 0.5133, 0.4942]),
            ("chromium", [0.5495, 0.5560, 0.5543]),
            ("nickel", [0.6963, 0.6409, 0.5632]),
            ("titanium", [0.6182, 0.5796, 0.5425]),
            ("platinum", [0.6773, 0.6379, 0.5836]),
            ("tungsten", [0.5182, 0.4940, 0.4689]),
            ("brass", [0.9075, 0.7796, 0.4224]),
        ] {
            let found = named(name).reflectance(1.0);
            assert!((found - Rgb::from(expected)).abs().max_element() < 5e-4, "{name}: {found}");
        }
    }

    /// Mean and standard error of the weights: the directional albedo.
    fn albedo(conductor: &Conductor, wo: DVec3) -> (Rgb, f64) {
        let n = 20_000u32;
        let weights = (0..n).map(|i| {
            let sampler = Sampler::independent(5, u64::from(i), 0);
            let extra = || sampler.get_2d(4);
            let conductor = conductor.bsdf(None);
            let sample = conductor.sample(wo, sampler.get(0), sampler.get_2d(1), &extra);
            sample.map_or(Rgb::ZERO, |sample| sample.weight)
        });
        let (sum, sum_squares) = weights.fold((Rgb::ZERO, 0.0), |(sum, sum_squares), weight| {
            (sum + weight, sum_squares + f64::from(weight.x).powi(2))
        });
        let mean = sum / n as f32;
        let variance = sum_squares / f64::from(n) - f64::from(mean.x).powi(2);
        (mean, (variance.max(0.0) / f64::from(n)).sqrt())
    }

    #[test]
    fn a_lossless_metal_scatters_all_light_at_every_roughness_and_angle() {
        // Five standard errors, significance 6e-7 each, plus the error bound of the tables.
        for roughness in ROUGHNESS {
            let conductor = Conductor::new(LOSSLESS, roughness);
            for cos in COSINES {
                let (mean, error) = albedo(&conductor, direction(cos));
                let deviation = (f64::from(mean.x) - 1.0).abs();
                assert!(deviation < 5e-4 + 5.0 * error, "roughness {roughness}, cos {cos}: {mean}");
            }
        }
    }

    #[test]
    fn no_metal_creates_light() {
        for metal in [named("gold"), named("silver"), named("tungsten")] {
            for roughness in [0.0, 0.1, 0.5, 1.0] {
                let conductor = Conductor::new(metal, roughness);
                for cos in COSINES {
                    let (mean, error) = albedo(&conductor, direction(cos));
                    let max = 1.0 + 5e-4 + 5.0 * error as f32;
                    assert!(mean.max_element() < max, "roughness {roughness}, cos {cos}: {mean}");
                }
            }
        }
    }

    #[test]
    fn light_may_go_both_ways() {
        let conductor = Conductor::new(named("copper"), 0.6);
        let conductor = conductor.bsdf(None);
        for i in 0..1000 {
            let u = Sampler::independent(1, i, 0);
            let wo = Hemisphere::Cosine.sample(u.get_2d(0));
            let wi = Hemisphere::UniformAngle.sample(u.get_2d(2));
            let (there, back) = (conductor.eval(wo, wi), conductor.eval(wi, wo));
            assert!((there - back).abs().max_element() <= 2e-6 * there.max_element());
        }
    }
}
