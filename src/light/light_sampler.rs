//! Selects the emitter to sample.

use std::f64::consts::PI;

use crate::color::luminance;
use crate::fault::fault;
use crate::geometry::SphereSet;
use crate::names::named_enum;
use crate::sampling::DiscreteDistribution;

use super::context::LightSampleContext;
use super::cut::EmitterCuts;
use super::emitter::Emitter;
use super::light_bounds::{LightBounds, LightItem};
use super::light_tree::{LightTree, MAX_LIGHTS};

/// Up to this many emitters are evaluated one by one.
const MAX_EXHAUSTIVE: usize = 8;
/// In the exhaustive strategy, the fraction of samples split evenly among the emitters above the
/// horizon: an emitter that looks important may be occluded.
const UNIFORM_FRACTION: f64 = 0.1;

/// Strategy for selecting emitters. All strategies have the same expected picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LightSamplerKind {
    /// By estimated contribution to the shading point, using a light tree.
    #[default]
    Hierarchy,
    /// By power, independent of the shading point.
    Power,
    /// Uniformly.
    Uniform,
}

named_enum! { LightSamplerKind { Hierarchy = "hierarchy", Power = "power", Uniform = "uniform" } }

/// The emitters' selection probabilities.
#[derive(Debug, Default)]
pub(super) struct LightSampler {
    strategy: Strategy,
    /// Total power; cluster importances are relative to it.
    total_power: f64,
}

#[derive(Debug, Default)]
enum Strategy {
    #[default]
    Empty,
    /// Exactly one emitter.
    Single(LightBounds),
    /// Probabilities independent of the shading point.
    Fixed(DiscreteDistribution, LightBounds),
    /// At most `MAX_EXHAUSTIVE` emitters.
    Exhaustive(Vec<LightBounds>),
    Tree(LightTree),
}

impl LightSampler {
    /// Of emitters that are cut, only the part counts that can be seen.
    pub(super) fn new(
        emitters: &[Emitter],
        cuts: &EmitterCuts,
        spheres: &SphereSet,
        kind: LightSamplerKind,
    ) -> Self {
        let item = |(emitter, emitter_index): (&Emitter, u32)| {
            let sphere = cuts.bounds(emitter_index as usize, &spheres.sphere(emitter.id));
            let area = PI * sphere.radius * sphere.radius;
            let power = area * f64::from(luminance(emitter.emission));
            LightItem { sphere, power, emitter_index }
        };
        let mut items: Vec<LightItem> = emitters.iter().zip(0..).map(item).collect();
        let total_power: f64 = items.iter().map(|item| item.power).sum();
        items.iter_mut().for_each(|item| item.power /= total_power);
        let kind = if items.len() > MAX_LIGHTS { LightSamplerKind::Power } else { kind };
        let strategy = match kind {
            _ if items.is_empty() => Strategy::Empty,
            _ if items.len() == 1 => Strategy::Single(total_bounds(&items)),
            LightSamplerKind::Hierarchy if items.len() <= MAX_EXHAUSTIVE => {
                let bounds =
                    |item: &LightItem| LightBounds::enclosing(item.sphere.center, &[*item]);
                Strategy::Exhaustive(items.iter().map(bounds).collect())
            }
            LightSamplerKind::Hierarchy => Strategy::Tree(LightTree::new(items)),
            LightSamplerKind::Power => fixed_strategy(&items, |item| item.power),
            LightSamplerKind::Uniform => fixed_strategy(&items, |_| 1.0),
        };
        Self { strategy, total_power }
    }

    /// Expected irradiance from all emitters.
    pub(super) fn importance(&self, ctx: &LightSampleContext) -> f64 {
        self.total_power
            * match &self.strategy {
                Strategy::Empty => 0.0,
                Strategy::Single(emitter) => emitter.importance(ctx),
                Strategy::Fixed(_, all) => all.importance(ctx),
                Strategy::Exhaustive(emitters) => {
                    emitters.iter().map(|emitter| emitter.importance(ctx)).sum()
                }
                Strategy::Tree(tree) => tree.importance(ctx),
            }
    }

    /// Selects an emitter by `u` in `[0, 1)`; returns its index and probability. `None` if all
    /// candidates are below the horizon.
    pub(super) fn sample(&self, ctx: &LightSampleContext, u: f64) -> Option<(usize, f64)> {
        match &self.strategy {
            Strategy::Empty => None,
            Strategy::Single(_) => Some((0, 1.0)),
            Strategy::Fixed(distribution, _) => {
                let emitter = distribution.sample(u);
                Some((emitter, distribution.pmf(emitter)))
            }
            Strategy::Exhaustive(emitters) => ExhaustiveSampler::new(emitters, ctx)?.sample(u),
            Strategy::Tree(tree) => {
                tree.sample(ctx, u).map(|(emitter, pmf)| (emitter as usize, pmf))
            }
        }
    }

    /// Returns the probability with which [`Self::sample`] selects an emitter.
    pub(super) fn pmf(&self, ctx: &LightSampleContext, emitter: usize) -> f64 {
        match &self.strategy {
            Strategy::Empty => 0.0,
            Strategy::Single(_) => 1.0,
            Strategy::Fixed(distribution, _) => distribution.pmf(emitter),
            Strategy::Exhaustive(emitters) if fault!(LightPmfUniform) => {
                1.0 / emitters.len() as f64
            }
            Strategy::Exhaustive(emitters) => {
                ExhaustiveSampler::new(emitters, ctx).map_or(0.0, |sampler| sampler.pmf(emitter))
            }
            Strategy::Tree(tree) => tree.pmf(ctx, emitter as u32),
        }
    }
}

fn fixed_strategy(items: &[LightItem], weight: impl Fn(&LightItem) -> f64) -> Strategy {
    let distribution = DiscreteDistribution::new(items.iter().map(weight));
    distribution
        .map_or(Strategy::Empty, |distribution| Strategy::Fixed(distribution, total_bounds(items)))
}

/// Bounds all emitters as one cluster.
fn total_bounds(items: &[LightItem]) -> LightBounds {
    let center = items.iter().map(|item| item.sphere.center / items.len() as f64).sum();
    LightBounds::enclosing(center, items)
}

/// A few emitters with their importance at a shading point.
struct ExhaustiveSampler {
    importance: [f64; MAX_EXHAUSTIVE],
    total: f64,
    /// Added to the probability of each emitter above the horizon.
    uniform_probability: f64,
}

impl ExhaustiveSampler {
    fn new(emitters: &[LightBounds], ctx: &LightSampleContext) -> Option<Self> {
        let mut importance = [0.0; MAX_EXHAUSTIVE];
        for (importance, emitter) in importance.iter_mut().zip(emitters) {
            *importance = emitter.importance(ctx);
        }
        let total = importance.iter().sum();
        let above_horizon = importance.iter().filter(|&&importance| importance > 0.0).count();
        (total > 0.0).then(|| Self {
            importance,
            total,
            uniform_probability: UNIFORM_FRACTION / above_horizon as f64,
        })
    }

    fn sample(&self, mut u: f64) -> Option<(usize, f64)> {
        let mut last = None;
        for emitter in 0..MAX_EXHAUSTIVE {
            let pmf = self.pmf(emitter);
            if pmf > 0.0 {
                last = Some((emitter, pmf));
                if u < pmf {
                    break;
                }
                u -= pmf;
            }
        }
        last
    }

    fn pmf(&self, emitter: usize) -> f64 {
        let importance = self.importance[emitter];
        if importance <= 0.0 {
            return 0.0;
        }
        self.uniform_probability + (1.0 - UNIFORM_FRACTION) * importance / self.total
    }
}
