//! Absorbing glass under uniform illumination.

use crate::scene::PreparedScene;
use crate::scene::description::SurfaceModel;
use crate::verify::closed_forms::reference_image::{normal, pixel_means, rays, spheres};
use crate::verify::quadrature::integral;

use super::refraction::fresnel;
use super::{albedo, background_radiance, emission, material};

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

/// A ball in the middle of a ball of fog, inside an emitter.
pub(super) fn fog(prepared: &PreparedScene, nodes: usize) -> Vec<Option<f64>> {
    let spheres = spheres(prepared);
    let (ball, fog) = (spheres[0], spheres[1]);
    let (a, le) = (albedo(prepared, "ball"), emission(prepared, "lamp"));
    let k = match &material(prepared, "fog").surface {
        SurfaceModel::Dielectric { absorption, .. } => f64::from(absorption.y),
        _ => 0.0,
    };
    let dimmed = |cos: f64| {
        let (depth, cos) = (fog.radius * fog.radius - ball.radius * ball.radius, cos * ball.radius);
        libm::exp(-k * ((depth + cos * cos).sqrt() - cos))
    };
    let irradiance = integral(0.0, 1.0, 4 * nodes, |cos| 2.0 * cos * dimmed(cos));
    pixel_means(prepared, nodes, rays(prepared), |ray| {
        let Some(entry) = ray.hit_distance(&fog) else { return Some((2, le)) };
        let Some(t) = ray.hit_distance(&ball) else {
            let along = (fog.center - ray.origin).dot(ray.direction);
            return Some((1, le * libm::exp(-2.0 * k * (along - entry))));
        };
        Some((0, a * le * irradiance * libm::exp(-k * (t - entry))))
    })
}
