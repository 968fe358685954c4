//! Known facts: conservation of energy, and the rainbow.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use crate::geometry::Sphere;
use crate::math::DVec3;
use crate::sampling::{safe_acos, sin_cos};

use super::super::{SpecularPath, Target};
use super::fresnel::reflectance;

const BALL: Sphere = Sphere { center: DVec3::new(0.3, -2.0, 0.7), radius: 0.4 };
/// Steps of a quadrature.
const STEPS: usize = 200_000;

/// A point or direction at an angle from the axis on which the light is.
fn at_angle(theta: f64) -> DVec3 {
    let (sin, cos) = sin_cos(theta);
    DVec3::new(sin, 0.0, cos)
}

/// The flux that arrives over the ball at all points of a sphere around it, or in all directions,
/// from a light of intensity 1 at `distance` radii.
fn flux(distance: f64, detector: Option<f64>, arrives: impl Fn(DVec3, Target) -> f64) -> f64 {
    let light = BALL.center + DVec3::Z * (distance * BALL.radius);
    let step = PI / STEPS as f64;
    let ring = |i: usize| {
        let theta = (i as f64 + 0.5) * step;
        let towards = at_angle(theta);
        let (y, area) = match detector {
            None => (Target::Direction(towards), 1.0),
            Some(d) => {
                let d = d * BALL.radius;
                (Target::Point(BALL.center + towards * d), d * d)
            }
        };
        area * TAU * sin_cos(theta).0 * step * arrives(light, y)
    };
    (0..STEPS).map(ring).sum()
}

/// Irradiance of the detector by paths of one kind, each weighted by the given function of the
/// cosine outside.
fn irradiance(
    kind: SpecularPath,
    ior: f64,
    (light, y): (DVec3, Target),
    weight: impl Fn(f64) -> f64,
) -> f64 {
    let path = |found: &super::super::Connection| {
        let cos = match y {
            Target::Point(y) => -found.direction_at_y.dot((y - BALL.center).normalize()),
            Target::Direction(_) => 1.0,
        };
        weight(found.cos_outside) * cos / found.spread
    };
    kind.connect(&BALL, ior, light, y).iter().map(path).sum()
}

#[test]
fn a_mirror_ball_throws_what_it_receives() {
    for (distance, detector) in [(1.1f64, None), (3.0, None), (3.0, Some(1.5)), (40.0, Some(7.0))] {
        let received = TAU * (1.0 - (1.0 - 1.0 / (distance * distance)).sqrt());
        let thrown = flux(distance, detector, |light, y| {
            irradiance(SpecularPath::Reflection, 1.0, (light, y), |_| 1.0)
        });
        assert!((thrown / received - 1.0).abs() < 1e-6, "{distance} {detector:?}: {thrown}");
    }
}

/// What is reflected outside and what leaves after 0 and 1 inner reflections is what enters, but
/// for the rest that leaves later, known from Fresnel's equations. The error is that of the
/// quadrature at the caustics.
#[test]
fn a_glass_ball_throws_what_it_receives() {
    for (distance, ior) in [(3.0f64, 1.5), (1.2, 1.33), (20.0, 0.7)] {
        for kind in SpecularPath::OVER_DIELECTRIC {
            // Over the cone of the light: dw = 2 pi sin a da, with sin a = h / d.
            let step = FRAC_PI_2 / STEPS as f64;
            let widest = safe_acos((1.0 - 1.0 / (distance * distance)).sqrt());
            let ring = |i: usize| {
                let alpha = widest * (i as f64 + 0.5) * step / FRAC_PI_2;
                let sin = sin_cos(alpha).0;
                let h = sin * distance;
                let share = kind.passage(reflectance((1.0 - h * h).max(0.0).sqrt(), ior));
                share * TAU * sin * step * widest / FRAC_PI_2
            };
            let received: f64 = (0..STEPS).map(ring).sum();
            let thrown = flux(distance, None, |light, y| {
                irradiance(kind, ior, (light, y), |cos| kind.passage(reflectance(cos, ior)))
            });
            assert!((thrown / received - 1.0).abs() < 6e-3, "{kind:?}: {thrown} {received}");
        }
    }
}

/// Descartes: the fold of one inner reflection in water, in sunlight, is 42 degrees from the point
/// opposite of the sun, where `cos^2 i = (n^2 - 1) / 3`.
#[test]
fn the_rainbow_is_at_42_degrees() {
    let (ior, far) = (1.3333, 1e7);
    let count = |theta: f64| {
        let x = BALL.center + DVec3::Z * (far * BALL.radius);
        let sun = Target::Direction(at_angle(theta));
        SpecularPath::ThroughReflected.connect(&BALL, ior, x, sun).len()
    };
    let [mut inside, mut outside] = [0.6f64, 0.9];
    assert_eq!((count(inside), count(outside)), (2, 0));
    for _ in 0..50 {
        let middle = 0.5 * (inside + outside);
        if count(middle) > 0 { inside = middle } else { outside = middle }
    }
    let i = safe_acos(((ior * ior - 1.0) / 3.0f64).sqrt());
    let t = FRAC_PI_2 - safe_acos(sin_cos(i).0 / ior);
    assert!((inside - (4.0 * t - 2.0 * i)).abs() < 1e-6, "{}", inside.to_degrees());
    assert!((inside.to_degrees() - 42.0).abs() < 0.1);
}
