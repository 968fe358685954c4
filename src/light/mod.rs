//! What shines: emissive spheres and the background, and the choice among them.
//!
//! Whoever gathers light at a point ([`Receiver`]) asks for a direction that light may come from
//! ([`Lights::sample`]), or, for a direction that it found otherwise, for the density with which it
//! would have been given ([`Lights::pdf`]). That density may be 0 for light that is best left to
//! chance, such as a background of one colour; by chance it must then be found.

mod background;
mod choice;
mod cluster;
mod lamp;
mod receiver;
mod shares;
mod tree;

pub use background::{Background, Dome, Orientation, Sky, Sun};
pub use choice::LightChoice;
pub use lamp::Lamp;
pub use receiver::Receiver;

use std::sync::Arc;

use crate::color::Rgb;
use crate::geometry::SphereSet;
use crate::math::{DVec3, NO_SPHERE};

use choice::Choice;
use lamp::View;
use shares::{Kind, Shares};

/// All lights of a scene.
#[derive(Debug, Default)]
pub struct Lights {
    /// Sorted by id.
    lamps: Arc<[Lamp]>,
    choice: Choice,
    background: Arc<Background>,
}

/// Where light comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// An emissive sphere, by its id.
    Lamp(u32),
    /// Nothing that can be met.
    Background,
}

/// A direction that light may come from.
#[derive(Clone, Copy, Debug)]
pub struct LightSample {
    /// What shines there.
    pub source: Source,
    /// Unit direction.
    pub direction: DVec3,
    /// Distance to the lamp's surface in that direction; infinite for the background.
    pub distance: f64,
    /// The radiance that arrives if nothing is in the way.
    pub radiance: Rgb,
    /// Probability of the source times the density of the direction per solid angle.
    pub pdf: f64,
}

impl Source {
    /// The sphere that a shadow ray to this source aims at.
    pub fn sphere(self) -> u32 {
        match self {
            Self::Lamp(id) => id,
            Self::Background => NO_SPHERE,
        }
    }
}

impl Lights {
    /// The lamps among `spheres`, before a background, chosen by their hierarchy.
    pub fn new(mut lamps: Vec<Lamp>, spheres: &SphereSet, background: Background) -> Self {
        lamps.sort_unstable_by_key(|lamp| lamp.id);
        Self::chosen_by(LightChoice::Hierarchy, lamps.into(), spheres, Arc::new(background))
    }

    /// Lamps sorted by their ids, with a way to choose among them.
    pub fn chosen_by(
        by: LightChoice,
        lamps: Arc<[Lamp]>,
        spheres: &SphereSet,
        background: Arc<Background>,
    ) -> Self {
        debug_assert!(lamps.is_sorted_by_key(|lamp| lamp.id));
        let choice = Choice::new(&lamps, spheres, by);
        Self { lamps, choice, background }
    }

    /// Number of lamps.
    pub fn len(&self) -> usize {
        self.lamps.len()
    }

    /// Whether [`Self::sample`] heeds the number that chooses.
    pub fn has_choice(&self) -> bool {
        self.lamps.len() > 1 || self.background.is_aimed_at()
    }

    /// The lamp, where there is one and nothing else to aim at.
    pub fn only_lamp(&self) -> Option<&Lamp> {
        if self.has_choice() { None } else { self.lamps.first() }
    }

    /// Whether the scene has no lamp.
    pub fn is_empty(&self) -> bool {
        self.lamps.is_empty()
    }

    /// All lamps, sorted by id.
    pub fn lamps(&self) -> &[Lamp] {
        &self.lamps
    }

    /// What a ray sees that meets nothing.
    pub fn background(&self) -> &Background {
        &self.background
    }

    /// A direction that light may come from, from `choose` and `u` in `[0, 1)`; `None` where what
    /// was chosen cannot be seen from there.
    pub fn sample(
        &self,
        spheres: &SphereSet,
        from: &Receiver,
        choose: f64,
        u: [f64; 2],
    ) -> Option<LightSample> {
        let shares = self.shares(from)?;
        let (kind, share, choose) = shares.choose(choose);
        let direction = match kind {
            Kind::Lamps => return self.sample_lamp(spheres, from, share, choose, u),
            Kind::Dome => self.background.sample(u)?,
            Kind::Sun => self.background.sun()?.sample(u),
        };
        let source = Source::Background;
        let pdf = self.pdf_of_background(&shares, direction);
        let radiance = self.background.radiance(direction);
        let sample = LightSample { source, direction, distance: f64::INFINITY, radiance, pdf };
        (pdf > 0.0).then_some(sample)
    }

