//! Where an occluded shadow ray ends.

use rayon::prelude::*;

use crate::integrator::PathEvent;
use crate::math::DVec3;
use crate::scene::Scene;

/// The sphere that an event's path stands on.
pub(super) fn stands_on(events: &[PathEvent]) -> Option<u32> {
    events.iter().rev().find_map(|event| match event {
        PathEvent::Hit { hit, .. } => Some(hit.id),
        _ => None,
    })
}

/// Distance to the nearest opaque sphere on the way from a point of the sphere `leaving` to a light
/// at `distance`. Points are relative to the spheres' origin. `None` if there is none.
pub(super) fn distance_to_blocker(
    scene: &Scene,
    leaving: Option<u32>,
    (from, direction): (DVec3, DVec3),
    (emitter, distance): (u32, f64),
) -> Option<f64> {
    let root = |id: u32| {
        let is_in_the_way = id != emitter && scene.sphere_material(id).material.opacity >= 1.0;
        let sphere = scene.spheres().sphere(id);
        // The sphere that the ray leaves can only be met again on its far side.
        let start = match leaving == Some(id) {
            true => 1e-6 * sphere.radius,
            false => 0.0,
        };
        is_in_the_way.then(|| sphere.first_root(from, direction, start, distance)).flatten()
    };
    (0..scene.spheres().len() as u32).into_par_iter().filter_map(root).min_by(f64::total_cmp)
}
