//! The cuts of all emitters, and the caps that they leave exposed.

use crate::geometry::{Cap, Side, Sphere, SphereCut, SphereSet};
use crate::math::{DVec3, NO_SPHERE};

use super::super::emitter::Emitter;
use super::enclosure::Enclosure;
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
    /// True if all points that are shaded are on that side.
    is_certain: bool,
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
        is_certain: true,
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

    /// Returns a sphere around the part of the emitter that can be seen from any point, no larger
    /// than the emitter itself.
    fn bounds(&self, emitter: &Sphere) -> Sphere {
        let certain = self.by_side.iter().filter(|cut| cut.is_certain);
        let smallest = certain.min_by(|a, b| a.cap.height().total_cmp(&b.cap.height()));
        smallest.map_or(*emitter, |cut| cut.cap.bounds(emitter))
    }
}

impl EmitterCuts {
    /// Finds the cuts of all emitters, given in order, by the spheres that are opaque. Points are
    /// inside none of these but the enclosures.
    pub fn find(
        emitters: &[Emitter],
        spheres: &SphereSet,
        is_opaque: impl Fn(u32) -> bool + Sync,
        enclosures: &[Enclosure],
    ) -> Self {
        let enclosure = |id| enclosures.iter().find(|enclosure| enclosure.id == id);
        let is_outside = |id| is_opaque(id) && enclosure(id).is_none();
        let mut found = search::outside_cuts(emitters, spheres, &is_outside);
        found.extend(search::inside_cuts(emitters, spheres, enclosures));
        found.sort_by_key(|found| found.emitter);
        let mut all = Self::default();
        for found in found {
            let emitter = spheres.sphere(emitters[found.emitter as usize].id);
            let opaque = spheres.sphere(found.id);
            let Some(cut) = SphereCut::new(&emitter, &opaque) else { continue };
            if all.emitters.last() != Some(&found.emitter) {
                all.emitters.push(found.emitter);
                all.cuts.push(EmitterCut { by_side: [OpaqueCut::NONE; 2] });
            }
            if let Some(last) = all.cuts.last_mut() {
                let (id, side, cap) = (found.id, found.side, cut.exposed_cap(found.side));
                let is_certain = enclosure(id).is_none_or(|enclosure| enclosure.is_certain);
                last.by_side[side as usize] = OpaqueCut { id, opaque, side, cap, is_certain };
            }
        }
        all.cuts.shrink_to_fit();
        all.emitters.shrink_to_fit();
        all
    }

