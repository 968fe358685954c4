//! Which transparent medium a path is in, where glass spheres nest and overlap.
//!
//! A path carries the dielectric spheres that it is inside of. Of these the one with the highest
//! priority fills the space; among equals the one entered last. A boundary that lies within a medium
//! of higher priority is not there for light (Schmidt and Budge 2002, "Simple Nested Dielectrics in
//! Ray Traced Images").

/// How many dielectric spheres a path can be inside of at once.
const CAPACITY: usize = 8;

/// A transparent medium: the inside of one dielectric sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Medium {
    /// The sphere's id.
    pub sphere: u32,
    /// The higher fills the common part of two spheres.
    pub priority: i32,
    /// Index of refraction relative to vacuum.
    pub ior: f64,
}

/// The media that a path is inside of, in the order in which they were entered.
#[derive(Clone, Copy, Debug)]
pub struct Media {
    inside: [Medium; CAPACITY],
    count: u8,
    overflowed: bool,
}

/// What a path finds where it meets a dielectric sphere.
#[derive(Clone, Copy, Debug)]
pub struct Boundary {
    /// The index of refraction beyond over the one before; `None` where the boundary lies hidden in
    /// a medium of higher priority, so that light goes straight on.
    pub eta: Option<f64>,
    /// The media beyond it.
    pub beyond: Media,
}

impl Media {
    /// Outside of everything: vacuum.
    pub const VACUUM: Self = Self {
        inside: [Medium { sphere: u32::MAX, priority: 0, ior: 1.0 }; CAPACITY],
        count: 0,
        overflowed: false,
    };

    /// The boundary of `medium`, met from outside (`entering`) or from inside.
    pub fn meet(&self, medium: Medium, entering: bool) -> Boundary {
        let (outside, inside) = if entering {
            (*self, self.with(medium))
        } else {
            // A path that never noticed entering, at a tangent, is taken to be inside.
            let inside = if self.contains(medium.sphere) { *self } else { self.with(medium) };
            (self.without(medium.sphere), inside)
        };
        let fills = inside.filling().is_some_and(|filling| filling.sphere == medium.sphere);
        let ior = outside.filling().map_or(1.0, |filling| filling.ior);
        let eta = if entering { medium.ior / ior } else { ior / medium.ior };
        let beyond = if entering { inside } else { outside };
        Boundary { eta: fills.then_some(eta), beyond }
    }

    /// These media and one more, entered last. Where there is no room left it is forgotten, and
    /// [`Self::overflowed`] says so.
    pub fn with(mut self, medium: Medium) -> Self {
        match self.inside.get_mut(usize::from(self.count)) {
            Some(free) => {
                *free = medium;
                self.count += 1;
            }
            None => self.overflowed = true,
        }
        self
    }

    /// Whether a medium was ever forgotten for want of room.
    pub fn overflowed(&self) -> bool {
        self.overflowed
    }

    fn without(mut self, sphere: u32) -> Self {
        let count = usize::from(self.count);
        if let Some(at) = self.inside[..count].iter().rposition(|m| m.sphere == sphere) {
            self.inside.copy_within(at + 1..count, at);
            self.count -= 1;
        }
        self
    }

    fn contains(&self, sphere: u32) -> bool {
        self.inside[..usize::from(self.count)].iter().any(|medium| medium.sphere == sphere)
    }

    /// The medium that fills the space; `None` is vacuum. `max_by_key` keeps the last of equals.
    fn filling(&self) -> Option<&Medium> {
        self.inside[..usize::from(self.count)].iter().max_by_key(|medium| medium.priority)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WATER: Medium = Medium { sphere: 1, priority: 0, ior: 1.33 };
    const GLASS: Medium = Medium { sphere: 2, priority: 1, ior: 1.5 };

    #[test]
    fn a_bubble_entered_last_wins_among_equals() {
        let bubble = Medium { sphere: 7, priority: 1, ior: 1.0 };
        let in_glass = Media::VACUUM.with(GLASS);
        let boundary = in_glass.meet(bubble, true);
        assert_eq!(boundary.eta, Some(1.0 / 1.5));
        assert_eq!(boundary.beyond.meet(bubble, false).eta, Some(1.5));
    }

    #[test]
    fn glass_reaching_into_water_hides_the_waters_boundary() {
        // Through glass, out into the water that overlaps it, and on into the air.
        let in_glass = Media::VACUUM.meet(GLASS, true).beyond;
        let hidden = in_glass.meet(WATER, true);
        assert_eq!(hidden.eta, None);
        let leaving_glass = hidden.beyond.meet(GLASS, false);
        assert_eq!(leaving_glass.eta, Some(1.33 / 1.5));
        assert_eq!(leaving_glass.beyond.meet(WATER, false).eta, Some(1.0 / 1.33));
    }

    #[test]
    fn leaving_what_was_never_entered_refracts_as_from_inside() {
        assert_eq!(Media::VACUUM.meet(GLASS, false).eta, Some(1.0 / 1.5));
    }

    #[test]
    fn overflow_is_remembered() {
        let full = (0..8).fold(Media::VACUUM, |m, i| m.with(Medium { sphere: i, ..WATER }));
        assert!(!full.overflowed());
        assert!(full.with(GLASS).overflowed());
    }
}
