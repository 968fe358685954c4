//! Rays that cross the boundary of a glass ball.

use crate::geometry::Sphere;
use crate::verify::closed_forms::reference_image::{ReferenceRay, normal};

/// Returns the ray that goes on behind the boundary of a glass ball, seen from outside or inside,
/// and the share of light that crosses; `None` if the ray misses or is reflected totally. `n` is
/// the index of refraction inside over that outside.
pub(super) fn cross(ray: ReferenceRay, glass: &Sphere, n: f64) -> Option<(ReferenceRay, f64)> {
    let at = ray.at(ray.hit_distance(glass)?);
    let outward = normal(glass, at);
    let along = ray.direction.dot(outward);
    let (facing, eta) = if along > 0.0 { (-outward, 1.0 / n) } else { (outward, n) };
    let cos = along.abs();
    let square = 1.0 - (1.0 - cos * cos) / (eta * eta);
    if square <= 0.0 {
        return None;
    }
    let cos_behind = square.sqrt();
    let direction = (ray.direction / eta + facing * (cos / eta - cos_behind)).normalize();
    Some((ReferenceRay { origin: at, direction }, 1.0 - fresnel(cos, cos_behind, eta)))
}

/// Fresnel reflectance for unpolarised light, by the cosines before and behind a boundary to a
/// medium with `n` times the index of refraction.
pub(super) fn fresnel(cos: f64, cos_behind: f64, n: f64) -> f64 {
    let perpendicular = (cos - n * cos_behind) / (cos + n * cos_behind);
    let parallel = (n * cos - cos_behind) / (n * cos + cos_behind);
    (perpendicular * perpendicular + parallel * parallel) / 2.0
}
