//! Finds out, before rendering, if a scene may have dielectric boundaries that light passes in a
//! straight line. Shadow rays pass them; in other scenes, an occlusion query is enough.

use rayon::prelude::*;

use crate::geometry::{Sphere, SphereSet};
use crate::material::{Material, Medium, Model};

/// More dielectric spheres than this are not compared with each other.
const MAX_SPHERES: usize = 100_000;

/// More comparisons of two spheres than this are not made.
const MAX_COMPARISONS: usize = 20_000_000;

/// Returns false only if every dielectric boundary of a scene bends light. `medium` returns the
/// medium inside a sphere.
pub(super) fn may_exist(
    materials: &[Material],
    spheres: &SphereSet,
    medium: impl Fn(u32) -> Option<Medium> + Sync,
) -> bool {
    let is_like_vacuum = |model: &Model| matches!(model, Model::Dielectric(d) if d.ior == 1.0);
    if materials.iter().any(|material| is_like_vacuum(&material.model)) {
        return true;
    }
    let ids = || (0..spheres.len() as u32).into_par_iter();
    if ids().filter(|&id| medium(id).is_some()).count() > MAX_SPHERES {
        return true;
    }
    let with_sphere = |id| Some((spheres.sphere(id), medium(id)?));
    may_exist_among(ids().filter_map(with_sphere).collect())
}

/// Compares the spheres whose extents along x overlap.
fn may_exist_among(mut media: Vec<(Sphere, Medium)>) -> bool {
    let start = |sphere: &Sphere| sphere.center.x - sphere.radius;
    media.sort_unstable_by(|(a, _), (b, _)| start(a).total_cmp(&start(b)));
    let mut comparisons = 0;
    for (index, first) in media.iter().enumerate() {
        let end = first.0.center.x + first.0.radius;
        for second in media[index + 1..].iter().take_while(|(sphere, _)| start(sphere) <= end) {
            comparisons += 1;
            if comparisons > MAX_COMPARISONS || has_straight_boundary(first, second) {
                return true;
            }
        }
    }
    false
}

/// Returns true if one of two dielectric spheres may have a straight boundary because of the other.
/// What the other one fills decides, so two at a time are enough for any number of them.
fn has_straight_boundary(a: &(Sphere, Medium), b: &(Sphere, Medium)) -> bool {
    let ((inner, inner_medium), (outer, outer_medium)) =
        if a.0.radius <= b.0.radius { (a, b) } else { (b, a) };
    let distance = inner.center.distance(outer.center);
    if distance > inner.radius + outer.radius {
        return false;
    }
    // If the inner sphere is wholly inside and not hidden there, only equal indices are straight.
    let is_nested = distance + inner.radius < outer.radius;
    !is_nested
        || inner_medium.priority < outer_medium.priority
        || inner_medium.ior == outer_medium.ior
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Rgb;
    use crate::math::DVec3;

    fn ball(x: f64, radius: f64, ior: f64, priority: i32) -> (Sphere, Medium) {
        let sphere = Sphere { center: DVec3::new(x, 0.0, 0.0), radius };
        (sphere, Medium { sphere: 0, priority, ior, absorption: Rgb::ZERO })
    }

    #[test]
    fn glass_apart_or_nested_in_other_glass_has_none() {
        assert!(!may_exist_among(vec![]));
        assert!(!may_exist_among(vec![ball(0.0, 1.0, 1.5, 0)]));
        assert!(!may_exist_among(vec![ball(3.0, 1.0, 1.5, 0), ball(0.0, 1.0, 1.5, 0)]));
        let water = ball(0.0, 2.0, 1.33, 0);
        assert!(!may_exist_among(vec![water, ball(0.5, 1.0, 1.5, 0), ball(5.0, 1.0, 1.5, 0)]));
        assert!(!may_exist_among(vec![ball(0.5, 1.0, 1.5, 3), water]));
    }

    #[test]
    fn overlaps_equal_indices_and_lower_priorities_are_found() {
        let water = ball(0.0, 2.0, 1.33, 0);
        assert!(may_exist_among(vec![water, ball(2.5, 1.0, 1.5, 0)]), "they overlap");
        assert!(may_exist_among(vec![ball(-2.5, 1.0, 1.5, 0), water]), "they overlap");
        assert!(may_exist_among(vec![water, ball(3.0, 1.0, 1.5, 0)]), "they touch");
        assert!(may_exist_among(vec![water, ball(0.5, 1.0, 1.33, 0)]), "equal indices");
        assert!(may_exist_among(vec![ball(0.5, 1.0, 1.5, -1), water]), "hidden");
    }

    #[test]
    fn too_many_comparisons_find_something() {
        let apart = |i: u32| {
            let center = DVec3::new(0.0, 3.0 * f64::from(i), 0.0);
            let (sphere, medium) = ball(0.0, 1.0, 1.5, 0);
            (Sphere { center, ..sphere }, medium)
        };
        assert!(!may_exist_among((0..1000).map(apart).collect()));
        assert!(may_exist_among((0..8000).map(apart).collect()));
    }
}
