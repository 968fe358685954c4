//! Lights: emissive spheres and the environment, and how they are sampled.
//!
//! A shading point ([`LightSampleContext`]) requests a direction towards a light
//! ([`Lights::sample`]) or, for a direction that it obtained otherwise, the pdf with which light
//! sampling would have returned it ([`Lights::pdf`]). That pdf is 0 for light that is left to BSDF
//! sampling, such as a constant environment.

mod category;
mod connected_point;
mod context;
mod cut;
mod emitter;
mod environment;
mod light_bounds;
mod light_sampler;
mod light_tree;
pub mod specular;
mod sphere_tree;
mod visible_emitter;

pub use category::CategoryPmf;
pub use connected_point::ConnectedPoint;
pub use context::LightSampleContext;
pub use cut::{EmitterCut, EmitterCuts, Enclosure};
pub use emitter::Emitter;
pub use environment::{Environment, EnvironmentMap, Orientation, Sky, SunLight};
pub use light_sampler::LightSamplerKind;
pub use visible_emitter::{
    LaneHorizon, LaneLightSample, LanePoint, sample_at_horizon, sample_cut_in_lane, sample_in_lane,
};

use std::sync::Arc;

use crate::color::Rgb;
use crate::geometry::SphereSet;
use crate::math::{DVec3, NO_SPHERE};

use category::LightCategory;
use environment::MapSample;
use light_sampler::LightSampler;
use visible_emitter::VisibleEmitter;

/// All lights of a scene.
#[derive(Debug, Default)]
pub struct Lights {
    /// Emitters sorted by id.
    emitters: Arc<[Emitter]>,
    cuts: Arc<EmitterCuts>,
    sampler: LightSampler,
    environment: Arc<Environment>,
}

/// A source of light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LightSource {
    /// An emissive sphere, by its id.
    Emitter(u32),
    /// The far wall of a translucent emissive sphere, seen from outside through the near one.
    FarWall(u32),
    /// The environment.
    Environment,
}

/// A sampled direction towards a light.
#[derive(Clone, Copy, Debug)]
pub struct LightSample {
    /// The sampled light.
    pub source: LightSource,
    /// Unit direction.
    pub direction: DVec3,
    /// Distance to the sampled wall of the emitter; infinite for the environment.
    pub distance: f64,
    /// The radiance that arrives if unoccluded.
    pub radiance: Rgb,
    /// Probability of the source times the pdf of the direction per solid angle.
    pub pdf: f64,
    /// True if the sample has no variance but that of visibility, so that BSDF sampling need not
    /// find this light as well; see [`LightPdf::is_exact`].
    pub is_exact: bool,
}

/// The pdf of light samples in a direction.
#[derive(Clone, Copy, Debug)]
pub struct LightPdf {
    /// Probability of the source times the pdf of the direction per solid angle.
    pub pdf: f64,
    /// True if samples of the source have no variance but that of visibility: at a Lambertian
    /// surface, from the only light, sampled in proportion to the cosine. Then they have MIS weight
    /// 1, and emission found by BSDF sampling 0.
    pub is_exact: bool,
}

impl LightPdf {
    /// Of a light left to BSDF sampling.
    const ZERO: Self = Self::inexact(0.0);

    /// Of a light whose samples vary.
    pub const fn inexact(pdf: f64) -> Self {
        Self { pdf, is_exact: false }
    }
}

impl LightSource {
    /// Returns the target sphere of a shadow ray to this source.
    pub fn sphere_id(self) -> u32 {
        match self {
            Self::Emitter(id) | Self::FarWall(id) => id,
            Self::Environment => NO_SPHERE,
        }
    }
}

impl Lights {
    /// Creates the lights of a scene from the emitters among `spheres` and the environment, with
    /// the default light sampler. No wall hides a part of any emitter.
    pub fn new(mut emitters: Vec<Emitter>, spheres: &SphereSet, environment: Environment) -> Self {
        emitters.sort_unstable_by_key(|emitter| emitter.id);
        Self::with_sampler(
            LightSamplerKind::Hierarchy,
            emitters.into(),
            Arc::default(),
            spheres,
            Arc::new(environment),
        )
    }

    /// Creates lights from emitters sorted by id and their cuts, with the given light sampler.
    pub fn with_sampler(
        kind: LightSamplerKind,
        emitters: Arc<[Emitter]>,
        cuts: Arc<EmitterCuts>,
        spheres: &SphereSet,
        environment: Arc<Environment>,
    ) -> Self {
        debug_assert!(emitters.is_sorted_by_key(|emitter| emitter.id));
        let sampler = LightSampler::new(&emitters, &cuts, spheres, kind);
        Self { emitters, cuts, sampler, environment }
    }

