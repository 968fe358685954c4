//! The cuts of all emitters, and the caps that they leave exposed.

use crate::geometry::{Cap, Side, Sphere, SphereCut, SphereSet};
use crate::math::{DVec3, NO_SPHERE};

use super::super::emitter::Emitter;
use super::search;

/// An opaque sphere that cuts an emitter.
#[derive(Clone, Copy, Debug)]
struct OpaqueCut {
    /// Id of the opaque sphere.
    id: u32,
    opaque: Sphere,
    /// The side from which it hides most of the emitter.
    side: Side,
    /// The cap that is exposed on that side.
    cap: Cap,
}

/// The cuts of one emitter: the one that hides most from outside the opaque sphere and the one that
/// hides most from inside. A cut that hides nothing stands for a missing one.
#[derive(Clone, Copy, Debug)]
pub struct EmitterCut {
    by_side: [OpaqueCut; 2],
}

/// The cuts of all emitters.
#[derive(Debug, Default)]
pub struct EmitterCuts {
    cuts: Vec<EmitterCut>,
    /// The indices of the emitters that are cut, ascending.
    emitters: Vec<u32>,
}

impl OpaqueCut {
    const NONE: Self = Self {
        id: NO_SPHERE,
        opaque: Sphere { center: DVec3::ZERO, radius: 0.0 },
        side: Side::Inside,
        cap: Cap::WHOLE,
    };

    /// Returns true if the sphere hides a part of the emitter from a point on the sphere `id`. A
    /// point on the opaque sphere counts by the side of its hit.
    #[inline(always)]
    fn hides_from(&self, id: u32, point: DVec3, hit_side: Side) -> bool {
        let is_inside = self.opaque.contains(point);
        let is_inside = if id == self.id { hit_side == Side::Inside } else { is_inside };
        is_inside == (self.side == Side::Inside)
    }
}

impl EmitterCut {
    /// Returns the smallest cap to which the cuts restrict what is seen of the emitter from a point
    /// on the sphere `id`, hit on `hit_side`; the whole emitter if they hide nothing from there.
    #[inline(always)]
    pub(in super::super) fn exposed_cap(&self, id: u32, point: DVec3, hit_side: Side) -> Cap {
        let [a, b] = &self.by_side;
        let [a_hides, b_hides] = [a, b].map(|cut| cut.hides_from(id, point, hit_side));
        let first = if a_hides { a.cap } else { Cap::WHOLE };
        if b_hides && b.cap.height() < first.height() { b.cap } else { first }
    }
}

impl EmitterCuts {
    /// Finds the cuts of all emitters, given in order, by the spheres that are opaque.
    pub fn find(
        emitters: &[Emitter],
        spheres: &SphereSet,
        is_opaque: impl Fn(u32) -> bool + Sync,
    ) -> Self {
        let mut all = Self::default();
        for found in search::largest_cuts(emitters, spheres, &is_opaque) {
            let emitter = spheres.sphere(emitters[found.emitter as usize].id);
            let opaque = spheres.sphere(found.id);
            let Some(cut) = SphereCut::new(&emitter, &opaque) else { continue };
            if all.emitters.last() != Some(&found.emitter) {
                all.emitters.push(found.emitter);
                all.cuts.push(EmitterCut { by_side: [OpaqueCut::NONE; 2] });
            }
            if let Some(last) = all.cuts.last_mut() {
                let cap = cut.exposed_cap(found.side);
                last.by_side[found.side as usize] =
                    OpaqueCut { id: found.id, opaque, side: found.side, cap };
            }
        }
        all.cuts.shrink_to_fit();
        all.emitters.shrink_to_fit();
        all
    }

