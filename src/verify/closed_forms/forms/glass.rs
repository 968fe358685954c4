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
    pixel_means(prepared, nodes, rays(prepared), |line| {
        let Some(t) = line.hit_distance(&glass) else { return Some((0, 0.0)) };
        let from_center = line.at(t) - glass.center;
        let cos = -from_center.dot(line.direction) / glass.radius;
        let sin = (1.0 - cos * cos).sqrt();
        if glass.radius * sin >= ior * emitter.radius {
            return Some((0, 0.0));
        }
        let (arriving, refracted) = (libm::asin(sin), libm::asin(sin / ior));
        let off = glass.radius * sin / ior;
        let half_chord = |radius: f64| (radius * radius - off * off).sqrt();
        let length = half_chord(glass.radius) - half_chord(emitter.radius);
        let left = libm::exp(-f64::from(absorption.y) * length);
        Some((1, (1.0 - reflected(arriving, refracted)) * left * radiance / (ior * ior)))
    })
}

/// Fresnel reflectance for unpolarised light, in the form of sines and tangents.
fn reflected(arriving: f64, refracted: f64) -> f64 {
    let (less, more) = (arriving - refracted, arriving + refracted);
    let across = libm::sin(less) / libm::sin(more);
    let along = libm::tan(less) / libm::tan(more);
    (across * across + along * along) / 2.0
}
