//! Rough metal and glass in whole pictures: furnaces, and agreement between ways of finding light.
//!
//! Means are over 32 independent seeds, judged as `common/render.rs` says.

#[path = "common/render.rs"]
mod common;

use common::Rendered;
use photosphere::accel::Backend;
use photosphere::verify::statistics::Estimate;

/// What the tables of lost energy may be off.
const TABLES: f64 = 5e-4;

/// A ball alone in a field of radiance 1.
const FIELD: &str = r#"
format = 1
[image]
width = 6
height = 6
[camera]
position = [0.0, 0.0, 4.0]
look_at = [0.0, 0.0, 0.0]
vertical_fov_degrees = 24.0
[background]
radiance = [1.0, 1.0, 1.0]
[materials.lossless]
type = "conductor"
ior = [0.0, 0.0, 0.0]
extinction = [1.0, 1.0, 1.0]
[materials.gold]
type = "conductor"
metal = "gold"
roughness = 0.4
[materials.glass]
type = "dielectric"
ior = 1.5
[materials.mixture]
type = "principled"
base_color = [0.8, 0.8, 0.8]
metallic = 0.2
transmission = 0.6
coat = 0.5
[materials.lamp]
type = "diffuse"
albedo = [0.0, 0.0, 0.0]
emission = [9.0, 9.0, 9.0]
[[spheres]]
name = "ball"
center = [0.0, 0.0, 0.0]
radius = 1.0
material = "lossless"
[render]
samples_per_pixel = 16
"#;

/// The ball's surface there.
const LOSSLESS: &str = "type = \"conductor\"
ior = [0.0, 0.0, 0.0]
extinction = [1.0, 1.0, 1.0]";

/// Two lamps in place of the field, one so near that it reaches below the ball's horizon.
const LAMPS: &str = r#"
[[spheres]]
center = [1.5, 2.0, 1.5]
radius = 1.2
material = "lamp"
[[spheres]]
center = [-3.0, 0.0, 3.0]
radius = 0.3
material = "lamp"
"#;

fn must_be_near(estimate: Estimate, expected: f64, what: &str) {
    let off = (estimate.mean - expected).abs();
    let allowed = 4.0 * estimate.standard_error + TABLES * expected;
    assert!(off <= allowed, "{what}: {estimate:?} is not {expected}");
}

#[test]
fn a_lossless_metal_vanishes_in_a_uniform_field_at_every_roughness() {
    for roughness in ["0", "0.1", "0.5", "1"] {
        let roughness = format!("materials.lossless.roughness={roughness}");
        let estimate = Estimate::of_scene(FIELD, &[&roughness], Backend::BruteForce);
        must_be_near(estimate, 1.0, &roughness);
    }
}

/// From inside a ball of index 10 a path is reflected about a hundred times: weights that are only right
/// on average made it dark, but for rare glaring pixels.
#[test]
fn the_densest_and_roughest_glass_vanishes_in_a_uniform_field() {
    for ior in ["0.1", "1.1", "3", "10"] {
        let dense =
            [format!("materials.glass.ior={ior}"), "spheres.ball.material=glass".to_owned()];
        for roughness in ["0.3", "1"] {
            let roughness = format!("materials.glass.roughness={roughness}");
            let overrides = [&*dense[0], &*dense[1], &*roughness];
            let estimate = Estimate::of_scene(FIELD, &overrides, Backend::BruteForce);
            assert!(estimate.standard_error < 3e-3, "{overrides:?}: {estimate:?}");
            must_be_near(estimate, 1.0, &format!("{overrides:?}"));
        }
    }
}

/// The same of balls that are partly matt: their gloss and what is beneath it throw light back as often.
#[test]
fn dense_mixtures_vanish_in_a_uniform_field() {
    let white = "spheres.ball.material=mixture materials.mixture.base_color=[1,1,1] \
                 materials.mixture.coat=0";
    for (ior, metallic, roughness) in
        [("10", "0", "0.5"), ("10", "0", "1"), ("3", "0.3", "0.8"), ("10", "0.2", "0")]
    {
        let told = [("ior", ior), ("metallic", metallic), ("roughness", roughness)];
        let told = told.map(|(key, value)| format!("materials.mixture.{key}={value}"));
        let overrides: Vec<&str> =
            white.split_whitespace().chain(told.iter().map(String::as_str)).collect();
        let estimate = Estimate::of_scene(FIELD, &overrides, Backend::BruteForce);
        assert!(estimate.standard_error < 3e-3, "{overrides:?}: {estimate:?}");
        must_be_near(estimate, 1.0, &format!("{overrides:?}"));
    }
}

