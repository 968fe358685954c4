//! An interface between two transparent media, such as glass and air: smooth, or rough as a GGX
//! microsurface.
//!
//! Each facet reflects by Fresnel's equations and refracts the rest (Walter et al. 2007,
//! "Microfacet Models for Refraction through Rough Surfaces"). Multiple scattering between facets
//! is compensated on both sides (see [`super::energy_compensation`]): energy is conserved, within
//! 2e-3 at every angle when evaluated, and exactly when sampled. This matters inside dense glass: a
//! path is reflected about `ior^2` times before it leaves, and if the variance of a weight exceeded
//! about `1 / ior^2`, the variance of their product would be unbounded.
//!
//! **Radiance between media.** An interface conserves radiance over the squared index (Veach 1997,
//! section 5.2). Here `wo` leads to the camera and `eta` is the index beyond over the index on the
//! side of `wo`, so refraction divides by `eta^2`, and reciprocity takes the form `eta^2 f(wo, wi)
//! = f(wi, wo)`, with the right-hand side evaluated from the other side.

use std::sync::{Arc, OnceLock};

use crate::color::Rgb;
use crate::fault::fault;
use crate::math::DVec3;

use super::fresnel::{Fresnel, fresnel, refract};
use super::ggx::half_vector;
use super::mirror::reflect;
use super::{
    BsdfSample, DielectricCompensation, DielectricCompensationSide, ExtraUniforms, Ggx, Lobe,
};

/// Relative index difference below which a rough boundary is ignored: its facets would bend light
/// by less than a degree, far from the broad lobes of energy compensation.
const INDEX_MATCHED: f64 = 0.01;

/// A dielectric such as glass.
#[derive(Clone, Debug)]
pub struct Dielectric {
    /// Index of refraction relative to vacuum.
    pub ior: f64,
    /// Where dielectric spheres overlap, the one with the higher priority fills the common part.
    pub priority: i32,
    /// `None` if smooth.
    rough: Option<Arc<RoughDielectric>>,
}

#[derive(Debug)]
struct RoughDielectric {
    ggx: Ggx,
    /// By the ratio of this index of refraction to the adjacent one; computed on first use.
    compensations: Vec<(f64, OnceLock<DielectricCompensation>)>,
}

/// A dielectric interface at a point.
#[derive(Clone, Copy, Debug)]
pub struct DielectricBsdf<'a> {
    /// Index of refraction beyond the interface over that on the side of `wo`.
    eta: f64,
    rough: Option<(Ggx, DielectricCompensationSide<'a>)>,
}

impl Dielectric {
    /// Creates a dielectric with a roughness in `[0, 1]`. `adjacent_iors` are the indices of all
    /// media that it may border on: its compensation tables are computed once for each.
    pub fn new(ior: f64, priority: i32, roughness: f64, adjacent_iors: &[f64]) -> Self {
        let compensations = || {
            adjacent_iors.iter().map(|adjacent_ior| (ior / adjacent_ior, OnceLock::new())).collect()
        };
        let rough = Ggx::new(roughness)
            .map(|ggx| Arc::new(RoughDielectric { ggx, compensations: compensations() }));
        Self { ior, priority, rough }
    }

    /// Returns true if the surface has no microfacets.
    pub fn is_smooth(&self) -> bool {
        self.rough.is_none()
    }

    /// Returns the BSDF for `eta`, the index of refraction beyond over that on this side: its own
    /// index over one of the `adjacent_iors`, or the inverse.
    pub fn bsdf(&self, eta: f64) -> DielectricBsdf<'_> {
        let rough = self.rough.as_ref().filter(|_| (eta - 1.0).abs() >= INDEX_MATCHED);
        DielectricBsdf {
            eta,
            rough: rough.and_then(|rough| Some((rough.ggx, rough.compensation(eta)?))),
        }
    }
}

