//! Images of integrators that do not simulate light transport.

use crate::scene::PreparedScene;
use crate::verify::closed_forms::reference_image::{normal, pixel_means, rays, spheres};
use crate::verify::closed_forms::sphere_light::SubtendedCap;

use super::DISTINCT_CHANNELS;

/// One minus the form factor of the other ball, which the horizon may cut.
pub(super) fn ambient_occlusion(prepared: &PreparedScene, nodes: usize) -> Vec<Option<f64>> {
    let spheres = spheres(prepared);
    pixel_means(prepared, nodes, rays(prepared), |ray| {
        let Some((ball, t)) = ray.nearest_hit(&spheres, None) else { return Some((2, 1.0)) };
        let (point, other) = (ray.at(t), &spheres[1 - ball]);
        let covered = SubtendedCap::new(other, point, normal(&spheres[ball], point)).irradiance();
        Some((ball, 1.0 - covered / std::f64::consts::PI))
    })
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