    /// Returns a sphere around the part of an emitter that can be seen from any point that is
    /// shaded: the emitter itself, or a smaller one.
    pub(in super::super) fn bounds(&self, index: usize, emitter: &Sphere) -> Sphere {
        self.of_emitter(index).map_or(*emitter, |cut| cut.bounds(emitter))
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

    /// Height of the cap of the first sphere, which emits, that a point sees. The point is inside
    /// the spheres that it is inside of, and no other point is anywhere.
    fn height(others: &[Sphere], is_opaque: fn(&Sphere) -> bool, point: DVec3) -> f64 {
        let spheres = set([&[ball(0.0, 1.0)], others].concat());
        let id = (0..).find(|&id| spheres.row(id) == 0).expect("the first row");
        let opaque = |id| is_opaque(&spheres.sphere_as_written(id));
        let point = point - spheres.origin();
        let around = |&id: &u32| opaque(id) && spheres.sphere(id).contains(point);
        let enclosures: Vec<Enclosure> = (0..spheres.len() as u32)
            .filter(around)
            .map(|id| Enclosure { id, is_certain: true })
            .collect();
        let cuts = EmitterCuts::find(&emitters([id]), &spheres, opaque, &enclosures);
        let cut = cuts.of_emitter(0);
        let height =
            cut.map_or(2.0, |cut| cut.exposed_cap(NO_SPHERE, point, Side::Outside).height());
        let bounds = cuts.bounds(0, &spheres.sphere(id));
        let rim = if height < 1.0 { (height * (2.0 - height)).sqrt() } else { 1.0 };
        assert!((bounds.radius - rim).abs() < 1e-9, "{height}: {bounds:?}");
        height
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
        // A rim of radius 0.9, at x = 0.436, on a sphere of that radius.
        let by_a_smaller_one = seen(&[ball(-0.19f64.sqrt(), 0.9)]);
        assert!((by_a_smaller_one - 1.0 - 0.19f64.sqrt()).abs() < 1e-12, "{by_a_smaller_one}");
    }

    #[test]
    fn the_smallest_cap_on_the_side_of_the_point_is_seen() {
        // A wall to the left with a solid half space behind it, and a room to the right of x = 0.8.
        let others = [ball(-100.2, 100.0), ball(1000.8, 1000.0)];
        let seen = |x: f64| height(&others, |_| true, DVec3::new(x, 5.0, 0.0));
        let (in_the_room, in_the_wall) = (seen(3.0), seen(-1.0));
        assert!((0.199..0.2).contains(&in_the_room), "{in_the_room}");
        assert!((0.79..0.81).contains(&in_the_wall), "{in_the_wall}");
        let no_room = height(&others[..1], |_| true, DVec3::new(3.0, 5.0, 0.0));
        assert!((1.2..1.21).contains(&no_room), "{no_room}");
        // Rooms of any size: the smaller of two, of which one is much smaller than the emitter.
        let rooms = [ball(-5.1, 5.0), ball(-1.05, 0.2)];
        let in_both = height(&rooms, |_| true, DVec3::new(-1.04, 0.0, 0.0));
        let in_the_large_one = height(&rooms, |_| true, DVec3::new(-3.0, 0.0, 0.0));
        assert!((0.0..0.03).contains(&in_both), "{in_both}");
        assert!((0.8..0.81).contains(&in_the_large_one), "{in_the_large_one}");
    }

    /// Against all pairs, on emitters, spheres and rooms of all sizes.
    #[test]
    fn the_search_finds_what_all_pairs_have() {
        let sphere = |i: u64| {
            let u: [f64; 4] = std::array::from_fn(|d| Sampler::independent(3, i, 0).get(d as u32));
            Sphere { center: DVec3::new(u[0], u[1], u[2]), radius: 0.3 * u[3].powi(4) + 1e-3 }
        };
        let spheres = set((0..5000).map(sphere).collect());
        let emitters = emitters((0..5000).filter(|id| id % 7 == 0));
        let is_opaque = |id: u32| id % 3 != 0;
        let is_enclosure = |id: u32| id % 90 == 1;
        let enclosures: Vec<Enclosure> = (0..5000)
            .filter(|&id| is_enclosure(id))
            .map(|id| Enclosure { id, is_certain: id % 2 == 0 })
            .collect();
        let cuts = EmitterCuts::find(&emitters, &spheres, is_opaque, &enclosures);
        let (mut found, mut by_smaller) = (0, 0);
        for (index, emitter) in emitters.iter().enumerate() {
            let itself = spheres.sphere(emitter.id);
            let smallest = |side: Side| {
                let cut = |id: u32| {
                    let is_side = is_enclosure(id) == (side == Side::Inside);
                    let counts = id != emitter.id && is_opaque(id) && is_side;
                    let opaque = spheres.sphere(id);
                    let cut = SphereCut::new(&itself, &opaque).filter(|_| counts)?;
                    Some((cut.height(side), opaque.radius))
                };
                let enough = (0..5000).filter_map(cut).filter(|(height, _)| *height <= 1.5);
                enough.fold((2.0, f64::MAX), |a, b| if b.0 < a.0 { b } else { a })
            };
            for side in [Side::Outside, Side::Inside] {
                let cap = cuts.of_emitter(index).map(|cut| cut.by_side[side as usize].cap.height());
                let (height, radius) = smallest(side);
                assert_eq!(cap.unwrap_or(2.0), height, "{index} {side:?}");
                found += usize::from(height < 2.0);
                by_smaller += usize::from(radius < itself.radius);
            }
        }
        assert!(found > 300 && by_smaller > 100, "{found} {by_smaller}");
    }
}
