//! Diffuse balls under spherical emitters. In all of these scenes the ball comes first and the
//! emitter second.

use std::f64::consts::PI;

use crate::geometry::Sphere;
use crate::scene::PreparedScene;
use crate::scene::description::EnvironmentDescription;
use crate::verify::closed_forms::reference_image::{normal, pixel_means, rays, spheres};
use crate::verify::closed_forms::sphere_light::SubtendedCap;

use super::{albedo, emission, material};

/// Every direction above the ball hits the emitter, so its irradiance is `pi Le`.
pub(super) fn inside_an_emitter(prepared: &PreparedScene, nodes: usize) -> Vec<Option<f64>> {
    let spheres = spheres(prepared);
    let [ball, emitter] = [albedo(prepared, "ball"), 1.0].map(|a| a * emission(prepared, "lamp"));
    pixel_means(prepared, nodes, rays(prepared), |ray| {
        let (region, _) = ray.nearest_hit(&spheres, None)?;
        Some((region, [ball, emitter][region]))
    })
}

/// Radiance at a point on a ball lit by one emitter.
pub(super) fn radiance_under_light(
    emitter: &Sphere,
    ball: &Sphere,
    point: glam::DVec3,
    a: f64,
    le: f64,
) -> f64 {
    a * le * SubtendedCap::new(emitter, point, normal(ball, point)).irradiance() / PI
}

/// A diffuse ball with no occluder. The front and the back of the emitter contribute in proportion
/// to its opacity, and the back is seen through the front.
pub(super) fn sphere_light(prepared: &PreparedScene, nodes: usize) -> Vec<Option<f64>> {
    let spheres = spheres(prepared);
    let transmitted = 1.0 - material(prepared, "lamp").opacity;
    let (a, le) =
        (albedo(prepared, "ball"), emission(prepared, "lamp") * (1.0 - transmitted * transmitted));
    pixel_means(prepared, nodes, rays(prepared), |ray| match ray.nearest_hit(&spheres, None) {
        Some((0, t)) => Some((0, radiance_under_light(&spheres[1], &spheres[0], ray.at(t), a, le))),
        Some((_, _)) => Some((1, le)),
        None => Some((2, 0.0)),
    })
}

/// A black third sphere covers part of the emitter. If its disc lies within the emitter's, its form
/// factor is subtracted, scaled by its opacity. If the edges cross, there is no closed form.
pub(super) fn occluder(prepared: &PreparedScene, nodes: usize) -> Vec<Option<f64>> {
    let spheres = spheres(prepared);
    let (a, le) = (albedo(prepared, "ball"), emission(prepared, "lamp"));
    let opacity = material(prepared, "black").opacity;
    let transmitted = (1.0 - opacity) * (1.0 - opacity); // front and back
    pixel_means(prepared, nodes, rays(prepared), |ray| match ray.nearest_hit(&spheres, None) {
        Some((0, t)) => {
            let point = ray.at(t);
            let n = normal(&spheres[0], point);
            let [emitter, front] = [1, 2].map(|i: usize| SubtendedCap::new(&spheres[i], point, n));
            let unoccluded = emitter.irradiance_occluded_by(&front)?;
            let irradiance = unoccluded + transmitted * (emitter.irradiance() - unoccluded);
            Some((0, a * le * irradiance / PI))
        }
        Some((1, _)) => Some((1, le)),
        Some(_) if opacity < 1.0 => None,
        _ => Some((2, 0.0)),
    })
}

/// The sky's radiance is linear in the height of a direction. In front of it is the sun, a disc
/// that the horizon may cut.
pub(super) fn sun_and_sky(prepared: &PreparedScene, nodes: usize) -> Vec<Option<f64>> {
    let ball = spheres(prepared)[0];
    let a = albedo(prepared, "ball");
    let EnvironmentDescription::Gradient { zenith, horizon, .. } =
        prepared.description().background.dome
    else {
        return Vec::new();
    };
    let [zenith, horizon] = [zenith, horizon].map(|radiance| f64::from(radiance.y));
    let Some(sun) = prepared.description().background.sun else { return Vec::new() };
    let sin_radius = libm::sin(sun.angular_diameter_degrees.to_radians() / 2.0);
    let radiance = f64::from(sun.irradiance.y) / (PI * sin_radius * sin_radius);
    pixel_means(prepared, nodes, rays(prepared), |ray| {
        let n = normal(&ball, ray.at(ray.hit_distance(&ball)?));
        let direction = sun.direction;
        let disc = SubtendedCap { direction, cos: direction.dot(n), sin_radius };
        let sky = horizon + 2.0 / 3.0 * (zenith - horizon) * n.y;
        Some((0, a * (sky + radiance * disc.irradiance() / PI)))
    })
}
