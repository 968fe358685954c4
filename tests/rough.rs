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

#[test]
fn light_found_by_chance_and_light_aimed_at_agree_on_rough_metal() {
    let text = format!("{FIELD}{LAMPS}");
    for roughness in ["0.2", "0.6", "1"] {
        let roughness = format!("materials.gold.roughness={roughness}");
        let scene = ["background.radiance=[0,0,0]", "spheres.ball.material=gold", &roughness];
        let by = |more: &[&str]| {
            let overrides: Vec<&str> = scene.iter().chain(more).copied().collect();
            Estimate::of_scene(&text, &overrides, Backend::BruteForce)
        };
        let aimed = by(&["render.samples_per_pixel=64"]);
        let by_chance = by(&["render.integrator=paper", "render.samples_per_pixel=256"]);
        aimed.must_agree(by_chance, &roughness);
    }
}
