//! Chooses pairs of a ball and a light to connect.
//!
//! A few pairs are all tried. Up to [`MAX_FEW`], one is chosen by the light that the ball is
//! expected to send to the shading point. Of more, a ball is chosen by a tree over the balls, as if
//! each emitted what it reflects, and then a light by a tree over the emitters, as seen from the
//! ball.

use std::f64::consts::PI;

use crate::color::luminance;
use crate::geometry::SphereSet;
use crate::math::DVec3;

use super::super::context::LightSampleContext;
use super::super::emitter::Emitter;
use super::casters::{Caster, CasterSurface, Casters};
use super::emitter_view::EmitterView;
use super::pair::{CasterPair, ConnectedEmitter, ConnectedLight, EmitterPlace};
use super::pair_trees::PairTrees;
use super::path_kind::SpecularPath;
use super::worth::{PairWorth, is_accepted};

/// Up to this many pairs are all tried.
pub const MAX_PAIRS: usize = 8;
/// Up to this many pairs are evaluated one by one.
pub(super) const MAX_FEW: usize = 64;

/// The pairs to connect at one shading point.
#[derive(Clone, Copy, Debug, Default)]
pub struct CasterPairs {
    list: [Option<CasterPair>; MAX_PAIRS],
}

/// Selection probabilities of all pairs.
#[derive(Debug)]
pub struct PairSampler {
    casters: Casters,
    pub(super) emitters: Vec<ConnectedEmitter>,
    /// Direction and irradiance of the sun.
    pub(super) sun: Option<(DVec3, f64)>,
    sun_solid_angle: f64,
    is_certain: bool,
    /// Of each pair, if all are tried.
    worths: Vec<PairWorth>,
    trees: Option<PairTrees>,
}

impl CasterPairs {
    /// The chosen pairs.
    pub fn iter(&self) -> impl Iterator<Item = CasterPair> + '_ {
        self.list.iter().flatten().copied()
    }
}

impl PairSampler {
    /// Creates the sampler of all pairs of these balls with the emitters and the sun, given by its
    /// direction, irradiance and solid angle. If `is_certain`, chosen pairs are always connected.
    pub fn new(
        casters: Casters,
        emitters: &[Emitter],
        sun: Option<(DVec3, f64, f64)>,
        spheres: &SphereSet,
        is_certain: bool,
    ) -> Self {
        let connected = |emitter: &Emitter| {
            let sphere = spheres.sphere(emitter.id);
            let power = PI * sphere.radius * sphere.radius * f64::from(luminance(emitter.emission));
            ConnectedEmitter { id: emitter.id, sphere, power }
        };
        let emitters: Vec<_> = emitters.iter().map(connected).collect();
        let sun_solid_angle = sun.map_or(0.0, |sun| sun.2);
        let sun = sun.map(|(direction, irradiance, _)| (direction, irradiance));
        let worths = Vec::new();
        let mut sampler =
            Self { casters, emitters, sun, sun_solid_angle, is_certain, worths, trees: None };
        if !sampler.needs_choice() {
            sampler.worths = sampler.pairs(None).map(|pair| sampler.compute_worth(pair)).collect();
        }
        if sampler.pair_count() > MAX_FEW {
            let sun = sun.map_or(0.0, |(_, irradiance)| irradiance);
            sampler.trees = Some(PairTrees::new(sampler.casters.all(), &sampler.emitters, sun));
        }
        sampler
    }

    /// The balls.
    pub fn casters(&self) -> &Casters {
        &self.casters
    }

