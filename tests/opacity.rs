//! Surfaces that are there only with a probability, against closed forms.

#[path = "common/render.rs"]
mod common;

use common::{Estimate, Rendered, outcome, picture, scene};
use photosphere::accel::Backend;

const INTEGRATORS: [&str; 2] = ["render.integrator=path", "render.integrator=paper"];

/// Looks along -z from z = 1/2 at a small grey ball, which fills the picture.
const BALL: &str = r#"
format = 1
[image]
width = 2
height = 2
[camera]
position = [0, 0, 0.5]
look_at = [0, 0, 0]
vertical_fov_degrees = 0.5
[materials.grey]
type = "diffuse"
albedo = [0.5, 0.5, 0.5]
[[spheres]]
center = [0, 0, 0]
radius = 0.01
material = "grey"
[render]
samples_per_pixel = 16
"#;

/// A black sphere that glows and is there with a probability.
fn shell(name: &str, center: [f64; 3], radius: f64, emission: f64, opacity: f64) -> String {
    format!(
        "[materials.{name}]\ntype = \"diffuse\"\nalbedo = [0, 0, 0]\nopacity = {opacity}\n\
         emission = [{emission}, {emission}, {emission}]\n\
         [[spheres]]\ncenter = {center:?}\nradius = {radius}\nmaterial = \"{name}\"\n"
    )
}

fn mean(text: &str, overrides: &[&str]) -> Estimate {
    Estimate::of_scene(text, overrides, Backend::BruteForce)
}

/// The camera sees two walls of a veil before the background: `o e + (1 - o)(o e + (1 - o) L)`.
#[test]
fn a_veil_shows_itself_and_what_is_behind() {
    let veil = shell("veil", [0.0, 0.0, -3.0], 1.0, 0.7, 0.3);
    let text = format!("{BALL}{veil}[background]\nradiance = [2, 2, 2]\n");
    let own = 0.3 * 0.7;
    let expected = own + 0.7 * (own + 0.7 * 2.0);
    for integrator in INTEGRATORS {
        let view = ["spheres.0.center=[9, 0, 0]", "render.samples_per_pixel=64", integrator];
        mean(&text, &view).must_be(expected, integrator);
    }
}

/// Inside a veil inside a glowing shell: light is dimmed by the veil and joined by its own. The paths
/// cross the veil once, or twice where the camera stands outside of it.
#[test]
fn lamps_shine_through_a_veil() {
    let veil = shell("veil", [0.0; 3], 1.0, 0.7, 0.3);
    let lamp = shell("lamp", [0.0; 3], 3.0, 2.0, 1.0);
    let text = format!("{BALL}{veil}{lamp}");
    let own = 0.3 * 0.7;
    let ball = 0.5 * (own + 0.7 * 2.0);
    for integrator in INTEGRATORS {
        mean(&text, &[integrator]).must_be(ball, integrator);
        let outside = ["camera.position=[0, 0, 2]", "camera.vertical_fov_degrees=0.1", integrator];
        mean(&text, &outside).must_be(own + 0.7 * ball, integrator);
    }
}

/// A lamp that is half there: both of its walls shine, the far one through the near one. Light is
/// aimed at the near wall only, and must still not be lost or counted twice.
#[test]
fn both_walls_of_a_veiled_lamp_shine() {
    let lamp = |opacity| {
        let lamp = shell("lamp", [2.0, 0.0, 1.0], 1.2, 3.0, opacity);
        format!("{BALL}{lamp}")
    };
    let many = "render.samples_per_pixel=256";
    let opaque = mean(&lamp(1.0), &[many]);
    let share = 1.0 - 0.6 * 0.6;
    let (expected, error) = (share * opaque.mean, share * opaque.standard_error);
    let expected = Estimate { mean: expected, standard_error: error, ..opaque };
    for integrator in INTEGRATORS {
        mean(&lamp(0.4), &[many, integrator]).must_agree(expected, integrator);
    }
}

/// In a uniform field of light glass is invisible, whether it is there or not.
#[test]
fn glass_that_is_half_there_keeps_a_uniform_field() {
    let glass = "[materials.glass]\ntype = \"dielectric\"\nior = 1.5\nopacity = 0.5\n\
                 [[spheres]]\ncenter = [0, 0, -3]\nradius = 1\nmaterial = \"glass\"\n\
                 [background]\nradiance = [2, 2, 2]\n";
    let text = format!("{BALL}{glass}");
    for integrator in INTEGRATORS {
        let view = ["spheres.0.center=[9, 0, 0]", "render.samples_per_pixel=64", integrator];
        mean(&text, &view).must_be(2.0, integrator);
    }
    // The grey ball inside of it sees the field, too: with n^2 times the radiance where there is
    // glass, of which the camera outside gets the n^2-th part.
    let inside = ["spheres.0.center=[0, 0, -3]", "spheres.0.material=white"];
    let white = "[materials.white]\ntype = \"diffuse\"\nalbedo = [1, 1, 1]\n";
    for integrator in INTEGRATORS {
        let view = [&inside[..], &["camera.vertical_fov_degrees=10", integrator]].concat();
        mean(&format!("{text}{white}"), &view).must_be(2.0, integrator);
    }
}

fn pixels(text: &str) -> Vec<[f32; 3]> {
    let picture = picture(text, &["image.width=24", "image.height=24", "image.filter=tent"]);
    (0..picture.len()).map(|pixel| picture.beauty(pixel).to_array()).collect()
}

#[test]
fn a_sphere_that_is_never_there_changes_nothing() {
    let lamp = shell("lamp", [2.0, 0.0, 1.0], 1.2, 3.0, 1.0);
    let alone = format!("{BALL}{lamp}[background]\nradiance = [0.5, 0.6, 0.7]\n");
    let glass = "[materials.glass]\ntype = \"dielectric\"\nior = 1.5\nopacity = 0\n\
                 [[spheres]]\ncenter = [0, 0, 0.3]\nradius = 0.25\nmaterial = \"glass\"\n";
    let veil = shell("veil", [0.2, 0.0, 0.1], 0.15, 9.0, 0.0);
    let with_ghosts = pixels(&format!("{alone}{veil}{glass}"));
    for (ghost, plain) in with_ghosts.iter().zip(pixels(&alone)) {
        // The same but for the rounding of points where rays start again.
        for (a, b) in ghost.iter().zip(plain) {
            assert!((a - b).abs() <= 1e-5 * b.abs().max(1e-3), "{a} {b}");
        }
    }
}

#[test]
fn walking_shadow_rays_answers_like_asking_for_shadows() {
    let text = common::scene_file("cornell-spheres.toml");
    let options = ["image.width=24", "image.height=18", "render.samples_per_pixel=4"];
    let veil = shell("unseen", [0.0, 1e6, 0.0], 1.0, 0.0, 0.5);
    let asked = outcome(&scene(&text, &options), Backend::Native).picture;
    let walked = outcome(&scene(&format!("{text}{veil}"), &options), Backend::Native).picture;
    assert_eq!(asked.mean(), walked.mean());
}
