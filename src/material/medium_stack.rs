//! The transparent media that a path is inside of, where glass spheres nest and overlap.
//!
//! A path carries the dielectric spheres that it is inside of. The one with the highest priority
//! fills the space; among equals, the one entered last. A boundary inside a medium of higher
//! priority is ignored (Schmidt and Budge 2002, "Simple Nested Dielectrics in Ray Traced Images").
//! The medium that fills the space also absorbs: the fraction `1 - exp(-absorption x distance)` of
//! the light (Beer-Lambert).

use smallvec::SmallVec;

use crate::color::Rgb;
use crate::sampling::exp;

use crate::fault::fault;

/// Number of media stored without an allocation.
const INLINE: usize = 2;

/// A transparent medium: the inside of one dielectric sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Medium {
    /// The sphere's id.
    pub sphere: u32,
    /// The sphere with the higher priority fills the common part of two spheres.
    pub priority: i32,
    /// Index of refraction relative to vacuum.
    pub ior: f64,
    /// Absorption per unit length.
    pub absorption: Rgb,
}

/// The media that a path is inside of, in the order in which they were entered.
#[derive(Clone, Debug)]
pub struct MediumStack {
    entered: SmallVec<[Medium; INLINE]>,
}

/// The boundary that a path meets at a dielectric sphere.
#[derive(Clone, Copy, Debug)]
pub struct Boundary {
    /// Index of refraction beyond over that in front; `None` if the boundary is hidden in a medium
    /// of higher priority, so that light passes straight through.
    pub eta: Option<f64>,
    /// What a path does that goes through.
    pub crossing: Crossing,
}

/// What happens to a path's media where it crosses a boundary.
#[derive(Clone, Copy, Debug)]
pub enum Crossing {
    /// Into this medium.
    Enter(Medium),
    /// Out of the medium of this sphere.
    Leave(u32),
}

impl MediumStack {
    /// Vacuum: outside of every medium.
    pub const VACUUM: Self = Self { entered: SmallVec::new_const() };

    /// Returns the boundary of `medium`, hit from outside (`entering`) or from inside.
    pub fn boundary(&self, medium: Medium, entering: bool) -> Boundary {
        // A path whose entry was missed, near a tangent, is assumed to be inside.
        let own = if entering { None } else { self.position(medium.sphere) };
        let outside = self.filling(own);
        let is_visible = match own {
            Some(_) => self.filling(None).is_some_and(|filling| filling.sphere == medium.sphere),
            None => outside.is_none_or(|filling| {
                filling.priority <= medium.priority || filling.sphere == medium.sphere
            }),
        };
        let ior = outside.map_or(1.0, |filling| filling.ior);
        let eta = if entering { medium.ior / ior } else { ior / medium.ior };
        let eta = if fault!(IorSwapped) { 1.0 / eta } else { eta };
        let crossing =
            if entering { Crossing::Enter(medium) } else { Crossing::Leave(medium.sphere) };
        Boundary { eta: is_visible.then_some(eta), crossing }
    }

    /// Crosses a boundary.
    pub fn cross(&mut self, crossing: Crossing) {
        match crossing {
            Crossing::Enter(medium) => self.entered.push(medium),
            Crossing::Leave(_) if fault!(MediumStackNotPopped) => {}
            Crossing::Leave(sphere) => {
                if let Some(index) = self.position(sphere) {
                    self.entered.remove(index);
                }
            }
        }
    }

    /// Returns the media beyond a boundary.
    #[must_use]
    pub fn beyond(&self, crossing: Crossing) -> Self {
        let mut media = self.clone();
        media.cross(crossing);
        media
    }

    /// Leaves all media and enters others, in order.
    pub fn reset(&mut self, media: impl Iterator<Item = Medium>) {
        self.entered.clear();
        self.entered.extend(media);
    }

    /// Returns the stack with `medium` pushed.
    #[must_use]
    pub fn with(&self, medium: Medium) -> Self {
        self.beyond(Crossing::Enter(medium))
    }

    /// Returns the transmittance over a distance. An infinite distance gives 1: only rounding makes
    /// a ray miss the sphere that it is inside of.
    pub fn transmittance(&self, distance: f64) -> Rgb {
        match self.current() {
            Some(medium) if medium.absorption != Rgb::ZERO && distance.is_finite() => {
                let distance = if fault!(AbsorbedTwice) { 2.0 * distance } else { distance };
                let transmittance = |absorption: f32| exp(-f64::from(absorption) * distance) as f32;
                Rgb::from_array(medium.absorption.to_array().map(transmittance))
            }
            _ => Rgb::ONE,
        }
    }

