//! Refracting glass around an emitter.

use crate::scene::PreparedScene;
use crate::scene::description::SurfaceModel;
use crate::verify::closed_forms::reference_image::{pixel_means, rays, spheres};

use super::{emission, material};

/// An emitter inside clear or absorbing glass; derived in `scenes/verify/lamp-in-glass.toml` and
/// `lamp-in-dark-glass.toml`.
pub(super) fn emitter_in_glass(prepared: &PreparedScene, nodes: usize) -> Vec<Option<f64>> {
    let spheres = spheres(prepared);
    let (glass, emitter) = (spheres[0], spheres[1]);
    let radiance = emission(prepared, "lamp");
    let SurfaceModel::Dielectric { ior, absorption, .. } = material(prepared, "glass").surface
    else {
        return vec![
            None;
            (prepared.image_settings().width * prepared.image_settings().height) as usize
        ];
    };
    pixel_means(prepared, nodes, rays(prepared), |ray| {
        let Some(t) = ray.hit_distance(&glass) else { return Some((0, 0.0)) };
        let from_center = ray.at(t) - glass.center;
        let cos = -from_center.dot(ray.direction) / glass.radius;
        let sin = (1.0 - cos * cos).sqrt();
        if glass.radius * sin >= ior * emitter.radius {
            return Some((0, 0.0));
        }
        let (incident, refracted) = (libm::asin(sin), libm::asin(sin / ior));
        let chord_distance = glass.radius * sin / ior;
        let half_chord = |radius: f64| (radius * radius - chord_distance * chord_distance).sqrt();
        let length = half_chord(glass.radius) - half_chord(emitter.radius);
        let transmittance = libm::exp(-f64::from(absorption.y) * length);
        Some((1, (1.0 - fresnel(incident, refracted)) * transmittance * radiance / (ior * ior)))
    })
}

/// Fresnel reflectance for unpolarised light, in the form of sines and tangents.
fn fresnel(incident: f64, refracted: f64) -> f64 {
    let (difference, sum) = (incident - refracted, incident + refracted);
    let perpendicular = libm::sin(difference) / libm::sin(sum);
    let parallel = libm::tan(difference) / libm::tan(sum);
    (perpendicular * perpendicular + parallel * parallel) / 2.0
}
