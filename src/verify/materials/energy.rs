//! Directional albedo of a surface, measured in two independent ways.
//!
//! *As sampled*: the mean weight of the sampled directions, with the change of radiance between
//! media removed from the refracted ones. This is the factor that a path's throughput is multiplied
//! with.
//!
//! *As evaluated*: the integral of `f cos` over directions from other distributions: reflected and
//! refracted by the microfacets with pdfs derived again here (Walter et al. 2007, equations 14 and
//! 17), cosine-weighted, and towards the horizon. This is the factor in next-event estimation.
//! Delta lobes, which have no `f`, are taken from the sampled estimate.

use std::f64::consts::{FRAC_1_PI, TAU};

use crate::material::{Bsdf, BsdfSample, Ggx, Lobe};
use crate::math::DVec3;
use crate::sampling::{Hemisphere, Sampler, SamplerKind, sin_cos};

use super::super::check::seed;
use super::super::statistics::MeanEstimate;
use super::cases::MaterialCase;

/// Independent means behind each energy.
const SEEDS: u64 = 32;
/// Lower bound of the log-uniform cosines.
const MIN_COS: f64 = 1e-4;

/// Fraction of light scattered, per channel.
pub(super) struct Energy {
    pub(super) sampled: [MeanEstimate; 3],
    pub(super) evaluated: [MeanEstimate; 3],
}

/// Measures the energy for `wo`, with this many directions per mean, a power of 2.
pub(super) fn energy(case: &MaterialCase, wo: DVec3, directions: u32) -> Energy {
    let bsdf = case.bsdf();
    let proposals = Proposals::new(case, &bsdf);
    let mut means = Vec::new();
    for index in 0..SEEDS {
        let seed = seed(&case.name, index);
        let mut sums = [DVec3::ZERO; 2];
        for i in 0..directions {
            let u = Sampler::with_kind(SamplerKind::Sobol, seed, 0, i, directions);
            let sampled = bsdf.sample(wo, u.get(2), u.get_2d(0), &|| u.get_2d(8));
            let weight = |s: &BsdfSample| s.weight.as_dvec3() * (s.eta * s.eta);
            sums[0] += sampled.as_ref().map_or(DVec3::ZERO, weight);
            sums[1] +=
                sampled.filter(|s| s.lobe == Lobe::Delta).as_ref().map_or(DVec3::ZERO, weight);
            sums[1] += proposals.estimate(&bsdf, wo, u.get(6), u.get_2d(4));
        }
        means.push(sums.map(|sum| (sum / f64::from(directions)).to_array()));
    }
    let estimate = |method: usize| {
        std::array::from_fn(|channel| {
            let values: Vec<f64> = means.iter().map(|mean| mean[method][channel]).collect();
            MeanEstimate::from_values(&values)
        })
    };
    Energy { sampled: estimate(0), evaluated: estimate(1) }
}

/// Equally likely proposal distributions.
struct Proposals {
    proposals: Vec<Proposal>,
    eta: f64,
}

enum Proposal {
    Reflect(Ggx),
    Refract(Ggx),
    /// Cosine-weighted, above (1) or below (-1).
    Cosine(f64),
    /// Uniform in the logarithm of the cosine.
    Horizon(f64),
}

impl Proposals {
    /// No proposals for a delta BSDF.
    fn new(case: &MaterialCase, bsdf: &Bsdf<'_>) -> Self {
        let mut proposals = Vec::new();
        if !bsdf.is_delta() {
            proposals.extend([Proposal::Cosine(1.0), Proposal::Horizon(1.0)]);
            for ggx in case.facet_roughnesses.iter().filter_map(|&roughness| Ggx::new(roughness)) {
                proposals.push(Proposal::Reflect(ggx));
                if bsdf.is_rough_transmissive() {
                    proposals.push(Proposal::Refract(ggx));
                }
            }
            if bsdf.is_rough_transmissive() {
                proposals.extend([Proposal::Cosine(-1.0), Proposal::Horizon(-1.0)]);
            }
        }
        Self { proposals, eta: case.eta }
    }

    /// Estimates `f cos` over the pdf of a direction.
    fn estimate(&self, bsdf: &Bsdf<'_>, wo: DVec3, u_select: f64, u: [f64; 2]) -> DVec3 {
        let proposal = (u_select * self.proposals.len() as f64) as usize;
        let wi = self.proposals.get(proposal).and_then(|proposal| proposal.sample(self.eta, wo, u));
        let Some(wi) = wi.filter(|wi| wi.z != 0.0) else { return DVec3::ZERO };
        let pdf: f64 = self.proposals.iter().map(|proposal| proposal.pdf(self.eta, wo, wi)).sum();
        let pdf = pdf / self.proposals.len() as f64;
        let radiance_scale = if wi.z < 0.0 { self.eta * self.eta } else { 1.0 };
        bsdf.eval(wo, wi).as_dvec3() * (radiance_scale * wi.z.abs() / pdf)
    }
}

impl Proposal {
    fn sample(&self, eta: f64, wo: DVec3, u: [f64; 2]) -> Option<DVec3> {
        match self {
            Self::Reflect(ggx) => ggx.sample_reflection(wo, u).map(|(wi, _)| wi),
            Self::Refract(ggx) => {
                let m = ggx.sample_visible_normal(wo, u);
                let cos = wo.dot(m);
                // Snell's law; NaN on total internal reflection.
                let cos_transmitted = (1.0 - (1.0 - cos * cos) / (eta * eta)).sqrt();
                let wi = m * (cos / eta - cos_transmitted) - wo / eta;
                (wi.z < 0.0).then(|| wi.normalize())
            }
            Self::Cosine(side) => Some(Hemisphere::Cosine.sample(u) * DVec3::new(1.0, 1.0, *side)),
            Self::Horizon(side) => {
                let cos = libm::pow(MIN_COS, u[0]);
                let sin = ((1.0 - cos) * (1.0 + cos)).sqrt();
                let (sin_phi, cos_phi) = sin_cos(TAU * u[1]);
                Some(DVec3::new(sin * cos_phi, sin * sin_phi, cos * side))
            }
        }
    }

    fn pdf(&self, eta: f64, wo: DVec3, wi: DVec3) -> f64 {
        match self {
            Self::Reflect(ggx) => ggx.reflection_pdf(wo, wi),
            Self::Refract(ggx) if wi.z < 0.0 => {
                let sum = wo + wi * eta;
                let normal = sum.normalize() * if sum.z < 0.0 { -1.0 } else { 1.0 };
                let (cos_o, cos_i) = (wo.dot(normal), wi.dot(normal));
                if cos_o <= 0.0 || cos_i >= 0.0 {
                    return 0.0;
                }
                ggx.visible_normal_pdf(wo, normal) * eta * eta * -cos_i / sum.length_squared()
            }
            Self::Refract(_) => 0.0,
            Self::Cosine(side) => (wi.z * side).max(0.0) * FRAC_1_PI,
            Self::Horizon(side) => {
                let cos = wi.z * side;
                if cos < MIN_COS { 0.0 } else { 1.0 / (cos * -libm::log(MIN_COS) * TAU) }
            }
        }
    }
}
