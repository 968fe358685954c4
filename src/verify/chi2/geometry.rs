//! Sampling of directions to spheres.

use std::f64::consts::TAU;

use crate::geometry::{Cone, Side, Sphere, SphereCut};
use crate::math::{DVec3, Frame};
use crate::sampling::{atan2, sin_cos};

use super::SamplingTest;
use super::sampling_test::polar;

pub(super) fn tests() -> Vec<SamplingTest> {
    let mut tests: Vec<_> = [1.001, 2.0, 1e4, 1e9].map(cone).into();
    // The cap below the plane z = 0.6: from afar, from its middle, and 1e-3 from its rim.
    let near_rim = DVec3::new(0.8 + 8e-4, 0.0, 0.6 + 6e-4);
    for (name, point) in [
        ("afar", DVec3::new(20.0, 0.0, 30.0)),
        ("its middle", DVec3::new(0.0, 0.0, 1.1)),
        ("its rim", near_rim),
    ] {
        tests.push(cap(name, point));
    }
    tests
}

/// The cone subtended by a unit sphere, in polar coordinates around its axis scaled to the cone.
fn cone(distance: f64) -> SamplingTest {
    let sphere = Sphere { center: DVec3::new(0.6, -0.48, 0.64) * distance, radius: 1.0 };
    let cone = Cone::subtending(DVec3::ZERO, &sphere).expect("seen from outside");
    let axis = Frame::from_z(sphere.center.normalize());
    let widest = atan2(1.0, ((distance - 1.0) * (distance + 1.0)).sqrt());
    SamplingTest::over_rectangle(
        format!("cone of a sphere {distance} radii away"),
        // Rounding may put a direction one ulp outside the cone.
        [[0.0, 0.0], [1.0 + 1e-6, TAU]],
        move |u| {
            let [theta, phi] = polar(axis.to_local(cone.sample([u[0], u[1]]).direction));
            Some([theta / widest, phi])
        },
        move |[theta, _]| cone.pdf() * sin_cos(theta * widest).0 * widest,
    )
}

/// The part of a unit sphere around the origin above the plane `z = 0.6`, seen from a point, in
/// height and azimuth on the sphere: per unit of both, the solid angle is `cos / t^2`.
fn cap(name: &str, point: DVec3) -> SamplingTest {
    let sphere = Sphere { center: DVec3::ZERO, radius: 1.0 };
    // The plane is at (d^2 + 1 - R^2) / 2d.
    let below = Sphere { center: DVec3::new(0.0, 0.0, -2.0), radius: 7.4f64.sqrt() };
    let cut = SphereCut::new(&sphere, &below).expect("a cut");
    let seen = cut.exposed_cap(Side::Outside).seen_from(point, &sphere);
    SamplingTest::over_rectangle(
        format!("cap of a sphere from {name}"),
        [[0.6, 0.0], [1.0, TAU]],
        move |u| {
            let sample = seen.sample([u[0], u[1]]);
            let normal = point + sample.direction * sample.distance;
            (sample.pdf > 0.0).then(|| [normal.z, atan2(normal.y, normal.x).rem_euclid(TAU)])
        },
        move |[z, phi]| {
            let ((sin_phi, cos_phi), sin) = (sin_cos(phi), (1.0 - z * z).sqrt());
            let normal = DVec3::new(sin * cos_phi, sin * sin_phi, z);
            let (t, direction) = (normal.distance(point), (normal - point).normalize());
            let cos = -normal.dot(direction);
            if cos > 0.0 { seen.pdf(direction) * cos / (t * t) } else { 0.0 }
        },
    )
    .with_discontinuities()
}
