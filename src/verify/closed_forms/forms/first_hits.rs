//! Images that only the first hit and what is above it decide.

use crate::geometry::Sphere;
use crate::math::DVec3;
use crate::scene::PreparedScene;
use crate::verify::closed_forms::reference_image::{normal, pixel_means, rays, spheres};
use crate::verify::closed_forms::sphere_light::SubtendedCap;

use super::DISTINCT_CHANNELS;

/// One minus the form factor of the other ball, which the horizon may cut.
pub(super) fn ambient_occlusion(prepared: &PreparedScene, nodes: usize) -> Vec<Option<f64>> {
    let spheres = spheres(prepared);
    pixel_means(prepared, nodes, rays(prepared), |ray| {
        let Some((ball, t)) = ray.nearest_hit(&spheres, None) else { return Some((2, 1.0)) };
        Some((ball, openness(&spheres, ball, ray.at(t))))
    })
}

/// What is behind a ground that catches shadows, times how open the ground is under the ball.
pub(super) fn shadow_catcher(prepared: &PreparedScene, nodes: usize) -> Vec<Option<f64>> {
    let spheres = spheres(prepared);
    let backdrop = prepared.description().background.backdrop.map_or(f64::NAN, |l| l.y.into());
    pixel_means(prepared, nodes, rays(prepared), |ray| match ray.nearest_hit(&spheres, None) {
        None => Some((2, backdrop)),
        Some((0, t)) => Some((0, backdrop * openness(&spheres, 0, ray.at(t)))),
        Some(_) => None,
    })
}

/// One minus the form factor of the other ball of two.
fn openness(spheres: &[Sphere], ball: usize, point: DVec3) -> f64 {
    let (ball, other) = (&spheres[ball], &spheres[1 - ball]);
    let covered = SubtendedCap::new(other, point, normal(ball, point)).irradiance();
    1.0 - covered / std::f64::consts::PI
}

/// Weighted mean of the three channels that encode a normal.
pub(super) fn normals(prepared: &PreparedScene, nodes: usize) -> Vec<Option<f64>> {
    let spheres = spheres(prepared);
    pixel_means(prepared, nodes, rays(prepared), |ray| {
        let Some((ball, t)) = ray.nearest_hit(&spheres, None) else {
            return Some((spheres.len(), 0.0));
        };
        let n = normal(&spheres[ball], ray.at(t));
        Some((ball, 0.5 + 0.5 * n.dot(DISTINCT_CHANNELS.into())))
    })
}
