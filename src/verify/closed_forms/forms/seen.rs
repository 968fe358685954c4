//! What integrators show that follow no light.

use crate::scene::Shot;
use crate::verify::closed_forms::field::{normal, over_pixels, rays, spheres};
use crate::verify::closed_forms::lamp::Disc;

use super::TOLD_APART;

/// One less the form factor of the other ball, which the horizon may cut.
pub(super) fn openness(shot: &Shot, nodes: usize) -> Vec<Option<f64>> {
    let spheres = spheres(shot);
    over_pixels(shot, nodes, rays(shot), |line| {
        let Some((ball, t)) = line.first(&spheres, None) else { return Some((2, 1.0)) };
        let (point, other) = (line.at(t), &spheres[1 - ball]);
        let covered = Disc::of(other, point, normal(&spheres[ball], point)).irradiance();
        Some((ball, 1.0 - covered / std::f64::consts::PI))
    })
}

/// The weighted mean of the three colours that a normal is drawn in.
pub(super) fn normals(shot: &Shot, nodes: usize) -> Vec<Option<f64>> {
    let spheres = spheres(shot);
    over_pixels(shot, nodes, rays(shot), |line| {
        let Some((ball, t)) = line.first(&spheres, None) else { return Some((spheres.len(), 0.0)) };
        let n = normal(&spheres[ball], line.at(t));
        Some((ball, 0.5 + 0.5 * n.dot(TOLD_APART.into())))
    })
}