    /// Returns the kinds of paths over a ball that lead to a light, from a point that is inside of
    /// the ball or, outside of it, anywhere: empty if they are left to chance, as with an emitter
    /// that cuts the ball's surface.
    #[inline]
    pub fn kinds(
        &self,
        caster: u32,
        is_inside: bool,
        light: ConnectedLight,
    ) -> &'static [SpecularPath] {
        let Caster { id, ball, surface } = self.casters.all()[caster as usize];
        let place = match light {
            ConnectedLight::Emitter(index) => self.emitters[index as usize].place(id, &ball),
            ConnectedLight::Sun if self.sun.is_none() => EmitterPlace::Elsewhere,
            ConnectedLight::Sun => EmitterPlace::Apart,
        };
        match (surface, is_inside, place) {
            (CasterSurface::Opaque(_), false, EmitterPlace::Apart) => &[SpecularPath::Reflection],
            (CasterSurface::Dielectric(_), false, EmitterPlace::Apart) => {
                &SpecularPath::OVER_DIELECTRIC
            }
            (CasterSurface::Dielectric(_), false, EmitterPlace::Inside) => &[SpecularPath::Inward],
            (CasterSurface::Dielectric(_), true, EmitterPlace::Apart) => &[SpecularPath::Outward],
            _ => &[],
        }
    }

    /// Returns an emitter as connections over a ball see it from a point; `None` if it does not
    /// face the ball.
    #[inline]
    pub fn view(&self, caster: u32, emitter: u32, from: DVec3) -> Option<EmitterView> {
        let Caster { id, ball, .. } = &self.casters.all()[caster as usize];
        let of = &self.emitters[emitter as usize];
        match (of.place(*id, ball), self.casters.ior(caster)) {
            (EmitterPlace::Inside, Some(ior)) => {
                EmitterView::through_boundary(ball, ior, from, &of.sphere)
            }
            _ => EmitterView::from_ball(ball, &of.sphere),
        }
    }

    /// Returns the probability with which a chosen pair is connected at x.
    #[inline]
    pub fn worth(&self, pair: (u32, ConnectedLight), is_inside: bool, x: DVec3) -> f64 {
        let computed;
        let worth = match self.worths.get(self.index_of(pair.0, pair.1)) {
            Some(worth) => worth,
            None => {
                computed = self.compute_worth(pair);
                &computed
            }
        };
        if is_inside {
            worth.inside(x)
        } else if worth.is_dielectric() {
            worth.at::<true>(x)
        } else {
            worth.at::<false>(x)
        }
    }

    /// The worth of each pair in order, if all pairs are tried.
    pub fn worths(&self) -> &[PairWorth] {
        &self.worths
    }

    fn compute_worth(&self, (caster, light): (u32, ConnectedLight)) -> PairWorth {
        let caster = &self.casters.all()[caster as usize];
        let worth = match light {
            ConnectedLight::Emitter(index) => {
                PairWorth::new(caster, &self.emitters[index as usize])
            }
            ConnectedLight::Sun => {
                let (towards, _) = self.sun.unwrap_or((DVec3::Z, 0.0));
                PairWorth::of_sun(caster, towards, self.sun_solid_angle)
            }
        };
        if self.is_certain { worth.certain() } else { worth }
    }

    fn light_count(&self) -> usize {
        self.emitters.len() + usize::from(self.sun.is_some())
    }

    fn pair_count(&self) -> usize {
        self.casters.all().len().saturating_mul(self.light_count())
    }

    fn light(&self, index: usize) -> ConnectedLight {
        match index < self.emitters.len() {
            true => ConnectedLight::Emitter(index as u32),
            false => ConnectedLight::Sun,
        }
    }

    /// All pairs in order, or those of one ball.
    pub fn pairs(&self, inside: Option<u32>) -> impl Iterator<Item = (u32, ConnectedLight)> + '_ {
        let casters = match inside {
            Some(caster) => caster..caster + 1,
            None => 0..self.casters.all().len() as u32,
        };
        let lights = 0..self.light_count();
        casters.flat_map(move |caster| lights.clone().map(move |i| (caster, self.light(i))))
    }

    /// Returns true if [`Self::sample`] uses `u`.
    pub fn needs_choice(&self) -> bool {
        self.pair_count() > MAX_PAIRS
    }

    /// Chooses pairs by numbers in `[0, 1)`: `u` selects one of many pairs, `u_worth` decides
    /// whether a pair is worth a connection, and `u_light` gives the number that selects the light
    /// where there are so many pairs that the ball is selected first: numbers of a sequence have 32
    /// bits, too few to be split. `inside` is the ball that the shading point is inside of, whose
    /// pairs are then the only ones.
    pub fn sample(
        &self,
        ctx: &LightSampleContext,
        inside: Option<u32>,
        [u, u_worth]: [f64; 2],
        u_light: impl FnOnce() -> f64,
    ) -> CasterPairs {
        let mut chosen = CasterPairs::default();
        if !self.needs_choice() {
            let accept = |(caster, light): (u32, ConnectedLight)| {
                let n = self.index_of(caster, light) as u32;
                let pmf = self.worth((caster, light), inside.is_some(), ctx.hit.point);
                is_accepted(u_worth, n, pmf).then_some(CasterPair { n, caster, light, pmf })
            };
            for (slot, pair) in chosen.list.iter_mut().zip(self.pairs(inside)) {
                *slot = accept(pair);
            }
            return chosen;
        }
        let pair = match &self.trees {
            Some(trees) => trees.sample(ctx, inside, [u, u_light()]),
            None => self.sample_few(ctx, inside, u),
        };
        chosen.list[0] = pair.and_then(|pair| {
            let of = (pair.caster, pair.light);
            let worth = self.worth(of, inside.is_some(), ctx.hit.point);
            let chosen = CasterPair { pmf: pair.pmf * worth, ..pair };
            is_accepted(u_worth, 0, worth).then_some(chosen)
        });
        chosen
    }

    /// Returns the pairs of [`Self::sample`] where all are tried, at a point outside of all balls,
    /// from the set of those accepted: bit n is the n-th of [`Self::worths`].
    pub fn accepted(&self, set: u32, x: DVec3) -> CasterPairs {
        let mut chosen = CasterPairs::default();
        for (n, (caster, light)) in (0..).zip(self.pairs(None)) {
            if set >> n & 1 != 0 {
                let pmf = self.worth((caster, light), false, x);
                chosen.list[n as usize] = Some(CasterPair { n, caster, light, pmf });
            }
        }
        chosen
    }

    /// Returns the probability with which [`Self::sample`] chooses a pair.
    pub fn pmf(
        &self,
        ctx: &LightSampleContext,
        inside: Option<u32>,
        (caster, light): (u32, ConnectedLight),
    ) -> f64 {
        let worth = self.worth((caster, light), inside.is_some(), ctx.hit.point);
        worth * self.choice_pmf(ctx, inside, (caster, light))
    }

    /// Returns the probability with which a pair is considered.
    pub(super) fn choice_pmf(
        &self,
        ctx: &LightSampleContext,
        inside: Option<u32>,
        (caster, light): (u32, ConnectedLight),
    ) -> f64 {
        if inside.is_some_and(|inside| inside != caster) {
            return 0.0;
        }
        match &self.trees {
            _ if !self.needs_choice() => 1.0,
            Some(trees) => trees.pmf(ctx, inside, (caster, light)),
            None => self.few_pmf(ctx, inside, (caster, light)),
        }
    }

    pub(super) fn index_of(&self, caster: u32, light: ConnectedLight) -> usize {
        let in_lights = match light {
            ConnectedLight::Emitter(index) => index as usize,
            ConnectedLight::Sun => self.emitters.len(),
        };
        (caster as usize).saturating_mul(self.light_count()).saturating_add(in_lights)
    }
}
