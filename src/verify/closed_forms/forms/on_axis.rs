//! A wide emitter that a point sees through glass, with the centres of all balls on its normal.

use std::f64::consts::FRAC_PI_2;

use crate::geometry::Sphere;
use crate::scene::PreparedScene;
use crate::scene::description::SurfaceModel;
use crate::verify::closed_forms::reference_image::{
    ReferenceRay, normal, pixel_means, rays, spheres,
};
use crate::verify::quadrature::gauss_legendre;

use super::refraction::cross;
use super::{albedo, emission, material};

/// Steps of the scan for the edges of the emitter, and of a bisection to the last bit.
const SCAN: usize = 200;
const STEPS: usize = 60;

/// The emitter is behind a glass ball; derived in `scenes/verify/lamp-through-glass.toml`.
pub(super) fn through_glass(prepared: &PreparedScene, nodes: usize) -> Vec<Option<f64>> {
    radiance(prepared, nodes, |ray, glass, n| {
        let (inside, entered) = cross(ray, glass, n)?;
        // From the boundary, the ball is met at its far side.
        let chord = -2.0 * inside.direction.dot(normal(glass, inside.origin)) * glass.radius;
        let middle = ReferenceRay { origin: inside.at(0.5 * chord), ..inside };
        let (behind, left) = cross(middle, glass, n)?;
        Some((behind, entered * left))
    })
}

/// The point is inside the glass; derived in `scenes/verify/lamp-seen-from-glass.toml`.
pub(super) fn from_glass(prepared: &PreparedScene, nodes: usize) -> Vec<Option<f64>> {
    radiance(prepared, nodes, |ray, glass, n| {
        let (behind, left) = cross(ray, glass, n)?;
        Some((behind, left * n * n))
    })
}

fn radiance(
    prepared: &PreparedScene,
    nodes: usize,
    follow: impl Fn(ReferenceRay, &Sphere, f64) -> Option<(ReferenceRay, f64)>,
) -> Vec<Option<f64>> {
    let [ball, glass, lamp] = [0, 1, 2].map(|i| spheres(prepared)[i]);
    let SurfaceModel::Dielectric { ior, .. } = material(prepared, "glass").surface else {
        return Vec::new();
    };
    let (a, le) = (albedo(prepared, "ball"), emission(prepared, "lamp"));
    pixel_means(prepared, nodes, rays(prepared), |ray| {
        let point = ray.at(ray.hit_distance(&ball)?);
        let axis = normal(&ball, point);
        let (side, _) = axis.any_orthonormal_pair();
        // The largest sine with which a ray meets the glass: there the share of light that crosses
        // has a vertical tangent, and none at `v`, of which the sine is proportional to that.
        let distance = point.distance(glass.center) / glass.radius;
        let largest = if distance > 1.0 { 1.0 / distance } else { 1.0 / (ior * distance).max(1.0) };
        let at = |v: f64| {
            let sin = largest * libm::sin(v);
            let direction = side * sin + axis * (1.0 - sin * sin).sqrt();
            follow(ReferenceRay { origin: point, direction }, &glass, ior)
                .filter(|(last, _)| last.hit_distance(&lamp).is_some())
                .map(|(_, share)| share * 2.0 * libm::sin(v) * libm::cos(v))
        };
        let seen = integral_where_seen(nodes, at);
        Some((0, a * le * largest * largest * seen))
    })
}

/// Integrates over `[0, pi / 2]` a function that is smooth wherever it is not `None`.
fn integral_where_seen(nodes: usize, f: impl Fn(f64) -> Option<f64>) -> f64 {
    let rule = gauss_legendre(2 * nodes);
    let is_seen = |v: f64| f(v).is_some();
    let step = FRAC_PI_2 / SCAN as f64;
    // Between the edges, and away from the ends.
    let mut edges = vec![0.0];
    for i in 0..SCAN {
        let (mut low, mut high) = ((i as f64 + 0.5) * step, (i as f64 + 1.5) * step);
        if i + 1 == SCAN {
            break;
        }
        if is_seen(low) != is_seen(high) {
            let starts = is_seen(low);
            for _ in 0..STEPS {
                let mid = 0.5 * (low + high);
                if is_seen(mid) == starts { low = mid } else { high = mid }
            }
            edges.push(low);
        }
    }
    edges.push(FRAC_PI_2);
    let piece = |pair: &[f64]| {
        let (low, width) = (pair[0], pair[1] - pair[0]);
        rule.iter()
            .filter_map(|(x, weight)| Some(weight * width * f(low + width * x)?))
            .sum::<f64>()
    };
    edges.windows(2).map(piece).sum()
}