    fn sample_lamp(
        &self,
        spheres: &SphereSet,
        from: &Receiver,
        share: f64,
        choose: f64,
        u: [f64; 2],
    ) -> Option<LightSample> {
        let (index, pmf) = self.choice.sample(from, choose)?;
        let Lamp { id, emission } = self.lamps[index];
        let view = View::new(from, id, &spheres.sphere(id))?;
        let (direction, distance, pdf) = view.sample(u);
        let pdf = pdf * pmf * share;
        let source = Source::Lamp(id);
        (pdf > 0.0).then_some(LightSample { source, direction, distance, radiance: emission, pdf })
    }

    /// The density with which [`Self::sample`] gives this direction for this source, which it must
    /// meet; 0 for a sphere that is not a lamp and for what is left to chance.
    pub fn pdf(
        &self,
        spheres: &SphereSet,
        from: &Receiver,
        source: Source,
        direction: DVec3,
    ) -> f64 {
        let Some(shares) = self.shares(from) else { return 0.0 };
        let Source::Lamp(id) = source else {
            return self.pdf_of_background(&shares, direction);
        };
        let Ok(index) = self.lamps.binary_search_by_key(&id, |lamp| lamp.id) else { return 0.0 };
        let view = View::new(from, id, &spheres.sphere(id));
        let pmf = || shares.of(Kind::Lamps) * self.choice.pmf(from, index);
        view.map_or(0.0, |view| view.pdf(direction) * pmf())
    }

    /// The probability that [`Self::sample`] aims at the background and not at a lamp.
    pub fn share_of_background(&self, from: &Receiver) -> f64 {
        let share = |shares: Shares| shares.of(Kind::Dome) + shares.of(Kind::Sun);
        self.shares(from).map_or(0.0, share)
    }

    fn shares(&self, from: &Receiver) -> Option<Shares> {
        Shares::new(&self.choice, !self.is_empty(), &self.background, from)
    }

    /// A direction to the sun is also one to the dome, so their densities add up.
    fn pdf_of_background(&self, shares: &Shares, direction: DVec3) -> f64 {
        let dome = shares.of(Kind::Dome);
        let dome = if dome > 0.0 { dome * self.background.pdf(direction) } else { 0.0 };
        let sun = self.background.sun().map_or(0.0, |sun| sun.pdf(direction));
        dome + shares.of(Kind::Sun) * sun
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Side, Sphere, SurfaceHit};
    use crate::sampling::Sampler;
    use cluster::Item;

    /// Lamps of very different sizes and powers in a unit box.
    pub(super) fn items(count: usize) -> Vec<Item> {
        let item = |lamp: u32| {
            let u: [f64; 5] =
                std::array::from_fn(|d| Sampler::new(0, lamp.into(), 0).get(d as u32));
            let center = DVec3::new(u[0], u[1], u[2]);
            Item { sphere: Sphere { center, radius: 0.1 * u[3].powi(4) + 1e-9 }, power: u[4], lamp }
        };
        (0..count as u32).map(item).collect()
    }

    /// Points among the lamps and far from them, facing anywhere, one-sided and two-sided.
    pub(super) fn receivers() -> impl Iterator<Item = Receiver> {
        (0..40u32).map(|i| {
            let u: [f64; 6] = std::array::from_fn(|d| Sampler::new(1, i.into(), 0).get(d as u32));
            let normal = (DVec3::new(u[0], u[1], u[2]) - 0.5).normalize();
            let scale = if i < 20 { 1.0 } else { 50.0 };
            let point = (DVec3::new(u[3], u[4], u[5]) - 0.5) * scale + 0.5;
            let side = if i % 3 == 0 { Side::Inside } else { Side::Outside };
            let hit = SurfaceHit { id: 0, t: 1.0, point, normal, radius: 1.0, side };
            Receiver { hit, is_two_sided: i % 2 == 0 }
        })
    }
}