/// At roughness 1 more than half of the light is drawn by a second pair of numbers, where a facet sends
/// none out.
#[test]
fn evenly_spread_numbers_are_worth_it_on_the_roughest_metal() {
    let gradient = "[background.gradient]\nzenith = [2.0, 2.0, 2.0]\nhorizon = [0.5, 0.5, 0.5]\n\
                    nadir = [0.1, 0.1, 0.1]";
    let text = FIELD.replace("[background]\nradiance = [1.0, 1.0, 1.0]", gradient);
    let mean_variance = |sampler: &str| {
        let sampler = format!("render.sampler={sampler}");
        let mut scene = common::scene(
            &text,
            &[
                "spheres.ball.material=gold",
                "materials.gold.roughness=1",
                "camera.vertical_fov_degrees=10",
                "render.samples_per_pixel=256",
                &sampler,
            ],
        );
        let pictures: Vec<_> = (0..16)
            .map(|seed| {
                scene.set_seed(seed);
                common::outcome(&scene, Backend::BruteForce).picture
            })
            .collect();
        let variance = |pixel| {
            let values: Vec<f64> =
                pictures.iter().map(|picture| f64::from(picture.beauty(pixel).y)).collect();
            Estimate::of(&values).standard_error.powi(2)
        };
        (0..36).map(variance).sum::<f64>()
    };
    // Each variance is known within 6 % (540 degrees of freedom). The gain is 6.6; with independent
    // numbers for the second pair it was 2.9.
    let gain = mean_variance("independent") / mean_variance("sobol");
    assert!(gain > 4.5, "{gain}");
}

#[test]
fn light_found_by_chance_and_light_aimed_at_agree_on_rough_surfaces() {
    for material in ["gold", "glass", "mixture"] {
        for roughness in ["0.2", "0.6", "1"] {
            both_ways_agree(LAMPS, material, roughness);
        }
    }
}

#[test]
fn they_agree_where_the_lamp_is_behind_rough_glass_or_in_it() {
    let behind = "[[spheres]]\ncenter = [0, 0, -4]\nradius = 1.5\nmaterial = \"lamp\"\n";
    let inside = "[[spheres]]\ncenter = [0.1, 0.2, 0]\nradius = 0.3\nmaterial = \"lamp\"\n";
    let around = "[[spheres]]\ncenter = [0, 0, 0]\nradius = 2.0\nmaterial = \"mixture\"\n";
    both_ways_agree(behind, "glass", "0.4");
    both_ways_agree(inside, "glass", "0.4");
    both_ways_agree(&format!("{inside}{around}"), "glass", "0.7");
}

/// The same picture of a rough ball by aiming at lamps and by chance.
fn both_ways_agree(spheres: &str, material: &str, roughness: &str) {
    let text = format!("{FIELD}{spheres}");
    let of_ball = format!("spheres.ball.material={material}");
    let roughness = format!("materials.{material}.roughness={roughness}");
    let by = |more: &[&str]| {
        let scene = ["background.radiance=[0,0,0]", &of_ball, &roughness];
        let overrides: Vec<&str> = scene.iter().chain(more).copied().collect();
        Estimate::of_scene(&text, &overrides, Backend::BruteForce)
    };
    let aimed = by(&["render.samples_per_pixel=64"]);
    let by_chance = by(&["render.integrator=paper", "render.samples_per_pixel=256"]);
    aimed.must_agree(by_chance, &roughness);
}

#[test]
fn every_material_may_glow() {
    for surface in [
        "type = \"diffuse\"\nalbedo = [0, 0, 0]",
        "type = \"diffuse\"\nalbedo = [0, 0, 0]\nroughness = 0.5",
        "type = \"mirror\"\nreflectance = [0, 0, 0]",
        "type = \"conductor\"\nmetal = \"iron\"\nroughness = 0.5",
        "type = \"dielectric\"\nglass = \"diamond\"",
        "type = \"dielectric\"\nior = 1.5\nroughness = 0.3",
        "type = \"plastic\"\nalbedo = [0, 0, 0]",
        "type = \"principled\"\nbase_color = [0, 0, 0]",
        "type = \"principled\"\nbase_color = [1, 1, 1]\ntransmission = 1",
        "type = \"phong\"\nalbedo = [0, 0, 0]\nspecular = [0, 0, 0]\nexponent = 1",
    ] {
        // In the dark a ball sends its emission and, where light can run through it, more.
        let ball = format!("{surface}\nemission = [0.5, 0.5, 0.5]");
        let text = FIELD.replace(LOSSLESS, &ball);
        let dark = ["background.radiance=[0,0,0]", "camera.vertical_fov_degrees=10"];
        let estimate = Estimate::of_scene(&text, &dark, Backend::BruteForce);
        let is_opaque = !surface.contains("dielectric") && !surface.contains("transmission");
        if is_opaque {
            must_be_near(estimate, 0.5, surface);
        } else {
            // Le at the front, and through it, over the squared index, what glows behind.
            assert!(estimate.mean > 0.52, "{surface}: {estimate:?}");
        }
    }
}
