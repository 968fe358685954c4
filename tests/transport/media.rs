//! Absorption inside transparent spheres against closed forms. With an index of 1 a sphere neither
//! reflects nor refracts, so that a ray along an axis keeps `exp(-absorption x length)` of the
//! light.

use photosphere::color::Rgb;
use photosphere::scene::description::SurfaceModel;

use crate::kit::{Judged, Kit, diffuse, glass};

/// Transparent spheres around places on the axis, each `(z, radius, surface)`.
///
/// The camera looks along -z from z = 5 at a background of radiance 2; the view is so narrow that
/// all rays are the axis.
fn axis(balls: &[(f64, f64, SurfaceModel)]) -> Kit {
    let mut kit = Kit::new(2, 2, 4);
    kit.scene.camera([0.0, 0.0, 5.0], [0.0; 3]).field_of_view(1e-4).background([2.0; 3]);
    for &(z, radius, surface) in balls {
        kit.ball([0.0, 0.0, z], radius, surface);
    }
    kit
}

/// A medium that absorbs green light.
fn dark(ior: f64, absorption: f32, priority: i32) -> SurfaceModel {
    SurfaceModel::Dielectric {
        ior,
        roughness: 0.0,
        priority,
        absorption: Rgb::new(0.0, absorption, 0.0),
    }
}

/// The green channel of the mean, which must be free of noise.
fn seen(kit: &Kit) -> f64 {
    kit.picture().mean().y
}

fn assert_is(found: f64, expected: f64) {
    assert!((found / expected - 1.0).abs() < 1e-5, "{found} is not {expected}");
}

#[test]
fn light_fades_along_a_diameter() {
    for kit in axis(&[(0.0, 1.5, dark(1.0, 0.7, 0))]).both_ways() {
        assert_is(seen(&kit), 2.0 * f64::exp(-0.7 * 3.0));
    }
}

#[test]
fn a_camera_inside_sees_through_what_is_left_of_the_way() {
    let mut kit = axis(&[(0.0, 1.5, dark(1.0, 0.7, 0))]);
    kit.scene.camera([0.0; 3], [0.0, 0.0, -1.0]);
    assert_is(seen(&kit), 2.0 * f64::exp(-0.7 * 1.5));
    kit.scene.description.camera.near = 0.5;
    assert_is(seen(&kit), 2.0 * f64::exp(-0.7));
}

#[test]
fn the_medium_that_fills_the_space_absorbs() {
    // A clear bubble of radius 1 in a dark ball of radius 2.
    let bubble = (0.3, 1.0, glass(1.0));
    let nested = axis(&[(0.0, 2.0, dark(1.0, 0.7, 0)), bubble]);
    assert_is(seen(&nested), 2.0 * f64::exp(-0.7 * 2.0));
    // Of higher priority, the ball fills the bubble too.
    let filled = axis(&[(0.0, 2.0, dark(1.0, 0.7, 1)), bubble]);
    assert_is(seen(&filled), 2.0 * f64::exp(-0.7 * 4.0));
    // Two that overlap: the one of higher priority has its diameter, the other what is left.
    let mut two = axis(&[(0.0, 1.0, dark(1.0, 0.5, 3)), (1.0, 1.0, dark(1.0, 0.2, 0))]);
    let expected = 2.0 * f64::exp(-(0.5 * 2.0 + 0.2));
    assert_is(seen(&two), expected);
    two.scene.camera([0.0, 0.0, -5.0], [0.0; 3]);
    assert_is(seen(&two), expected);
}

/// On the axis light goes to and fro in glass: of what comes in, `x = exp(-a d)` is left each time,
/// and `F = 0.04` is reflected. All that leaves towards the camera came from the background:
/// `F + (1 - F)^2 x (1 + F x + F^2 x^2 + ...)`.
#[test]
fn reflections_inside_absorbing_glass_add_up() {
    let x = f64::exp(-0.6);
    let expected = 2.0 * (0.04 + 0.96 * 0.96 * x / (1.0 - 0.04 * x));
    let glass = axis(&[(0.0, 1.0, dark(1.5, 0.3, 0))]).samples(256);
    glass.mean().must_be(expected, "glass on the axis");
}

/// A tiny diffuse ball in the middle of a glowing shell of radius 3, all in one dark medium: light
/// fades over 3 on its way to the ball and over 1 on its way to the camera.
#[test]
fn emitters_are_aimed_at_through_the_medium() {
    let mut kit = axis(&[(0.0, 10.0, dark(1.33, 0.4, 0))]);
    kit.glowing_ball([0.0; 3], 3.0, diffuse(0.0), 5.0).ball([0.0; 3], 1e-6, diffuse(0.5));
    kit.scene.camera([0.0, 0.0, 1.0], [0.0; 3]).field_of_view(1e-5);
    let expected = 5.0 * 0.5 * f64::exp(-0.4 * 4.0);
    for kit in kit.both_ways() {
        kit.mean().must_be(expected, &kit.how());
    }
}

/// A ball whose index grows in 70 steps to 1.7 at its centre, in a uniform field: light in a medium
/// has the square of its index times the radiance outside, however deep the media nest.
#[test]
fn seventy_shells_are_seventy_media() {
    let mut kit = Kit::new(4, 4, 16);
    kit.scene.camera([0.0; 3], [0.0, 0.0, -1.0]).background([1.0; 3]);
    for shell in 1..=70 {
        kit.ball([0.0; 3], f64::from(71 - shell), glass(1.0 + 0.01 * f64::from(shell)));
    }
    kit.mean().must_be(1.7 * 1.7, "seventy shells");
}
