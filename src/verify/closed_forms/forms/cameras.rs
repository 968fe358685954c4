//! Images of cameras other than a pinhole.

use std::f64::consts::PI;

use crate::scene::PreparedScene;
use crate::scene::description::ProjectionDescription;
use crate::verify::closed_forms::reference_image::spheres;
use crate::verify::quadrature::integral;

use super::{emission, uniform_solution};

/// The mean over the lens of the fraction of the focal plane that the emitter covers.
pub(super) fn lens(prepared: &PreparedScene, nodes: usize) -> Vec<Option<f64>> {
    let camera = &prepared.description().camera;
    let ProjectionDescription::Perspective { vertical_fov_degrees, lens: Some(lens) } =
        camera.projection
    else {
        return uniform_solution(prepared, f64::NAN);
    };
    let emitter = spheres(prepared)[0];
    let f = lens.focus_distance;
    let k_squared =
        emitter.center.distance_squared(camera.position) - emitter.radius * emitter.radius;
    let covered = |p: f64| {
        let k_cubed = k_squared * k_squared.sqrt();
        PI * (f * emitter.radius) * (f * emitter.radius) * (p * p + k_squared).sqrt() / k_cubed
    };
    let mean = integral(0.0, 1.0, nodes, |radius| 2.0 * radius * covered(radius * lens.radius));
    let side = 2.0 * f * libm::tan(vertical_fov_degrees.to_radians() / 2.0);
    uniform_solution(prepared, emission(prepared, "lamp") * mean / (side * side))
}