impl RoughDielectric {
    /// Returns the compensation for the ratio `eta`, tolerating rounding.
    fn compensation(&self, eta: f64) -> Option<DielectricCompensationSide<'_>> {
        let difference = |ratio: f64| f64::min((ratio - eta).abs(), (1.0 / ratio - eta).abs());
        let nearest = self
            .compensations
            .iter()
            .min_by(|(a, _), (b, _)| difference(*a).total_cmp(&difference(*b)));
        let (ratio, energy) = nearest?;
        let energy = energy.get_or_init(|| DielectricCompensation::new(self.ggx, *ratio));
        let is_near_side = (*ratio > 1.0) == (eta > 1.0);
        Some(if is_near_side { energy.near_side() } else { energy.far_side() })
    }
}

/// The facet that refracts `wi` to `wo`.
struct Facet {
    normal: DVec3,
    /// The fraction of light that it reflects.
    reflectance: f64,
    /// `wo.m`, positive.
    cos_o: f64,
    /// Density of `wi` over that of its half vector, the facet's normal.
    jacobian: f64,
}

impl DielectricBsdf<'_> {
    pub(super) fn is_delta(&self) -> bool {
        self.rough.is_none()
    }

    /// Returns the facet that connects two directions on opposite sides; `None` if there is none.
    fn facet(&self, wo: DVec3, wi: DVec3) -> Option<Facet> {
        let eta = self.eta;
        // By Snell's law the tangential part of `wo + eta wi` cancels. The sum points to the side
        // of the lower index.
        let half = if fault!(HalfVectorEtaSwapped) { wo * eta + wi } else { wo + wi * eta };
        let length = half.length();
        let normal = half / if eta > 1.0 { -length } else { length };
        let (cos_o, cos_i) = (wo.dot(normal), -wi.dot(normal));
        if normal.z <= 0.0 || cos_o <= 0.0 || cos_i <= 0.0 {
            return None;
        }
        let reflectance = fresnel(cos_o.min(1.0), eta).reflectance;
        let jacobian = eta * eta * cos_i / (length * length);
        let jacobian = if fault!(RefractionJacobianLost) { 1.0 } else { jacobian };
        Some(Facet { normal, reflectance, cos_o, jacobian })
    }

    pub(super) fn eval(&self, wo: DVec3, wi: DVec3) -> f64 {
        let Some((ggx, energy)) = &self.rough else { return 0.0 };
        let all = self.single_scattering(ggx, wo, wi) + energy.eval(wo, wi);
        if wi.z > 0.0 { all } else { all / self.eta_squared() }
    }

    /// Evaluates single scattering, without the change of radiance between media.
    fn single_scattering(&self, ggx: &Ggx, wo: DVec3, wi: DVec3) -> f64 {
        if wi.z > 0.0 {
            let cos = wo.dot(half_vector(wo, wi)).clamp(0.0, 1.0);
            return ggx.eval_reflection(wo, wi) * fresnel(cos, self.eta).reflectance;
        }
        self.facet(wo, wi).map_or(0.0, |facet| {
            let seen = 4.0 * facet.cos_o * ggx.d(facet.normal) * ggx.g2_over_cosines(wo, wi);
            (1.0 - facet.reflectance) * seen * facet.jacobian
        })
    }

    /// Returns the factor by which refraction divides radiance.
    fn eta_squared(&self) -> f64 {
        if fault!(EtaSquaredDropped) { 1.0 } else { self.eta * self.eta }
    }

    pub(super) fn pdf(&self, wo: DVec3, wi: DVec3) -> f64 {
        let Some((ggx, energy)) = &self.rough else { return 0.0 };
        self.single_scattering(ggx, wo, wi) * wi.z.abs() + energy.missing(wo) * energy.pdf(wi)
    }

    /// Reflects with the Fresnel probability and refracts otherwise, at a facet visible from `wo`;
    /// if that light hits another facet, samples the multiple-scattering lobes.
    pub(super) fn sample(
        &self,
        wo: DVec3,
        u_lobe: f64,
        u: [f64; 2],
        extra: ExtraUniforms<'_>,
    ) -> Option<BsdfSample> {
        let Some((ggx, energy)) = &self.rough else { return Some(self.sample_smooth(wo, u_lobe)) };
        let single = self.sample_single_scattering(ggx, wo, u_lobe, u);
        let wi = single.unwrap_or_else(|side| energy.sample(side, extra()));
        let pdf = self.pdf(wo, wi);
        let weight = Rgb::splat((self.eval(wo, wi) * wi.z.abs() / pdf) as f32);
        let eta = if wi.z < 0.0 { self.eta } else { 1.0 };
        (pdf > 0.0).then_some(BsdfSample { wi, weight, pdf, lobe: Lobe::Glossy, eta })
    }

    /// Samples single scattering at a facet. If the light hits another facet, returns `u_lobe`
    /// remapped to `[0, 1)`: still uniform and independent of the facet.
    fn sample_single_scattering(
        &self,
        ggx: &Ggx,
        wo: DVec3,
        u_lobe: f64,
        u: [f64; 2],
    ) -> Result<DVec3, f64> {
        let m = ggx.sample_visible_normal(wo, u);
        let reflectance = fresnel(wo.dot(m).clamp(0.0, 1.0), self.eta).reflectance;
        let (wi, u_rest) = if u_lobe < reflectance {
            let wi = (m * (2.0 * wo.dot(m)) - wo).normalize();
            (Some(wi).filter(|wi| wi.z > 0.0), u_lobe / reflectance)
        } else {
            let wi = refract(wo, m, self.eta).filter(|wi| wi.z < 0.0);
            (wi, (u_lobe - reflectance) / (1.0 - reflectance))
        };
        let Some(wi) = wi else { return Err(u_rest) };
        let seen = ggx.shadowing(wo, wi);
        if u_rest < seen {
            Ok(wi)
        } else {
            Err((u_rest - seen) / (1.0 - seen).max(f64::MIN_POSITIVE))
        }
    }

    /// The weight is 1 except for the change of radiance between media.
    fn sample_smooth(&self, wo: DVec3, u_lobe: f64) -> BsdfSample {
        let eta = self.eta;
        let Fresnel { reflectance, cos_transmitted } = fresnel(wo.z.min(1.0), eta);
        if u_lobe < reflectance {
            let (wi, weight) = (reflect(wo), Rgb::ONE);
            return BsdfSample { wi, weight, pdf: reflectance, lobe: Lobe::Delta, eta: 1.0 };
        }
        BsdfSample {
            wi: DVec3::new(-wo.x / eta, -wo.y / eta, -cos_transmitted).normalize(),
            weight: Rgb::splat((1.0 / self.eta_squared()) as f32),
            pdf: 1.0 - reflectance,
            lobe: Lobe::Delta,
            eta,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Sampler;
    use approx::assert_relative_eq;

    #[test]
    fn fresnel_at_its_known_points() {
        assert_relative_eq!(fresnel(1.0, 1.5).reflectance, 0.04, max_relative = 1e-12);
        assert_relative_eq!(fresnel(1.0, 1.0 / 1.5).reflectance, 0.04, max_relative = 1e-12);
        assert!(fresnel(0.3, 1.0).reflectance < 1e-30, "no interface, no reflection");
        assert_relative_eq!(fresnel(0.0, 1.5).reflectance, 1.0, max_relative = 1e-12);
        // Beyond the critical angle, asin(1 / 1.5) = 41.8 degrees, reflection is total.
        assert_eq!(fresnel(0.7, 1.0 / 1.5).reflectance, 1.0);
        assert!(fresnel(0.75, 1.0 / 1.5).reflectance < 1.0);
    }

    #[test]
    fn at_brewsters_angle_only_one_polarisation_is_reflected() {
        let eta: f64 = 1.5;
        let cos = 1.0 / (1.0 + eta * eta).sqrt();
        let expected = ((1.0 - eta * eta) / (1.0 + eta * eta)).powi(2) / 2.0;
        assert_relative_eq!(fresnel(cos, eta).reflectance, expected, max_relative = 1e-12);
    }

    fn glass(roughness: f64) -> Dielectric {
        Dielectric::new(1.5, 0, roughness, &[1.0, 1.33])
    }

    #[test]
    fn refraction_obeys_snells_law_both_ways() {
        // A narrow lobe follows smooth refraction, with the surface as the facet.
        for roughness in [0.0, 0.01] {
            let glass = glass(roughness);
            let wo = DVec3::new(0.6, 0.0, 0.8);
            let sample = |eta: f64, wo| glass.bsdf(eta).sample(wo, 0.999, [0.5, 0.0], &|| [0.5; 2]);
            let into = sample(1.5, wo).expect("a direction").wi;
            assert_relative_eq!(into.x, -0.4, max_relative = 1e-3);
            let exit = DVec3::new(into.x, into.y, -into.z);
            let exit = sample(1.0 / 1.5, exit).expect("a direction").wi;
            assert_relative_eq!(exit.x, 0.6, max_relative = 1e-3);
        }
    }

    #[test]
    fn rough_glass_without_a_boundary_is_not_there() {
        let wo = DVec3::new(0.6, 0.0, 0.8);
        let glass = glass(0.8);
        let matched = glass.bsdf(1.0);
        let sample = matched.sample(wo, 0.5, [0.3, 0.3], &|| [0.5; 2]).expect("a direction");
        assert!(matched.is_delta() && (sample.wi + wo).length() < 1e-12);
    }

    #[test]
    fn what_is_prepared_is_found_from_both_sides() {
        let (wo, wi) = (DVec3::new(0.6, 0.0, 0.8), DVec3::new(0.0, 0.28, -0.96));
        let (shared, ggx) = (glass(0.7), Ggx::new(0.7).expect("rough"));
        for eta in [1.5, 1.0 / 1.5, 1.5 / 1.33, 1.33 / 1.5] {
            let energy = DielectricCompensation::new(ggx, eta);
            let fresh = DielectricBsdf { eta, rough: Some((ggx, energy.near_side())) };
            assert_relative_eq!(shared.bsdf(eta).eval(wo, wi), fresh.eval(wo, wi));
        }
    }

    /// Otherwise the product of the weights along a path in dense glass would diverge.
    #[test]
    fn what_is_drawn_weighs_about_one() {
        for (roughness, ior) in [(0.05, 1.5), (0.3, 10.0), (0.6, 1.1), (1.0, 1.5), (1.0, 10.0)] {
            let glass = Dielectric::new(ior, 0, roughness, &[1.0]);
            for eta in [ior, 1.0 / ior] {
                for cos in [1.0, 0.7, 0.2, 0.02] {
                    let wo = DVec3::new(f64::sqrt(1.0 - cos * cos), 0.0, cos);
                    let n = 4000;
                    let variance = |i: u32| {
                        let u = Sampler::independent(3, 0, i);
                        let glass = glass.bsdf(eta);
                        let sample = glass.sample(wo, u.get(2), u.get_2d(0), &|| u.get_2d(4));
                        let weight = sample.map_or(0.0, |s| f64::from(s.weight.x) * s.eta * s.eta);
                        (weight - 1.0) * (weight - 1.0)
                    };
                    let variance = (0..n).map(variance).sum::<f64>() / f64::from(n);
                    assert!(variance < 2e-3, "{roughness}, {eta}, {cos}: {variance}");
                }
            }
        }
    }

    #[test]
    fn nothing_breaks_at_the_horizon() {
        for (roughness, eta) in [(0.01, 1.5), (0.5, 0.5), (1.0, 1.02), (1.0, 10.0), (0.01, 0.1)] {
            let glass = Dielectric::new(eta, 0, roughness, &[1.0]);
            let glass = glass.bsdf(eta);
            for wo in [DVec3::X, DVec3::new(1.0, 0.0, 1e-300), DVec3::Z] {
                for u in [[0.0, 0.0], [0.5, 0.5], [0.25, 1.0 - f64::EPSILON]] {
                    for lobe in [0.0, 0.3, 1.0 - f64::EPSILON] {
                        let sample = glass.sample(wo, lobe, u, &|| u);
                        let Some(sample) = sample else { continue };
                        let max = 10.0 * f64::max(1.0, 1.0 / (eta * eta)) as f32;
                        assert!(sample.wi.is_normalized() && sample.pdf.is_finite());
                        assert!(sample.weight.x >= 0.0 && sample.weight.x < max, "{sample:?}");
                    }
                }
            }
        }
    }
}
