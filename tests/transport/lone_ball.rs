//! A ball under an emitter, and what raycasting makes of it.

use photosphere::scene::settings::IntegratorSettings;

use crate::kit::{Kit, diffuse, phong};
use crate::scenes::{lone_ball, must_be_everywhere};

fn lone_ball_radiance() -> f64 {
    // From the point (0, 0, 1) with normal +z, the emitter's centre is at (0, 3, 4): distance 5.
    0.8 * 7.0 * (2.0f64 / 5.0).powi(2) * (4.0 / 5.0)
}

/// The radiance by one ray.
fn cast(kit: &Kit, shadows: bool) -> f64 {
    let kit = kit.clone().integrator(IntegratorSettings::Raycast { shadows }).samples(1);
    kit.picture().mean().y
}

#[test]
fn a_lone_ball_under_an_emitter_has_its_closed_form_for_every_estimator_and_backend() {
    let kit = lone_ball(diffuse(0.8));
    must_be_everywhere(&kit, lone_ball_radiance(), "lone ball");
    must_be_everywhere(&kit.depth(2), lone_ball_radiance(), "lone ball, direct light");
}

#[test]
fn raycasting_a_lone_ball_is_exact_and_shadows_can_be_left_out() {
    let mut kit = lone_ball(diffuse(0.8));
    let expected = lone_ball_radiance();
    for shadows in [false, true] {
        assert!((cast(&kit, shadows) - expected).abs() < 1e-5 * expected);
    }
    // With the emitter behind something, only the shadow ray knows.
    kit.ball([0.0, 1.2, 2.6], 0.5, diffuse(0.8));
    assert!((cast(&kit, false) - expected).abs() < 1e-5 * expected);
    assert_eq!(cast(&kit, true), 0.0);
}

#[test]
fn the_phong_highlight_has_the_published_value() {
    // Looking along the mirror direction of the emitter's centre: cos(alpha) = 1, so the classic
    // form sends specular E / cos and the normalised one specular (n + 2) / (2 pi) E.
    let irradiance = 7.0 * std::f64::consts::PI * (2.0f64 / 5.0).powi(2) * (4.0 / 5.0);
    let radiance = |normalized| {
        let mut kit = lone_ball(phong([0.0, 0.5], 30.0, normalized));
        kit.scene.camera([0.0, -3.0, 5.0], [0.0, 0.0, 1.0]);
        cast(&kit, false)
    };
    let normalized = radiance(true);
    let expected = 0.5 * 32.0 / std::f64::consts::TAU * irradiance;
    assert!((normalized - expected).abs() < 1e-4 * expected, "{normalized} {expected}");
    let classic = radiance(false);
    let expected = 0.5 * irradiance / 0.8;
    assert!((classic - expected).abs() < 1e-4 * expected, "{classic} {expected}");
}
