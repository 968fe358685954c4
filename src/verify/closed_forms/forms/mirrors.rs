//! Mirror balls in front of the camera and in front of the emitter.

use crate::geometry::Sphere;
use crate::scene::PreparedScene;
use crate::verify::closed_forms::reference_image::{
    ReferenceRay, normal, pixel_means, rays, spheres,
};
use crate::verify::closed_forms::sphere_light::SubtendedCap;

use super::{albedo, emission, uniform_solution};

/// The spheres are ball, emitter, mirror. The part of the ball seen in the mirror is lit by the
/// emitter wherever the mirror does not occlude it.
pub(super) fn mirror_before_camera(prepared: &PreparedScene, nodes: usize) -> Vec<Option<f64>> {
    let spheres = spheres(prepared);
    let (a, le) = (albedo(prepared, "ball"), emission(prepared, "lamp"));
    let rho = albedo(prepared, "mirror");
    pixel_means(prepared, nodes, rays(prepared), |ray| {
        let (first, t) = ray.nearest_hit(&spheres, None)?;
        if first != 2 {
            return None;
        }
        let at = ray.at(t);
        let reflected = ray.reflected(at, normal(&spheres[2], at));
        match reflected.nearest_hit(&spheres, Some(2)) {
            Some((0, t)) => {
                let point = reflected.at(t);
                let n = normal(&spheres[0], point);
                let [emitter, front] =
                    [1, 2].map(|i: usize| SubtendedCap::new(&spheres[i], point, n));
                let irradiance = emitter.irradiance_occluded_by(&front)?;
                Some((0, rho * a * le * irradiance / std::f64::consts::PI))
            }
            Some(_) => Some((1, rho * le)),
            None => Some((2, 0.0)),
        }
    })
}

/// The spheres are ball, mirror, and an emitter around both. The point of the ball under the mirror
/// sees the emitter past the mirror, and in the mirror from the angle at which the ball's own
/// reflection ends.
pub(super) fn mirror_before_light(prepared: &PreparedScene, _: usize) -> Vec<Option<f64>> {
    let spheres = spheres(prepared);
    let (ball, mirror) = (&spheres[0], &spheres[1]);
    let edge = mirror.radius / (mirror.center.distance(ball.center) - ball.radius);
    let own_reflection_edge = own_reflection(ball, mirror, edge);
    let [direct, reflected] =
        [1.0 - edge * edge, edge * edge - own_reflection_edge * own_reflection_edge];
    let light = direct + albedo(prepared, "mirror") * reflected;
    uniform_solution(prepared, albedo(prepared, "ball") * emission(prepared, "lamp") * light)
}

/// The sine of the polar angle at which the reflected ray grazes the ball, by bisection between the
/// axis, where the ray returns, and the mirror's edge, where it escapes.
fn own_reflection(ball: &Sphere, mirror: &Sphere, edge: f64) -> f64 {
    let axis = (mirror.center - ball.center).normalize();
    let side = axis.any_orthonormal_vector();
    let origin = ball.center + axis * ball.radius;
    let returns = |sin: f64| {
        let direction = side * sin + axis * (1.0 - sin * sin).sqrt();
        let ray = ReferenceRay { origin, direction };
        let at = ray.at(ray.hit_distance(mirror).unwrap_or(f64::NAN));
        ray.reflected(at, normal(mirror, at)).hit_distance(ball).is_some()
    };
    let (mut low, mut high) = (0.0, edge * (1.0 - 1e-12));
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if returns(middle) { low = middle } else { high = middle }
    }
    low
}
