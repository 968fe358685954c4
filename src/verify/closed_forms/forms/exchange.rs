//! Interreflection between two balls, by a quadrature over one angle.

use std::f64::consts::PI;

use crate::geometry::Sphere;
use crate::math::DVec3;
use crate::scene::PreparedScene;
use crate::verify::closed_forms::reference_image::{ReferenceRay, normal, spheres};
use crate::verify::closed_forms::sphere_light::SubtendedCap;
use crate::verify::quadrature::integral;

use super::{albedo, emission, uniform_solution};

/// Nodes per node requested: the integrand is smooth except at the edge of ball B, where it starts
/// as a square root.
const FINER: usize = 16;

pub(super) fn exchange(prepared: &PreparedScene, nodes: usize) -> Vec<Option<f64>> {
    let spheres = spheres(prepared);
    let [a, b] = ["a", "b"].map(|name| albedo(prepared, name));
    let returned = returned_fraction(&spheres[0], &spheres[1], FINER * nodes);
    uniform_solution(prepared, emission(prepared, "a") * (1.0 + a * b * returned))
}

/// For the point of A nearest to B: the integral, over the directions to B, of B's form factor of A
/// times the cosine, divided by `pi`. With `u` the sine of the polar angle it is `2 u F du`. B ends
/// at `u = s`; the substitution `u = s sin(v)` removes the square root there.
fn returned_fraction(a: &Sphere, b: &Sphere, nodes: usize) -> f64 {
    let axis = (b.center - a.center).normalize();
    let side = axis.any_orthonormal_vector();
    let origin = a.center + axis * a.radius;
    let max_sin = b.radius / b.center.distance(origin);
    let integrand = |v: f64| {
        let u = max_sin * libm::sin(v);
        let direction: DVec3 = side * u + axis * (1.0 - u * u).sqrt();
        let ray = ReferenceRay { origin, direction };
        let Some(t) = ray.hit_distance(b) else { return 0.0 };
        let point = ray.at(t);
        let form_factor = SubtendedCap::new(a, point, normal(b, point)).irradiance() / PI;
        2.0 * u * form_factor * max_sin * libm::cos(v)
    };
    integral(0.0, PI / 2.0, nodes, integrand)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::DVec3;

    #[test]
    fn the_quadrature_converges_to_twelve_digits() {
        let a = Sphere { center: DVec3::ZERO, radius: 1.0 };
        let b = Sphere { center: DVec3::new(0.0, 0.0, 3.2), radius: 1.5 };
        let [coarse, used, fine] =
            [FINER, 4 * FINER, 64 * FINER].map(|nodes| returned_fraction(&a, &b, nodes));
        assert!((coarse - fine).abs() < 1e-4 * fine, "{coarse} {fine}");
        assert!((used - fine).abs() < 1e-6 * fine, "{used} {fine}");
    }

    #[test]
    fn two_distant_balls_exchange_by_the_inverse_square() {
        // A sees B as a small disc of (r / h)^2, B sees A with (R / D)^2. All cosines are 1 on the
        // axis and 2/3 on average over the disc of B: the integral of 2 u cos du with sin = u / s.
        let a = Sphere { center: DVec3::ZERO, radius: 1.0 };
        let b = Sphere { center: DVec3::new(0.0, 0.0, 2000.0), radius: 1.0 };
        let expected = 2.0 / 3.0 / (1999.0f64 * 1999.0) / (1999.0 * 1999.0);
        let found = returned_fraction(&a, &b, 64);
        assert!((found / expected - 1.0).abs() < 3e-3, "{found} {expected}");
    }
}
