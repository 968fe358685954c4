//! Shares of a picture that depend on the last digits of spheres.

use std::f64::consts::PI;

use crate::scene::PreparedScene;
use crate::scene::description::ProjectionDescription;
use crate::verify::closed_forms::reference_image::spheres;
use crate::verify::quadrature::integral;

use super::{background_radiance, emission, uniform_solution};

/// The disc inside the circle in which the lamp and the wall intersect.
pub(super) fn protruding_cap(prepared: &PreparedScene, _: usize) -> Vec<Option<f64>> {
    let spheres = spheres(prepared);
    let [wall, lamp] = [&spheres[0], &spheres[1]];
    let d = wall.center.distance(lamp.center);
    let plane = (d * d + (wall.radius - lamp.radius) * (wall.radius + lamp.radius)) / (2.0 * d);
    let squared = (wall.radius - plane) * (wall.radius + plane);
    let side = height(prepared);
    uniform_solution(prepared, emission(prepared, "lamp") * PI * squared / (side * side))
}

/// The sky above the horizon of the only sphere, whose centre is straight below the camera.
pub(super) fn horizon(prepared: &PreparedScene, nodes: usize) -> Vec<Option<f64>> {
    let camera = &prepared.description().camera;
    let ProjectionDescription::Perspective { vertical_fov_degrees, .. } = camera.projection else {
        return uniform_solution(prepared, f64::NAN);
    };
    let planet = spheres(prepared)[0];
    let (radius, height) = (planet.radius, camera.position.y - planet.center.y - planet.radius);
    // tan d, from the tangent's length and the radius.
    let dip = (height * (2.0 * radius + height)).sqrt() / radius;
    let half = libm::tan(vertical_fov_degrees.to_radians() / 2.0);
    let length = integral(0.0, 1.0, nodes, |x| (1.0 + (x * half) * (x * half)).sqrt());
    uniform_solution(prepared, background_radiance(prepared) * (0.5 + 0.5 * dip / half * length))
}

/// The gap between two balls above each other.
pub(super) fn narrow_gap(prepared: &PreparedScene, _: usize) -> Vec<Option<f64>> {
    let spheres = spheres(prepared);
    let [upper, lower] = [&spheres[0], &spheres[1]];
    let gap = (upper.center.y - upper.radius) - (lower.center.y + lower.radius);
    uniform_solution(prepared, background_radiance(prepared) * gap / height(prepared))
}

/// Height of an orthographic picture.
fn height(prepared: &PreparedScene) -> f64 {
    match prepared.description().camera.projection {
        ProjectionDescription::Orthographic { height } => height,
        _ => f64::NAN,
    }
}
