//! A ball under a lamp, and what raycasting makes of it.

use photosphere::accel::Backend;

use crate::common::{Estimate, Rendered, picture};
use crate::scenes::{ESTIMATORS, LONE_BALL, with};

fn lone_ball_radiance() -> f64 {
    // From the point (0, 0, 1) with normal +z, the lamp's centre is at (0, 3, 4): distance 5.
    0.8 * 7.0 * (2.0f64 / 5.0).powi(2) * (4.0 / 5.0)
}

#[test]
fn a_lone_ball_under_a_lamp_has_its_closed_form_for_every_estimator_and_backend() {
    for &backend in Backend::AVAILABLE {
        for estimator in ESTIMATORS {
            for depth in [&[][..], &["render.max_depth=2"]] {
                let what = format!("lone ball, {} {estimator:?} {depth:?}", backend.name());
                Estimate::of_scene(LONE_BALL, &with(estimator, depth), backend)
                    .must_be(lone_ball_radiance(), &what);
            }
        }
    }
}

#[test]
fn raycasting_a_lone_ball_is_exact_and_shadows_can_be_left_out() {
    let cast = ["render.integrator=raycast", "render.samples_per_pixel=1"];
    let radiance = |more: &[&str]| picture(LONE_BALL, &with(&cast, more)).mean().y;
    let expected = lone_ball_radiance();
    assert!((radiance(&[]) - expected).abs() < 1e-5 * expected);
    assert!((radiance(&["render.raycast.shadows=true"]) - expected).abs() < 1e-5 * expected);
    // With the lamp behind something, only the shadow ray knows.
    let blocked = format!(
        "{LONE_BALL}\n[[spheres]]\ncenter = [0.0, 1.2, 2.6]\nradius = 0.5\nmaterial = \"ball\"\n"
    );
    let blocked = |shadows: &str| picture(&blocked, &with(&cast, &[shadows])).mean().y;
    assert!((blocked("render.raycast.shadows=false") - expected).abs() < 1e-5 * expected);
    assert_eq!(blocked("render.raycast.shadows=true"), 0.0);
}

#[test]
fn the_phong_highlight_has_the_published_value() {
    // Looking along the mirror direction of the lamp's centre: cos(alpha) = 1, so the classic form
    // sends specular E / cos and the normalised one specular (n + 2) / (2 pi) E.
    let irradiance = 7.0 * std::f64::consts::PI * (2.0f64 / 5.0).powi(2) * (4.0 / 5.0);
    let common = [
        "render.integrator=raycast",
        "render.samples_per_pixel=1",
        "materials.ball.type=phong",
        "materials.ball.albedo=[0,0,0]",
        "materials.ball.specular=[0.5,0.5,0.5]",
        "materials.ball.exponent=30",
        "camera.position=[0,-3,5]",
    ];
    let radiance = |form| picture(LONE_BALL, &with(&common, &[form])).mean().y;
    let normalized = radiance("materials.ball.normalized=true");
    let expected = 0.5 * 32.0 / std::f64::consts::TAU * irradiance;
    assert!((normalized - expected).abs() < 1e-4 * expected, "{normalized} {expected}");
    let classic = radiance("materials.ball.normalized=false");
    let expected = 0.5 * irradiance / 0.8;
    assert!((classic - expected).abs() < 1e-4 * expected, "{classic} {expected}");
}
