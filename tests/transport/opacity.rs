//! Surfaces that are there only with a probability, against closed forms.

use photosphere::accel::Backend;
use photosphere::color::Rgb;
use photosphere::scene::MaterialHandle;
use photosphere::scene::description::{MaterialDescription, SurfaceModel};
use photosphere::scene::settings::{FilterKind, ImageSettings};

use crate::kit::{Judged, Kit, MeanEstimate, rendered};

/// Looks along -z from z = 1/2 at a small grey ball, which fills the picture.
fn ball() -> Kit {
    let mut kit = Kit::new(2, 2, 16);
    kit.scene.camera([0.0, 0.0, 0.5], [0.0; 3]).field_of_view(0.5);
    let grey = kit.scene.diffuse([0.5; 3]);
    kit.scene.sphere(grey, [0.0; 3], 0.01);
    kit
}

/// Adds a black sphere that glows and is there with a probability.
fn shell(kit: &mut Kit, center: [f64; 3], radius: f64, emission: f32, opacity: f64) {
    let surface = SurfaceModel::Diffuse { albedo: Rgb::ZERO, roughness: 0.0 };
    let emission = Rgb::splat(emission);
    let material = MaterialDescription { surface, emission, opacity, ..Default::default() };
    let shell = kit.scene.material(material);
    kit.scene.sphere(shell, center, radius);
}

/// Glass that is there with a probability.
fn glass(kit: &mut Kit, opacity: f64) -> MaterialHandle {
    let surface =
        SurfaceModel::Dielectric { ior: 1.5, roughness: 0.0, priority: 0, absorption: Rgb::ZERO };
    kit.scene.material(MaterialDescription { surface, opacity, ..Default::default() })
}

/// With the ball out of the way, and with more samples.
fn without_the_ball(kit: &mut Kit) {
    kit.scene.description.spheres[0].center = [9.0, 0.0, 0.0].into();
    kit.settings.render.samples_per_pixel = 64;
}

fn must_be(kit: &Kit, expected: f64) {
    for kit in kit.clone().both_ways() {
        kit.mean().must_be(expected, &kit.how());
    }
}

/// The camera sees two walls of a veil before the background: `o e + (1 - o)(o e + (1 - o) L)`.
#[test]
fn a_veil_shows_itself_and_what_is_behind() {
    let mut kit = ball().with(without_the_ball);
    shell(&mut kit, [0.0, 0.0, -3.0], 1.0, 0.7, 0.3);
    kit.scene.background([2.0; 3]);
    let own = 0.3 * 0.7;
    must_be(&kit, own + 0.7 * (own + 0.7 * 2.0));
}

/// Inside a veil inside a glowing shell: light is dimmed by the veil and joined by its own. The
/// paths cross the veil once, or twice where the camera stands outside of it.
#[test]
fn emitters_shine_through_a_veil() {
    let mut kit = ball();
    shell(&mut kit, [0.0; 3], 1.0, 0.7, 0.3);
    shell(&mut kit, [0.0; 3], 3.0, 2.0, 1.0);
    let own = 0.3 * 0.7;
    let ball = 0.5 * (own + 0.7 * 2.0);
    must_be(&kit, ball);
    kit.scene.camera([0.0, 0.0, 2.0], [0.0; 3]).field_of_view(0.1);
    must_be(&kit, own + 0.7 * ball);
}

/// An emitter that is half there: both of its walls shine, the far one through the near one. Light
/// samples take either of them, and no light is lost or counted twice.
#[test]
fn both_walls_of_a_veiled_emitter_shine() {
    let emitter = |opacity| {
        let mut kit = ball();
        kit.settings.render.samples_per_pixel = 256;
        shell(&mut kit, [2.0, 0.0, 1.0], 1.2, 3.0, opacity);
        kit
    };
    let opaque = emitter(1.0).mean();
    let share = 1.0 - 0.6 * 0.6;
    let (expected, error) = (share * opaque.mean, share * opaque.standard_error);
    let expected = MeanEstimate { mean: expected, standard_error: error, ..opaque };
    for kit in emitter(0.4).both_ways() {
        kit.mean().must_agree(expected, &kit.how());
    }
}

/// In a uniform field of light glass is invisible, whether it is there or not.
#[test]
fn glass_that_is_half_there_keeps_a_uniform_field() {
    let mut kit = ball();
    let glass = glass(&mut kit, 0.5);
    kit.scene.sphere(glass, [0.0, 0.0, -3.0], 1.0).background([2.0; 3]);
    must_be(&kit.clone().with(without_the_ball), 2.0);
    // The ball inside of it sees the field, too, now white: with n^2 times the radiance where there
    // is glass, of which the camera outside gets the n^2-th part.
    kit.scene.field_of_view(10.0);
    let description = &mut kit.scene.description;
    description.spheres[0].center = [0.0, 0.0, -3.0].into();
    description.materials[0].surface = SurfaceModel::Diffuse { albedo: Rgb::ONE, roughness: 0.0 };
    must_be(&kit, 2.0);
}

fn pixels(kit: &Kit) -> Vec<[f32; 3]> {
    let filter = FilterKind::Tent;
    let filter_radius = ImageSettings::default_filter_radius(filter);
    let mut kit = kit.clone();
    kit.settings.image = ImageSettings { width: 24, height: 24, crop: None, filter, filter_radius };
    let picture = kit.picture();
    (0..picture.len()).map(|pixel| picture.beauty(pixel).to_array()).collect()
}

#[test]
fn a_sphere_that_is_never_there_changes_nothing() {
    let mut kit = ball();
    shell(&mut kit, [2.0, 0.0, 1.0], 1.2, 3.0, 1.0);
    kit.scene.background([0.5, 0.6, 0.7]);
    let alone = pixels(&kit);
    shell(&mut kit, [0.2, 0.0, 0.1], 0.15, 9.0, 0.0);
    let glass = glass(&mut kit, 0.0);
    kit.scene.sphere(glass, [0.0, 0.0, 0.3], 0.25);
    for (ghost, plain) in pixels(&kit).iter().zip(alone) {
        // The same but for the rounding of points where rays start again.
        for (a, b) in ghost.iter().zip(plain) {
            assert!((a - b).abs() <= 1e-5 * b.abs().max(1e-3), "{a} {b}");
        }
    }
}

#[test]
fn walking_shadow_rays_answers_like_asking_for_shadows() {
    let options = ["image.width=24", "image.height=18", "render.samples_per_pixel=4"];
    let mut kit = Kit::of_file("cornell-spheres.toml", &options);
    let mean = |kit: &Kit| rendered(&kit.prepared(), Backend::Native).picture.mean();
    let asked = mean(&kit);
    shell(&mut kit, [0.0, 1e6, 0.0], 1.0, 0.0, 0.5);
    assert_eq!(asked, mean(&kit));
}
