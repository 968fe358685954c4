//! Chooses among very many pairs of a ball and a light.

use rayon::prelude::*;

use crate::math::DVec3;

use super::super::context::LightSampleContext;
use super::super::light_bounds::{LightBounds, LightItem};
use super::super::light_tree::LightTree;
use super::casters::{Caster, CasterSurface};
use super::pair::{CasterPair, ConnectedEmitter, ConnectedLight};

/// A tree over the balls, by the light that they send on, and one over the emitters.
#[derive(Debug)]
pub(super) struct PairTrees {
    casters: LightTree,
    emitters: Option<LightTree>,
    /// Centre of each ball, and the share of the sun in its irradiance.
    lit: Vec<(DVec3, f64)>,
}

impl PairTrees {
    /// Creates the trees over at least one ball; `sun` is the irradiance from the sun.
    pub(super) fn new(casters: &[Caster], emitters: &[ConnectedEmitter], sun: f64) -> Self {
        let total: f64 = emitters.iter().map(|emitter| emitter.power).sum();
        let item = |(emitter, index): (&ConnectedEmitter, u32)| LightItem {
            sphere: emitter.sphere,
            power: emitter.power / total,
            emitter_index: index,
        };
        let items: Vec<_> = emitters.iter().zip(0..).map(item).collect();
        let emitters = (!items.is_empty()).then(|| LightTree::new(items));
        let from_emitters = |caster: &Caster| {
            let center = caster.ball.center;
            emitters.as_ref().map_or(0.0, |tree| {
                let importance = |bounds: &LightBounds| bounds.importance_facing(center);
                total * tree.sum_over(|bounds| bounds.is_small_from(center), importance)
            })
        };
        let irradiance: Vec<f64> =
            casters.par_iter().map(|caster| from_emitters(caster) + sun).collect();
        let share = |(caster, irradiance): (&Caster, &f64)| {
            let share = if *irradiance > 0.0 { sun / irradiance } else { 0.0 };
            (caster.ball.center, share)
        };
        let sent = |(caster, irradiance): (&Caster, &f64)| {
            let reflectance = match caster.surface {
                CasterSurface::Opaque(reflectance) => reflectance,
                CasterSurface::Dielectric(_) => 1.0,
            };
            reflectance * caster.ball.radius * caster.ball.radius * irradiance
        };
        let all: f64 = casters.iter().zip(&irradiance).map(sent).sum();
        let item = |(of, index): ((&Caster, &f64), u32)| LightItem {
            sphere: of.0.ball,
            power: sent(of) / all,
            emitter_index: index,
        };
        let lit = casters.iter().zip(&irradiance).map(share).collect();
        let items = casters.iter().zip(&irradiance).zip(0..).map(item).collect();
        Self { casters: LightTree::new(items), emitters, lit }
    }

    /// Chooses a ball by `u` and a light by `u_light`, both in `[0, 1)`.
    pub(super) fn sample(
        &self,
        ctx: &LightSampleContext,
        inside: Option<u32>,
        [u, u_light]: [f64; 2],
    ) -> Option<CasterPair> {
        let (caster, of_caster) = match inside {
            Some(caster) => (caster, 1.0),
            None => self.casters.sample(ctx, u)?,
        };
        let (center, sun_share) = self.lit[caster as usize];
        if u_light < sun_share {
            let pmf = of_caster * sun_share;
            return Some(CasterPair { n: 0, caster, light: ConnectedLight::Sun, pmf });
        }
        let u_light = ((u_light - sun_share) / (1.0 - sun_share)).min(1.0 - f64::EPSILON);
        let importance = |bounds: &LightBounds| bounds.importance_facing(center);
        let (index, pmf) = self.emitters.as_ref()?.sample_by(importance, u_light)?;
        let pmf = of_caster * (1.0 - sun_share) * pmf;
        Some(CasterPair { n: 0, caster, light: ConnectedLight::Emitter(index), pmf })
    }

    /// Returns the probability with which [`Self::sample`] chooses a pair.
    pub(super) fn pmf(
        &self,
        ctx: &LightSampleContext,
        inside: Option<u32>,
        (caster, light): (u32, ConnectedLight),
    ) -> f64 {
        let of_caster = match inside {
            Some(_) => 1.0,
            None => self.casters.pmf(ctx, caster),
        };
        let (center, sun_share) = self.lit[caster as usize];
        let of_light = match (light, &self.emitters) {
            (ConnectedLight::Sun, _) => sun_share,
            (ConnectedLight::Emitter(index), Some(tree)) => {
                let importance = |bounds: &LightBounds| bounds.importance_facing(center);
                (1.0 - sun_share) * tree.pmf_by(importance, index)
            }
            (ConnectedLight::Emitter(_), None) => 0.0,
        };
        of_caster * of_light
    }
}
