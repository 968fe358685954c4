//! Absorption inside transparent spheres against closed forms. With an index of 1 a sphere neither
//! reflects nor refracts, so that a ray along an axis keeps `exp(-absorption x length)` of the light.

#[path = "common/render.rs"]
mod common;

use common::{Estimate, Rendered, picture};
use photosphere::accel::Backend;

/// Looks along -z from z = 5 at a background of radiance 2; the view is so narrow that all rays are
/// the axis. Spheres are added by each test.
const AXIS: &str = r#"
format = 1
[image]
width = 2
height = 2
[camera]
position = [0, 0, 5]
look_at = [0, 0, 0]
vertical_fov_degrees = 1e-4
[background]
radiance = [2, 2, 2]
[render]
samples_per_pixel = 4
"#;

/// A transparent sphere around a place on the axis.
fn ball(name: &str, z: f64, radius: f64, keys: &str) -> String {
    format!(
        "[materials.{name}]\ntype = \"dielectric\"\n{keys}\n\
         [[spheres]]\ncenter = [0, 0, {z}]\nradius = {radius}\nmaterial = \"{name}\"\n"
    )
}

/// The green channel of the mean, which must be free of noise.
fn seen(spheres: &[String], overrides: &[&str]) -> f64 {
    picture(&format!("{AXIS}{}", spheres.concat()), overrides).mean().y
}

fn assert_is(found: f64, expected: f64) {
    assert!((found / expected - 1.0).abs() < 1e-5, "{found} is not {expected}");
}

#[test]
fn light_fades_along_a_diameter() {
    let dark = ball("dark", 0.0, 1.5, "ior = 1\nabsorption = [0, 0.7, 0]");
    for integrator in ["render.integrator=path", "render.integrator=paper"] {
        assert_is(seen(std::slice::from_ref(&dark), &[integrator]), 2.0 * f64::exp(-0.7 * 3.0));
    }
}

#[test]
fn a_camera_inside_sees_through_what_is_left_of_the_way() {
    let dark = [ball("dark", 0.0, 1.5, "ior = 1\nabsorption = [0, 0.7, 0]")];
    let centre = ["camera.position=[0, 0, 0]", "camera.look_at=[0, 0, -1]"];
    assert_is(seen(&dark, &centre), 2.0 * f64::exp(-0.7 * 1.5));
    let near = [centre[0], centre[1], "camera.near=0.5"];
    assert_is(seen(&dark, &near), 2.0 * f64::exp(-0.7));
}

#[test]
fn the_medium_that_fills_the_space_absorbs() {
    // A clear bubble of radius 1 in a dark ball of radius 2.
    let dark = |keys: &str| ball("dark", 0.0, 2.0, &format!("ior = 1\n{keys}"));
    let bubble = ball("bubble", 0.3, 1.0, "ior = 1");
    let nested = [dark("absorption = [0, 0.7, 0]"), bubble.clone()];
    assert_is(seen(&nested, &[]), 2.0 * f64::exp(-0.7 * 2.0));
    // Of higher priority, the ball fills the bubble too.
    let filled = [dark("absorption = [0, 0.7, 0]\npriority = 1"), bubble];
    assert_is(seen(&filled, &[]), 2.0 * f64::exp(-0.7 * 4.0));
    // Two that overlap: the one of higher priority has its diameter, the other what is left.
    let first = ball("first", 0.0, 1.0, "ior = 1\nabsorption = [0, 0.5, 0]\npriority = 3");
    let second = ball("second", 1.0, 1.0, "ior = 1\nabsorption = [0, 0.2, 0]");
    let expected = 2.0 * f64::exp(-(0.5 * 2.0 + 0.2));
    assert_is(seen(&[first.clone(), second.clone()], &[]), expected);
    let behind = ["camera.position=[0, 0, -5]"];
    assert_is(seen(&[first, second], &behind), expected);
}

/// On the axis light goes to and fro in glass: of what comes in, `x = exp(-a d)` is left each time,
/// and `F = 0.04` is reflected. All that leaves towards the camera came from the background:
/// `F + (1 - F)^2 x (1 + F x + F^2 x^2 + ...)`.
#[test]
fn reflections_inside_absorbing_glass_add_up() {
    let glass = ball("glass", 0.0, 1.0, "ior = 1.5\nabsorption = [0, 0.3, 0]");
    let text = format!("{AXIS}{glass}");
    let x = f64::exp(-0.6);
    let expected = 2.0 * (0.04 + 0.96 * 0.96 * x / (1.0 - 0.04 * x));
    let spp = ["render.samples_per_pixel=256"];
    let found = Estimate::of_scene(&text, &spp, Backend::BruteForce);
    found.must_be(expected, "glass on the axis");
}

/// A tiny matt ball in the middle of a glowing shell of radius 3, all in one dark medium: light
/// fades over 3 on its way to the ball and over 1 on its way to the camera.
#[test]
fn lamps_are_aimed_at_through_the_medium() {
    let medium = ball("dark", 0.0, 10.0, "ior = 1.33\nabsorption = [0, 0.4, 0]");
    let text = format!(
        "{AXIS}{medium}\
         [materials.lamp]\ntype = \"diffuse\"\nalbedo = [0, 0, 0]\nemission = [5, 5, 5]\n\
         [materials.white]\ntype = \"diffuse\"\nalbedo = [0.5, 0.5, 0.5]\n\
         [[spheres]]\ncenter = [0, 0, 0]\nradius = 3\nmaterial = \"lamp\"\n\
         [[spheres]]\ncenter = [0, 0, 0]\nradius = 1e-6\nmaterial = \"white\"\n"
    );
    let expected = 5.0 * 0.5 * f64::exp(-0.4 * 4.0);
    for integrator in ["render.integrator=path", "render.integrator=paper"] {
        let inside = ["camera.position=[0, 0, 1]", "camera.vertical_fov_degrees=1e-5", integrator];
        let found = Estimate::of_scene(&text, &inside, Backend::BruteForce);
        found.must_be(expected, integrator);
    }
}
