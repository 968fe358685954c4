//! What mirrors and lenses make of light.

use photosphere::accel::Backend;

use crate::common::{Estimate, Rendered, picture};
use crate::scenes::ESTIMATORS;

#[test]
fn two_mirrors_facing_each_other_add_up_a_geometric_series() {
    // Along the common axis: L = e_a + r_a (e_b + r_b (e_a + ...)), six edges long.
    let text = r#"
format = 1
[image]
width = 1
height = 1
[camera]
position = [0.0, 0.0, 0.0]
look_at = [0.0, 0.0, 1.0]
vertical_fov_degrees = 0.000001
[materials.a]
type = "mirror"
reflectance = [0.5, 0.5, 0.5]
emission = [1.0, 1.0, 1.0]
[materials.b]
type = "mirror"
reflectance = [0.8, 0.8, 0.8]
emission = [0.25, 0.25, 0.25]
[[spheres]]
center = [0.0, 0.0, 2.0]
radius = 1.0
material = "a"
[[spheres]]
center = [0.0, 0.0, -3.0]
radius = 2.0
material = "b"
[render]
samples_per_pixel = 64
max_depth = 6
"#;
    let round = 1.0 + 0.5 * 0.25;
    let expected = round * (1.0 + 0.4 + 0.16);
    for estimator in &ESTIMATORS[..2] {
        Estimate::of_scene(text, estimator, Backend::BruteForce).must_be(expected, "two mirrors");
    }
}

#[test]
fn a_glass_ball_has_its_focus_where_lens_makers_say() {
    // A ball lens of index n and radius R focuses paraxial rays n R / (2 (n - 1)) from its centre:
    // 1.5 R for n = 1.5. A tiny lamp there fills the view; one 5 % further fills a part of it.
    let share = |z: f64| {
        let text = format!(
            r#"
format = 1
[image]
width = 32
height = 32
[camera]
position = [0.0, 0.0, -100000.0]
look_at = [0.0, 0.0, 0.0]
vertical_fov_degrees = 0.00004
[materials.glass]
type = "dielectric"
ior = 1.5
[materials.lamp]
type = "diffuse"
albedo = [0.0, 0.0, 0.0]
emission = [1.0, 1.0, 1.0]
[[spheres]]
center = [0.0, 0.0, 0.0]
radius = 1.0
material = "glass"
[[spheres]]
center = [0.0, 0.0, {z}]
radius = 0.0003
material = "lamp"
[render]
samples_per_pixel = 16
max_depth = 3
"#
        );
        picture(&text, &[]).mean().y
    };
    // 4 % is reflected at each of the two surfaces.
    let focused = share(1.5);
    assert!((focused - 0.96 * 0.96).abs() < 0.01, "{focused}");
    assert!(share(1.575) < 0.5 * focused);
    assert!(share(1.425) < 0.5 * focused);
}
