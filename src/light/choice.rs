//! Which of the lamps to aim at.

use std::f64::consts::PI;

use crate::color::luminance;
use crate::fault::fault;
use crate::geometry::SphereSet;
use crate::names::named;
use crate::sampling::Discrete;

use super::cluster::{Cluster, Item};
use super::lamp::Lamp;
use super::receiver::Receiver;
use super::tree::{MOST, Tree};

/// So many lamps are looked at one by one.
const FEW: usize = 8;
/// Of few lamps, the share of choices that treats those above the horizon alike: what looks
/// important may be hidden.
const UNIFORM_SHARE: f64 = 0.1;

/// How lamps are chosen. All ways give the same picture in the mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LightChoice {
    /// By the light that they may send to the point in question, through a hierarchy.
    #[default]
    Hierarchy,
    /// By their power, the same for all points.
    Power,
    /// All alike.
    Uniform,
}

named! { LightChoice { Hierarchy = "hierarchy", Power = "power", Uniform = "uniform" } }

/// The lamps with their probabilities.
#[derive(Debug, Default)]
pub(super) struct Choice {
    chooser: Chooser,
    /// What the importance of a cluster is a share of.
    total_power: f64,
}

#[derive(Debug, Default)]
enum Chooser {
    #[default]
    Nothing,
    /// There is none.
    One(Cluster),
    /// The same for all receivers.
    Fixed(Discrete, Cluster),
    /// At most `FEW`.
    Few(Vec<Cluster>),
    Many(Tree),
}

impl Choice {
    pub(super) fn new(lamps: &[Lamp], spheres: &SphereSet, by: LightChoice) -> Self {
        let power = |lamp: &Lamp| {
            let radius = spheres.sphere(lamp.id).radius;
            PI * radius * radius * f64::from(luminance(lamp.emission))
        };
        let total_power: f64 = lamps.iter().map(power).sum();
        let item = |(lamp, i): (&Lamp, u32)| Item {
            sphere: spheres.sphere(lamp.id),
            power: power(lamp) / total_power,
            lamp: i,
        };
        let items: Vec<Item> = lamps.iter().zip(0..).map(item).collect();
        let by = if items.len() > MOST { LightChoice::Power } else { by };
        let chooser = match by {
            _ if items.is_empty() => Chooser::Nothing,
            _ if items.len() == 1 => Chooser::One(around(&items)),
            LightChoice::Hierarchy if items.len() <= FEW => {
                let alone = |item: &Item| Cluster::around(item.sphere.center, &[*item]);
                Chooser::Few(items.iter().map(alone).collect())
            }
            LightChoice::Hierarchy => Chooser::Many(Tree::new(items)),
            LightChoice::Power => fixed(&items, |item| item.power),
            LightChoice::Uniform => fixed(&items, |_| 1.0),
        };
        Self { chooser, total_power }
    }

    /// The irradiance to be expected from all lamps.
    pub(super) fn importance(&self, from: &Receiver) -> f64 {
        self.total_power
            * match &self.chooser {
                Chooser::Nothing => 0.0,
                Chooser::One(lamp) => lamp.importance(from),
                Chooser::Fixed(_, all) => all.importance(from),
                Chooser::Few(lamps) => lamps.iter().map(|lamp| lamp.importance(from)).sum(),
                Chooser::Many(tree) => tree.importance(from),
            }
    }

    /// A lamp's place in the list and its probability, by `u` in `[0, 1)`; `None` where the choice
    /// fell on lamps that have set.
    pub(super) fn sample(&self, from: &Receiver, u: f64) -> Option<(usize, f64)> {
        match &self.chooser {
            Chooser::Nothing => None,
            Chooser::One(_) => Some((0, 1.0)),
            Chooser::Fixed(choice, _) => {
                let lamp = choice.sample(u);
                Some((lamp, choice.pmf(lamp)))
            }
            Chooser::Few(lamps) => Few::new(lamps, from)?.sample(u),
            Chooser::Many(tree) => tree.sample(from, u).map(|(lamp, pmf)| (lamp as usize, pmf)),
        }
    }

    /// The probability with which [`Self::sample`] chooses a lamp.
    pub(super) fn pmf(&self, from: &Receiver, lamp: usize) -> f64 {
        match &self.chooser {
            Chooser::Nothing => 0.0,
            Chooser::One(_) => 1.0,
            Chooser::Fixed(choice, _) => choice.pmf(lamp),
            Chooser::Few(lamps) if fault!(LampsChosenAlike) => 1.0 / lamps.len() as f64,
            Chooser::Few(lamps) => Few::new(lamps, from).map_or(0.0, |few| few.pmf(lamp)),
            Chooser::Many(tree) => tree.pmf(from, lamp as u32),
        }
    }
}

fn fixed(items: &[Item], weight: impl Fn(&Item) -> f64) -> Chooser {
    let choice = Discrete::new(items.iter().map(weight));
    choice.map_or(Chooser::Nothing, |choice| Chooser::Fixed(choice, around(items)))
}

/// All lamps as one cluster.
fn around(items: &[Item]) -> Cluster {
    let middle = items.iter().map(|item| item.sphere.center / items.len() as f64).sum();
    Cluster::around(middle, items)
}

/// A few lamps with their importance at a receiver.
struct Few {
    importance: [f64; FEW],
    total: f64,
    /// Added to the probability of each that has not set.
    uniform: f64,
}

impl Few {
    fn new(lamps: &[Cluster], from: &Receiver) -> Option<Self> {
        let mut importance = [0.0; FEW];
        for (importance, lamp) in importance.iter_mut().zip(lamps) {
            *importance = lamp.importance(from);
        }
        let total = importance.iter().sum();
        let risen = importance.iter().filter(|&&importance| importance > 0.0).count();
        (total > 0.0).then(|| Self { importance, total, uniform: UNIFORM_SHARE / risen as f64 })
    }

    fn sample(&self, mut u: f64) -> Option<(usize, f64)> {
        let mut last = None;
        for lamp in 0..FEW {
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
        self.uniform + (1.0 - UNIFORM_SHARE) * importance / self.total
    }
}
