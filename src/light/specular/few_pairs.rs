//! The choice among a few pairs of a ball and a light, each evaluated.

use crate::math::DVec3;

use super::super::context::LightSampleContext;
use super::super::light_bounds::{LightBounds, LightItem};
use super::casters::{Caster, CasterSurface};
use super::focusing::focusing;
use super::pair::{CasterPair, ConnectedLight};
use super::pairs::{MAX_FEW, PairSampler};

/// Fraction of choices split evenly among the pairs above the horizon.
const UNIFORM_FRACTION: f64 = 0.1;

impl PairSampler {
    /// Chooses one pair by `u`, if any can contribute.
    pub(super) fn sample_few(
        &self,
        ctx: &LightSampleContext,
        inside: Option<u32>,
        mut u: f64,
    ) -> Option<CasterPair> {
        let (importance, count, total) = self.few(ctx, inside);
        let mut last = None;
        for (caster, light) in self.pairs(inside) {
            let pmf = probability(importance[self.index_of(caster, light)], count, total);
            if pmf > 0.0 {
                last = Some(CasterPair { n: 0, caster, light, pmf });
                if u < pmf {
                    break;
                }
                u -= pmf;
            }
        }
        last
    }

    /// Returns the probability with which [`Self::sample_few`] chooses a pair.
    pub(super) fn few_pmf(
        &self,
        ctx: &LightSampleContext,
        inside: Option<u32>,
        (caster, light): (u32, ConnectedLight),
    ) -> f64 {
        let (importance, count, total) = self.few(ctx, inside);
        probability(importance[self.index_of(caster, light)], count, total)
    }

    /// The importance of each pair, the number of those above 0, and their sum.
    fn few(&self, ctx: &LightSampleContext, inside: Option<u32>) -> ([f64; MAX_FEW], f64, f64) {
        let mut all = [0.0; MAX_FEW];
        let (mut count, mut total) = (0.0, 0.0);
        for (caster, light) in self.pairs(inside) {
            let importance = self.importance(ctx, inside, caster, light);
            all[self.index_of(caster, light)] = importance;
            total += importance;
            count += f64::from(u8::from(importance > 0.0));
        }
        (all, count, total)
    }

    /// The irradiance at a shading point by way of a ball, roughly: a mirror ball of radius r lit
    /// by E spreads `rho E pi r^2` evenly over all directions.
    fn importance(
        &self,
        ctx: &LightSampleContext,
        inside: Option<u32>,
        caster: u32,
        light: ConnectedLight,
    ) -> f64 {
        if self.kinds(caster, inside.is_some(), light).is_empty() {
            return 0.0;
        }
        let Caster { ball, surface, .. } = self.casters().all()[caster as usize];
        let (irradiance, towards) = self.irradiance(ball.center, light);
        if inside.is_some() {
            return irradiance;
        }
        let item = LightItem { sphere: ball, power: 1.0, emitter_index: 0 };
        let falloff = LightBounds::enclosing(ball.center, &[item]).importance(ctx);
        let quarter_square = 0.25 * ball.radius * ball.radius;
        let share = match surface {
            CasterSurface::Opaque(reflectance) => reflectance,
            CasterSurface::Dielectric(ior) => {
                focusing((ctx.hit.point - ball.center) / ball.radius, towards, ior)
            }
        };
        irradiance * falloff * quarter_square * share
    }

    /// Irradiance from a light at a point, and the unit direction to the light.
    fn irradiance(&self, point: DVec3, light: ConnectedLight) -> (f64, DVec3) {
        match light {
            ConnectedLight::Emitter(index) => self.emitters[index as usize].irradiance(point),
            ConnectedLight::Sun => self.sun.map_or((0.0, DVec3::Z), |(to, e)| (e, to)),
        }
    }
}

/// The probability of a pair of this importance among `count` with this `total`.
fn probability(importance: f64, count: f64, total: f64) -> f64 {
    if importance <= 0.0 {
        return 0.0;
    }
    UNIFORM_FRACTION / count + (1.0 - UNIFORM_FRACTION) * importance / total
}
