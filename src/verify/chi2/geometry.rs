//! Sampling of directions to spheres.

use std::f64::consts::TAU;

use crate::geometry::{Cone, ProjectedCap, Side, Sphere, SphereCut};
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
    // Above the horizon, cut by it, and with the axis below it; small and nearly half a space.
    let projected = [(3.0, 0.0), (3.0, 60.0), (1.02, 5.0), (1e4, 80.0)];
    let cut = [(3.0, 75.0), (3.0, 89.0), (1.02, 40.0), (1e4, 89.999)];
    let below = [(3.0, 95.0), (3.0, 105.0), (1.02, 130.0), (1e4, 90.001)];
    let all = projected.into_iter().chain(cut).chain(below);
    tests.extend(all.map(|(distance, tilt)| projected_cap(distance, tilt)));
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

/// The projected cap of a unit sphere `distance` away, whose centre is `tilt` degrees from the
/// normal z, in polar coordinates around its axis, scaled to the cone.
fn projected_cap(distance: f64, tilt: f64) -> SamplingTest {
    let (sin, cos) = sin_cos(tilt.to_radians());
    let axis = DVec3::new(-0.6 * sin, 0.8 * sin, cos);
    let sphere = Sphere { center: axis * distance, radius: 1.0 };
    let cone = Cone::subtending(DVec3::ZERO, &sphere).expect("seen from outside");
    let cap = ProjectedCap::new(&cone, DVec3::Z).expect("above the horizon");
    let frame = Frame::from_z(axis);
    let widest = atan2(1.0, ((distance - 1.0) * (distance + 1.0)).sqrt());
    SamplingTest::over_rectangle(
        format!("projected cap of a sphere {distance} radii away, {tilt} degrees from the normal"),
        [[0.0, 0.0], [1.0 + 1e-6, TAU]],
        move |u| {
            let [theta, phi] = polar(frame.to_local(cap.sample([u[0], u[1]])));
            Some([theta / widest, phi])
        },
        move |[theta, phi]| {
            let ((sin, cos), (sin_phi, cos_phi)) = (sin_cos(theta * widest), sin_cos(phi));
            let direction = frame.to_world(DVec3::new(sin * cos_phi, sin * sin_phi, cos));
            if theta <= 1.0 { cap.pdf(direction) * sin * widest } else { 0.0 }
        },
    )
    .with_discontinuities()
}