    /// Number of emitters.
    pub fn len(&self) -> usize {
        self.emitters.len()
    }

    /// Returns true if [`Self::sample`] uses `u_select`.
    pub fn needs_selection(&self) -> bool {
        self.emitters.len() > 1 || self.environment.is_sampled()
    }

    /// Returns the emitter if it is the only light that can be sampled.
    pub fn single_emitter(&self) -> Option<&Emitter> {
        if self.needs_selection() { None } else { self.emitters.first() }
    }

    /// Returns the cut of the only emitter, unless it is whole.
    pub fn single_emitter_cut(&self) -> Option<&EmitterCut> {
        self.cuts.of_emitter(0)
    }

    /// Returns true if the scene has no emitters.
    pub fn is_empty(&self) -> bool {
        self.emitters.is_empty()
    }

    /// All emitters, sorted by id.
    pub fn emitters(&self) -> &[Emitter] {
        &self.emitters
    }

    /// The environment that rays see on a miss.
    pub fn environment(&self) -> &Environment {
        &self.environment
    }

    /// Samples a direction towards a light, from `u_select` and `u` in `[0, 1)`; `None` if the
    /// selected light is not visible from the shading point.
    pub fn sample(
        &self,
        spheres: &SphereSet,
        ctx: &LightSampleContext,
        u_select: f64,
        u: [f64; 2],
    ) -> Option<LightSample> {
        self.sample_by(&self.category_pmf(ctx), spheres, ctx, u_select, u)
    }

    /// As [`Self::sample`], with the probabilities of [`Self::category_pmf`] at this point.
    pub fn sample_by(
        &self,
        category_pmf: &CategoryPmf,
        spheres: &SphereSet,
        ctx: &LightSampleContext,
        u_select: f64,
        u: [f64; 2],
    ) -> Option<LightSample> {
        if category_pmf.is_none() {
            return None;
        }
        let (category, probability, u_select) = category_pmf.sample(u_select);
        let MapSample { direction, radiance, pdf: map_pdf } = match category {
            LightCategory::Emitters => {
                return self.sample_emitter(spheres, ctx, probability, u_select, u);
            }
            LightCategory::EnvironmentMap => self.environment.sample(u)?,
            LightCategory::Sun => {
                let direction = self.environment.sun()?.sample(u);
                let (radiance, pdf) = self.environment.radiance_and_pdf(direction);
                MapSample { direction, radiance, pdf }
            }
        };
        let source = LightSource::Environment;
        let pdf = self.environment_pdf(category_pmf, direction, map_pdf);
        let sample = LightSample {
            source,
            direction,
            distance: f64::INFINITY,
            radiance,
            pdf,
            is_exact: false,
        };
        (pdf > 0.0).then_some(sample)
    }

    fn sample_emitter(
        &self,
        spheres: &SphereSet,
        ctx: &LightSampleContext,
        probability: f64,
        u_select: f64,
        mut u: [f64; 2],
    ) -> Option<LightSample> {
        let (index, pmf) = self.sampler.sample(ctx, u_select)?;
        let Emitter { id, emission, transmittance, .. } = self.emitters[index];
        let sphere = spheres.sphere(id);
        let visible = VisibleEmitter::new(ctx, id, &sphere, self.cuts.of_emitter(index))?;
        let far_wall_pmf = visible.far_wall_pmf(&self.emitters[index]);
        let is_far = u[0] < far_wall_pmf;
        let wall_pmf = if is_far { far_wall_pmf } else { 1.0 - far_wall_pmf };
        if far_wall_pmf > 0.0 {
            let start = if is_far { 0.0 } else { far_wall_pmf };
            u[0] = ((u[0] - start) / wall_pmf).min(1.0 - f64::EPSILON);
        }
        let (direction, near, pdf) = visible.sample(u);
        let pdf = pdf * pmf * probability * wall_pmf;
        let is_exact = self.is_exact(&visible);
        let sample = match is_far {
            true => LightSample {
                source: LightSource::FarWall(id),
                direction,
                distance: sphere.roots(ctx.hit.point, direction).map_or(near, |roots| roots.far),
                radiance: emission * transmittance,
                pdf,
                is_exact,
            },
            false => LightSample {
                source: LightSource::Emitter(id),
                direction,
                distance: near,
                radiance: emission,
                pdf,
                is_exact,
            },
        };
        (pdf > 0.0).then_some(sample)
    }

    /// Returns the pdf with which [`Self::sample`] returns this direction for this source, which
    /// the direction must hit; 0 for a sphere that is not an emitter and for lights left to BSDF
    /// sampling.
    pub fn pdf(
        &self,
        spheres: &SphereSet,
        ctx: &LightSampleContext,
        source: LightSource,
        direction: DVec3,
    ) -> f64 {
        self.pdf_by(&self.category_pmf(ctx), spheres, ctx, source, direction).pdf
    }

