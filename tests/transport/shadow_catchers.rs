//! Spheres that the camera sees only by the shadow on them, against closed forms.

use photosphere::color::Rgb;
use photosphere::math::DVec3;
use photosphere::scene::description::{EnvironmentDescription, SunDescription};
use photosphere::verify::statistics::MeanEstimate;

use crate::kit::{Judged, Kit, diffuse, glass, rendered};
use photosphere::accel::Backend;

/// A ball of radius 1, two above a point of a ground that catches shadows. The picture shows that
/// point alone, against a backdrop of 4, under a sky of 1.
fn ball_over_ground() -> Kit {
    let mut kit = Kit::new(2, 2, 64);
    kit.scene.camera([3.0, 1.5, 0.0], [0.0; 3]).field_of_view(0.01);
    kit.ball([0.0, -1e5, 0.0], 1e5, diffuse(0.3));
    kit.ball([0.0, 2.0, 0.0], 1.0, diffuse(0.8));
    kit.scene.background([1.0; 3]);
    let description = &mut kit.scene.description;
    description.spheres[0].shadow_catcher = true;
    description.background.backdrop = Some(Rgb::splat(4.0));
    kit
}

/// The share of the sky's light that a ball with the sine `r / d` keeps from a point below it.
const BLOCKED: f64 = 0.25;

/// The mean alpha of the picture, over seeds.
fn alpha(kit: &Kit) -> MeanEstimate {
    let mut kit = kit.clone();
    let background = &mut kit.scene.description.background;
    (background.backdrop, background.transparent, background.camera_visible) = (None, true, false);
    let mean = |picture: photosphere::image_io::Picture| {
        let alpha = picture.alpha.expect("it is transparent");
        assert!(picture.direct.iter().all(|light| *light == Rgb::ZERO));
        alpha.iter().map(|a| f64::from(*a)).sum::<f64>() / alpha.len() as f64
    };
    MeanEstimate::from_values(&kit.pictures(Backend::BruteForce).map(mean).collect::<Vec<_>>())
}

#[test]
fn the_shadow_under_a_ball_is_what_it_hides_of_the_sky() {
    for kit in ball_over_ground().both_ways() {
        kit.mean().must_be(4.0 * (1.0 - BLOCKED), &kit.how());
        alpha(&kit).must_be(BLOCKED, &kit.how());
    }
}

#[test]
fn the_shadow_of_the_sun_is_as_deep_as_its_share_of_the_light() {
    let irradiance = 2.0;
    let kit = ball_over_ground().with(|kit| {
        kit.scene.description.background.sun = Some(SunDescription {
            direction: DVec3::Y,
            angular_diameter_degrees: 2.0,
            irradiance: Rgb::splat(irradiance),
        });
    });
    let (sky, sun) = (std::f64::consts::PI, f64::from(irradiance));
    let expected = (BLOCKED * sky + sun) / (sky + sun);
    // The candidates are finitely many, which leaves a bias.
    let found = alpha(&kit).mean;
    assert!((found - expected).abs() < 0.01, "{found} is not {expected}");
    let unlit = kit.with(|kit| {
        kit.scene.description.background.dome = EnvironmentDescription::default();
    });
    alpha(&unlit).must_be(1.0, "in the umbra");
}

#[test]
fn a_lamp_casts_a_shadow_and_nothing_is_caught_without_light() {
    let mut kit = ball_over_ground();
    kit.scene.description.background.dome = EnvironmentDescription::default();
    kit.mean().must_be(4.0, "no light, no shadow");
    kit.glowing_ball([0.0, 9.0, 0.0], 0.5, diffuse(0.0), 50.0);
    alpha(&kit).must_be(1.0, "in the umbra");
    kit.scene.description.spheres[2].center = DVec3::new(-9.0, 5.0, 4.0);
    alpha(&kit).must_be(0.0, "in the light");
    kit.glowing_ball([0.0, 9.0, 0.0], 0.5, diffuse(0.0), 50.0);
    let partly = alpha(&kit).mean;
    assert!((0.2..0.8).contains(&partly), "{partly}");
}

#[test]
fn other_paths_meet_a_catcher_as_any_sphere() {
    // The ball is lit from below by the ground.
    let look_up = |is_caught: bool| {
        let mut kit = ball_over_ground().depth(4);
        kit.scene.camera([4.0, 1.0, 0.0], [0.0, 1.9, 0.0]).field_of_view(5.0);
        kit.scene.description.spheres[0].shadow_catcher = is_caught;
        rendered(&kit.prepared(), Backend::Native).picture
    };
    assert_eq!(look_up(true).direct, look_up(false).direct);
    assert_eq!(look_up(true).indirect, look_up(false).indirect);
}

#[test]
fn lanes_and_opacity_change_nothing_but_what_they_must() {
    let mut kit = ball_over_ground();
    kit.ball([0.0, 6.0, 0.0], 0.5, glass(1.5));
    let with_glass = kit.mean();
    // Partly transparent spheres let as much of the light through.
    let mut veiled = ball_over_ground();
    veiled.material(1).opacity = 0.5;
    let expected = 4.0 * (1.0 - BLOCKED * (1.0 - 0.5f64.powi(2)));
    veiled.mean().must_be(expected, "through both walls of a veil");
    with_glass.must_agree(ball_over_ground().mean(), "glass in the shadow of the ball");
}
