//! Sampling of directions to spheres.

use crate::geometry::{Cone, Sphere};
use crate::math::{DVec3, Frame};
use crate::sampling::{atan2, sin_cos};

use super::SamplingTest;
use super::sampling_test::polar;

pub(super) fn tests() -> Vec<SamplingTest> {
    [1.001, 2.0, 1e4, 1e9].map(cone).into()
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
        [[0.0, 0.0], [1.0 + 1e-6, std::f64::consts::TAU]],
        move |u| {
            let [theta, phi] = polar(axis.to_local(cone.sample([u[0], u[1]]).direction));
            Some([theta / widest, phi])
        },
        move |[theta, _]| cone.pdf() * sin_cos(theta * widest).0 * widest,
    )
}