    /// Returns true if a path is in no dielectric.
    pub fn is_vacuum(&self) -> bool {
        self.entered.is_empty()
    }

    /// Returns the only sphere that a path is inside of; `None` in vacuum and where media overlap.
    pub fn only_sphere(&self) -> Option<u32> {
        match self.entered.as_slice() {
            [medium] => Some(medium.sphere),
            _ => None,
        }
    }

    /// Returns true if a path is inside this sphere.
    pub fn contains(&self, sphere: u32) -> bool {
        self.position(sphere).is_some()
    }

    /// Returns the latest entry of a sphere.
    fn position(&self, sphere: u32) -> Option<usize> {
        self.entered.iter().rposition(|medium| medium.sphere == sphere)
    }

    /// Returns the medium that fills the space; `None` is vacuum.
    fn current(&self) -> Option<&Medium> {
        self.filling(None)
    }

    /// Returns the medium that would fill the space without one of the entries. `max_by_key` keeps
    /// the last of equals.
    fn filling(&self, without: Option<usize>) -> Option<&Medium> {
        let others = self.entered.iter().enumerate().filter(|&(index, _)| Some(index) != without);
        others.map(|(_, medium)| medium).max_by_key(|medium| medium.priority)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ABSORPTION: Rgb = Rgb::new(0.0, 0.5, 2.0);
    const WATER: Medium = Medium { sphere: 1, priority: 0, ior: 1.33, absorption: ABSORPTION };
    const GLASS: Medium = Medium { sphere: 2, priority: 1, ior: 1.5, absorption: Rgb::ZERO };

    #[test]
    fn a_bubble_entered_last_wins_among_equals() {
        let bubble = Medium { sphere: 7, ior: 1.0, ..GLASS };
        let in_glass = MediumStack::VACUUM.with(GLASS);
        let boundary = in_glass.boundary(bubble, true);
        assert_eq!(boundary.eta, Some(1.0 / 1.5));
        assert_eq!(in_glass.beyond(boundary.crossing).boundary(bubble, false).eta, Some(1.5));
    }

    #[test]
    fn glass_reaching_into_water_hides_the_waters_boundary() {
        // Through glass, out into the water that overlaps it, and on into the air.
        let in_glass =
            MediumStack::VACUUM.beyond(MediumStack::VACUUM.boundary(GLASS, true).crossing);
        let hidden = in_glass.boundary(WATER, true);
        assert_eq!(hidden.eta, None);
        let in_both = in_glass.beyond(hidden.crossing);
        let leaving_glass = in_both.boundary(GLASS, false);
        assert_eq!(leaving_glass.eta, Some(1.33 / 1.5));
        let in_water = in_both.beyond(leaving_glass.crossing);
        assert_eq!(in_water.boundary(WATER, false).eta, Some(1.0 / 1.33));
    }

    #[test]
    fn what_fills_the_space_absorbs() {
        let in_water = MediumStack::VACUUM.with(WATER);
        let left = in_water.transmittance(2.0);
        assert_eq!(left.x, 1.0);
        assert!((left.y - f32::exp(-1.0)).abs() < 1e-6 && (left.z - f32::exp(-4.0)).abs() < 1e-6);
        assert_eq!(in_water.with(GLASS).transmittance(2.0), Rgb::ONE, "glass displaces water");
        assert_eq!(MediumStack::VACUUM.with(GLASS).with(WATER).transmittance(2.0), Rgb::ONE);
        assert_eq!(MediumStack::VACUUM.transmittance(f64::INFINITY), Rgb::ONE);
    }

    #[test]
    fn leaving_what_was_never_entered_refracts_as_from_inside() {
        assert_eq!(MediumStack::VACUUM.boundary(GLASS, false).eta, Some(1.0 / 1.5));
    }

    #[test]
    fn any_number_of_media_nest() {
        let shell = |i: u32| Medium { sphere: i, ior: 1.0 + 0.01 * f64::from(i), ..WATER };
        let mut media = MediumStack::VACUUM;
        for i in 0..100 {
            let boundary = media.boundary(shell(i), true);
            let outside = if i == 0 { 1.0 } else { shell(i - 1).ior };
            assert_eq!(boundary.eta, Some(shell(i).ior / outside));
            media.cross(boundary.crossing);
        }
        for i in (0..100).rev() {
            media.cross(media.boundary(shell(i), false).crossing);
        }
        assert!(media.is_vacuum());
    }
}
