//! Absorbing glass under uniform illumination.

use crate::scene::PreparedScene;
use crate::scene::description::SurfaceModel;
use crate::verify::closed_forms::reference_image::{normal, pixel_means, rays, spheres};

use super::{background_radiance, material};

/// Sums the series of internal reflections in one ball. All chords of a path have equal length.
pub(super) fn absorption(prepared: &PreparedScene, nodes: usize) -> Vec<Option<f64>> {
    let ball = spheres(prepared)[0];
    let background = background_radiance(prepared);
    let (n, a) = match &material(prepared, "glass").surface {
        SurfaceModel::Dielectric { ior, absorption, .. } => (*ior, f64::from(absorption.y)),
        _ => (1.0, 0.0),
    };
    pixel_means(prepared, nodes, rays(prepared), |ray| {
        let Some(t) = ray.hit_distance(&ball) else { return Some((1, background)) };
        let cos = -ray.direction.dot(normal(&ball, ray.at(t)));
        let cos_inside = (1.0 - (1.0 - cos * cos) / (n * n)).sqrt();
        let reflectance = fresnel(cos, cos_inside, n);
        let transmittance = libm::exp(-2.0 * a * ball.radius * cos_inside);
        let refracted = (1.0 - reflectance) * (1.0 - reflectance) * transmittance
            / (1.0 - reflectance * transmittance);
        Some((0, background * (reflectance + refracted)))
    })
}

/// Fresnel reflectance for unpolarised light, given the cosines outside and inside.
fn fresnel(cos: f64, cos_inside: f64, n: f64) -> f64 {
    let perpendicular = (cos - n * cos_inside) / (cos + n * cos_inside);
    let parallel = (n * cos - cos_inside) / (n * cos + cos_inside);
    (perpendicular * perpendicular + parallel * parallel) / 2.0
}