    /// Returns the cut of an emitter; `None` if it is whole.
    #[inline]
    pub(in super::super) fn of_emitter(&self, index: usize) -> Option<&EmitterCut> {
        if self.emitters.is_empty() {
            return None; // nearly always
        }
        let cut = self.emitters.binary_search(&(index as u32)).ok()?;
        self.cuts.get(cut)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Rgb;
    use crate::geometry::SphereRows;
    use crate::sampling::Sampler;

    fn set(exact: Vec<Sphere>) -> SphereSet {
        SphereSet::new(SphereRows { exact, table: Vec::new() }).expect("few spheres")
    }

    fn emitters(ids: impl IntoIterator<Item = u32>) -> Vec<Emitter> {
        ids.into_iter().map(|id| Emitter::opaque(id, Rgb::ONE)).collect()
    }

    fn ball(x: f64, radius: f64) -> Sphere {
        Sphere { center: DVec3::new(x, 0.0, 0.0), radius }
    }

    /// Height of the cap of the first sphere, which emits, that a point sees.
    fn height(others: &[Sphere], is_opaque: fn(&Sphere) -> bool, point: DVec3) -> f64 {
        let spheres = set([&[ball(0.0, 1.0)], others].concat());
        let id = (0..).find(|&id| spheres.row(id) == 0).expect("the first row");
        let opaque = |id| is_opaque(&spheres.sphere_as_written(id));
        let cuts = EmitterCuts::find(&emitters([id]), &spheres, opaque);
        let cap = cuts
            .of_emitter(0)
            .map(|cut| cut.exposed_cap(NO_SPHERE, point - spheres.origin(), Side::Outside));
        cap.map_or(2.0, |cap| cap.height())
    }

    #[test]
    fn an_emitter_is_cut_by_opaque_spheres_of_its_size_and_larger() {
        let seen = |others: &[Sphere]| height(others, |_| true, DVec3::new(9.0, 9.0, 0.0));
        assert_eq!(seen(&[]), 2.0);
        assert_eq!(seen(&[ball(-2.5, 1.0), ball(0.0, 5.0)]), 2.0, "apart and around it");
        // The plane of the rim is at x = -0.25.
        let half_hidden = seen(&[ball(-2.0, 2.0)]);
        assert!((half_hidden - 1.25).abs() < 1e-12);
        assert_eq!(seen(&[ball(-2.0, 2.0), ball(-2.4, 1.5), ball(0.8, 0.4)]), half_hidden);
        assert_eq!(height(&[ball(-2.0, 2.0)], |_| false, DVec3::splat(9.0)), 2.0, "glass");
        assert_eq!(height(&[ball(-2.0, 2.0)], |s| s.radius < 1.5, DVec3::splat(9.0)), 2.0);
    }

    #[test]
    fn the_smallest_cap_on_the_side_of_the_point_is_seen() {
        // A wall to the left with a solid half space behind it, and a room to the right of x = 0.8.
        let others = [ball(-100.2, 100.0), ball(1000.8, 1000.0)];
        let seen = |x: f64| height(&others, |_| true, DVec3::new(x, 5.0, 0.0));
        let (in_the_room, in_the_wall) = (seen(3.0), seen(-1.0));
        assert!((0.199..0.2).contains(&in_the_room), "{in_the_room}");
        assert_eq!(in_the_wall, 2.0, "from inside, the room hides more");
        let no_room = height(&others[..1], |_| true, DVec3::new(3.0, 5.0, 0.0));
        assert!((1.2..1.21).contains(&no_room), "{no_room}");
    }

    /// Against all pairs, on emitters and spheres of all sizes.
    #[test]
    fn the_search_finds_what_all_pairs_have() {
        let sphere = |i: u64| {
            let u: [f64; 4] = std::array::from_fn(|d| Sampler::independent(3, i, 0).get(d as u32));
            Sphere { center: DVec3::new(u[0], u[1], u[2]), radius: 0.3 * u[3].powi(4) + 1e-3 }
        };
        let spheres = set((0..5000).map(sphere).collect());
        let emitters = emitters((0..5000).filter(|id| id % 7 == 0));
        let is_opaque = |id: u32| id % 3 != 0;
        let cuts = EmitterCuts::find(&emitters, &spheres, is_opaque);
        let mut found = 0;
        for (index, emitter) in emitters.iter().enumerate() {
            let itself = spheres.sphere(emitter.id);
            let heights = |side| {
                let cut = |id: u32| {
                    let opaque = spheres.sphere(id);
                    let counts =
                        id != emitter.id && is_opaque(id) && opaque.radius >= itself.radius;
                    SphereCut::new(&itself, &opaque).filter(|_| counts).map(|cut| cut.height(side))
                };
                (0..5000).filter_map(cut).filter(|&height| height <= 1.5).fold(2.0, f64::min)
            };
            for side in [Side::Outside, Side::Inside] {
                let cap = cuts.of_emitter(index).map(|cut| cut.by_side[side as usize].cap.height());
                assert_eq!(cap.unwrap_or(2.0), heights(side), "{index} {side:?}");
                found += usize::from(cap.is_some_and(|height| height < 2.0));
            }
        }
        assert!(found > 300, "{found}");
    }
}
