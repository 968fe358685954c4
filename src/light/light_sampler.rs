//! Selects the emitter to sample.

use std::f64::consts::PI;

use crate::color::luminance;
use crate::fault::fault;
use crate::geometry::SphereSet;
use crate::names::named_enum;
use crate::sampling::DiscreteDistribution;

use super::emitter::Emitter;
use super::light_bounds::{LightBounds, LightItem};
use super::light_tree::{LightTree, MAX_LIGHTS};
use super::receiver::LightSampleContext;

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
    pub(super) fn new(lamps: &[Emitter], spheres: &SphereSet, by: LightSamplerKind) -> Self {
        let power = |lamp: &Emitter| {
            let radius = spheres.sphere(lamp.id).radius;
            PI * radius * radius * f64::from(luminance(lamp.emission))
        };
        let total_power: f64 = lamps.iter().map(power).sum();
        let item = |(lamp, i): (&Emitter, u32)| LightItem {
            sphere: spheres.sphere(lamp.id),
            power: power(lamp) / total_power,
            emitter_index: i,
        };
        let items: Vec<LightItem> = lamps.iter().zip(0..).map(item).collect();
        let by = if items.len() > MAX_LIGHTS { LightSamplerKind::Power } else { by };
        let chooser = match by {
            _ if items.is_empty() => Strategy::Empty,
            _ if items.len() == 1 => Strategy::Single(total_bounds(&items)),
            LightSamplerKind::Hierarchy if items.len() <= MAX_EXHAUSTIVE => {
                let alone = |item: &LightItem| LightBounds::enclosing(item.sphere.center, &[*item]);
                Strategy::Exhaustive(items.iter().map(alone).collect())
            }
            LightSamplerKind::Hierarchy => Strategy::Tree(LightTree::new(items)),
            LightSamplerKind::Power => fixed_strategy(&items, |item| item.power),
            LightSamplerKind::Uniform => fixed_strategy(&items, |_| 1.0),
        };
        Self { strategy: chooser, total_power }
    }

    /// Expected irradiance from all emitters.
    pub(super) fn importance(&self, from: &LightSampleContext) -> f64 {
        self.total_power
            * match &self.strategy {
                Strategy::Empty => 0.0,
                Strategy::Single(lamp) => lamp.importance(from),
                Strategy::Fixed(_, all) => all.importance(from),
                Strategy::Exhaustive(lamps) => lamps.iter().map(|lamp| lamp.importance(from)).sum(),
                Strategy::Tree(tree) => tree.importance(from),
            }
    }

    /// Selects an emitter by `u` in `[0, 1)`; returns its index and probability. `None` if the
    /// selected emitters are below the horizon.
    pub(super) fn sample(&self, from: &LightSampleContext, u: f64) -> Option<(usize, f64)> {
        match &self.strategy {
            Strategy::Empty => None,
            Strategy::Single(_) => Some((0, 1.0)),
            Strategy::Fixed(choice, _) => {
                let lamp = choice.sample(u);
                Some((lamp, choice.pmf(lamp)))
            }
            Strategy::Exhaustive(lamps) => ExhaustiveSampler::new(lamps, from)?.sample(u),
            Strategy::Tree(tree) => tree.sample(from, u).map(|(lamp, pmf)| (lamp as usize, pmf)),
        }
    }

    /// Returns the probability with which [`Self::sample`] selects an emitter.
    pub(super) fn pmf(&self, from: &LightSampleContext, lamp: usize) -> f64 {
        match &self.strategy {
            Strategy::Empty => 0.0,
            Strategy::Single(_) => 1.0,
            Strategy::Fixed(choice, _) => choice.pmf(lamp),
            Strategy::Exhaustive(lamps) if fault!(LightPmfUniform) => 1.0 / lamps.len() as f64,
            Strategy::Exhaustive(lamps) => {
                ExhaustiveSampler::new(lamps, from).map_or(0.0, |few| few.pmf(lamp))
            }
            Strategy::Tree(tree) => tree.pmf(from, lamp as u32),
        }
    }
}

fn fixed_strategy(items: &[LightItem], weight: impl Fn(&LightItem) -> f64) -> Strategy {
    let choice = DiscreteDistribution::new(items.iter().map(weight));
    choice.map_or(Strategy::Empty, |choice| Strategy::Fixed(choice, total_bounds(items)))
}

/// Bounds all emitters as one cluster.
fn total_bounds(items: &[LightItem]) -> LightBounds {
    let middle = items.iter().map(|item| item.sphere.center / items.len() as f64).sum();
    LightBounds::enclosing(middle, items)
}

/// A few emitters with their importance at a shading point.
struct ExhaustiveSampler {
    importance: [f64; MAX_EXHAUSTIVE],
    total: f64,
    /// Added to the probability of each emitter above the horizon.
    uniform_probability: f64,
}

impl ExhaustiveSampler {
    fn new(lamps: &[LightBounds], from: &LightSampleContext) -> Option<Self> {
        let mut importance = [0.0; MAX_EXHAUSTIVE];
        for (importance, lamp) in importance.iter_mut().zip(lamps) {
            *importance = lamp.importance(from);
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
        for lamp in 0..MAX_EXHAUSTIVE {
            let pmf = self.pmf(lamp);
            if pmf > 0.0 {
                last = Some((lamp, pmf));
                if u < pmf {
                    break;
                }
                u -= pmf;
            }
        }
        last
    }

    fn pmf(&self, lamp: usize) -> f64 {
        let importance = self.importance[lamp];
        if importance <= 0.0 {
            return 0.0;
        }
        self.uniform_probability + (1.0 - UNIFORM_FRACTION) * importance / self.total
    }
}