    /// As [`Self::pdf`], with the probabilities of [`Self::category_pmf`] at this point. Tells also
    /// whether the samples are exact.
    pub fn pdf_by(
        &self,
        category_pmf: &CategoryPmf,
        spheres: &SphereSet,
        ctx: &LightSampleContext,
        source: LightSource,
        direction: DVec3,
    ) -> LightPdf {
        let (id, is_far) = match source {
            LightSource::Emitter(id) => (id, false),
            LightSource::FarWall(id) => (id, true),
            LightSource::Environment => {
                let map_pdf = self.environment.pdf(direction);
                return LightPdf::inexact(self.environment_pdf(category_pmf, direction, map_pdf));
            }
        };
        let Ok(index) = self.emitters.binary_search_by_key(&id, |emitter| emitter.id) else {
            return LightPdf::ZERO;
        };
        let cut = self.cuts.of_emitter(index);
        let Some(visible) = VisibleEmitter::new(ctx, id, &spheres.sphere(id), cut) else {
            return LightPdf::ZERO;
        };
        let far_wall_pmf = visible.far_wall_pmf(&self.emitters[index]);
        let wall_pmf = if is_far { far_wall_pmf } else { 1.0 - far_wall_pmf };
        let pmf = category_pmf.pmf(LightCategory::Emitters) * self.sampler.pmf(ctx, index);
        let pdf = visible.pdf(direction) * pmf * wall_pmf;
        LightPdf { pdf, is_exact: self.is_exact(&visible) }
    }

    /// Returns true if samples of an emitter have no variance but that of visibility.
    fn is_exact(&self, visible: &VisibleEmitter) -> bool {
        !self.needs_selection() && visible.is_projected()
    }

    /// Returns the probability that [`Self::sample`] selects the environment rather than an
    /// emitter.
    pub fn environment_probability(&self, ctx: &LightSampleContext) -> f64 {
        let category_pmf = self.category_pmf(ctx);
        category_pmf.pmf(LightCategory::EnvironmentMap) + category_pmf.pmf(LightCategory::Sun)
    }

    /// Returns the probability of each category of lights at a shading point.
    pub fn category_pmf(&self, ctx: &LightSampleContext) -> CategoryPmf {
        CategoryPmf::new(&self.sampler, !self.is_empty(), &self.environment, ctx)
    }

    /// Returns [`Self::pdf_by`] of the environment, given the pdf of its map. A direction to the
    /// sun is also one to the map, so their pdfs add up.
    pub fn environment_pdf(
        &self,
        category_pmf: &CategoryPmf,
        direction: DVec3,
        map_pdf: f64,
    ) -> f64 {
        let map = category_pmf.pmf(LightCategory::EnvironmentMap);
        let map = if map > 0.0 { map * map_pdf } else { 0.0 };
        let sun = self.environment.sun().map_or(0.0, |sun| sun.pdf(direction));
        map + category_pmf.pmf(LightCategory::Sun) * sun
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Side, Sphere, SurfaceHit};
    use crate::sampling::Sampler;
    use light_bounds::LightItem;

    /// Emitters of very different sizes and powers in a unit box.
    pub(super) fn items(count: usize) -> Vec<LightItem> {
        let item = |emitter: u32| {
            let u: [f64; 5] =
                std::array::from_fn(|d| Sampler::independent(0, emitter.into(), 0).get(d as u32));
            let center = DVec3::new(u[0], u[1], u[2]);
            LightItem {
                sphere: Sphere { center, radius: 0.1 * u[3].powi(4) + 1e-9 },
                power: u[4],
                emitter_index: emitter,
            }
        };
        (0..count as u32).map(item).collect()
    }

    /// Shading points among the emitters and far from them, facing anywhere, one-sided and
    /// two-sided.
    pub(super) fn contexts() -> impl Iterator<Item = LightSampleContext> {
        (0..40u32).map(|i| {
            let u: [f64; 6] =
                std::array::from_fn(|d| Sampler::independent(1, i.into(), 0).get(d as u32));
            let normal = (DVec3::new(u[0], u[1], u[2]) - 0.5).normalize();
            let scale = if i < 20 { 1.0 } else { 50.0 };
            let point = (DVec3::new(u[3], u[4], u[5]) - 0.5) * scale + 0.5;
            let side = if i % 3 == 0 { Side::Inside } else { Side::Outside };
            let hit = SurfaceHit { id: 0, t: 1.0, point, normal, radius: 1.0, side };
            LightSampleContext { hit, is_two_sided: i % 2 == 0, is_lambertian: false }
        })
    }
}
