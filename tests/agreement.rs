//! `path` and `paper` agree where light is awkward: two estimators that share no lamp sampling.
//!
//! Direct and indirect light are compared apart, over 32 seeds and within four standard errors (see
//! `common/render.rs`); and a room without a lamp stays black whatever shines outside.

#[path = "common/render.rs"]
mod common;

use common::{Estimate, Rendered, SEEDS, outcome, scene};
use photosphere::accel::Backend;
use photosphere::film::Picture;

/// The setting of all of them; each adds its spheres.
const HEAD: &str = r#"
format = 1
[image]
width = 8
height = 8
[camera]
position = [0.0, 1.0, 6.0]
look_at = [0.0, 0.5, 0.0]
vertical_fov_degrees = 40.0
[materials.grey]
type = "diffuse"
albedo = [0.6, 0.6, 0.6]
[materials.lamp]
type = "diffuse"
albedo = [0.3, 0.3, 0.3]
emission = [3.0, 3.0, 3.0]
[materials.dim]
type = "diffuse"
albedo = [0.0, 0.0, 0.0]
emission = [0.7, 0.7, 0.7]
[materials.mirrorlamp]
type = "mirror"
reflectance = [0.5, 0.5, 0.5]
emission = [2.0, 2.0, 2.0]
[materials.glasslamp]
type = "dielectric"
ior = 1.5
emission = [1.0, 1.0, 1.0]
[materials.glass]
type = "dielectric"
ior = 1.5
[materials.water]
type = "dielectric"
ior = 1.33
priority = -1
[materials.mirror]
type = "mirror"
reflectance = [0.9, 0.9, 0.9]
[materials.phong]
type = "phong"
albedo = [0.3, 0.3, 0.3]
specular = [0.5, 0.5, 0.5]
exponent = 20
normalized = true
[materials.phongc]
type = "phong"
albedo = [0.1, 0.1, 0.1]
specular = [0.2, 0.2, 0.2]
exponent = 10
normalized = false
[background]
radiance = [0.2, 0.2, 0.2]
[render]
max_depth = 5
"#;

fn sphere(center: [f64; 3], radius: f64, material: &str) -> String {
    format!("\n[[spheres]]\ncenter = {center:?}\nradius = {radius:?}\nmaterial = \"{material}\"\n")
}

fn spheres(rows: &[([f64; 3], f64, &str)]) -> String {
    rows.iter().map(|&(center, radius, material)| sphere(center, radius, material)).collect()
}

/// Direct and indirect light of a scene, over seeds.
fn layers(text: &str, overrides: &[&str]) -> [Estimate; 2] {
    let pictures: Vec<Picture> = (0..SEEDS)
        .map(|seed| {
            let seed = format!("render.seed={seed}");
            outcome(&scene(text, &[overrides, &[&seed]].concat()), Backend::BruteForce).picture
        })
        .collect();
    let mean = |layer: fn(&Picture) -> &Vec<photosphere::color::Rgb>| {
        let of =
            |p: &Picture| layer(p).iter().map(|c| f64::from(c.y)).sum::<f64>() / p.len() as f64;
        Estimate::of(&pictures.iter().map(of).collect::<Vec<_>>())
    };
    [mean(|p| &p.direct), mean(|p| &p.indirect)]
}

fn must_agree(name: &str, rows: &[([f64; 3], f64, &str)], more: &[&str]) {
    let text = format!("{HEAD}{}", spheres(rows));
    let [path, paper] = [("path", "64"), ("paper", "256")].map(|(integrator, samples)| {
        let integrator = format!("render.integrator={integrator}");
        let samples = format!("render.samples_per_pixel={samples}");
        layers(&text, &[&[&integrator[..], &samples], more].concat())
    });
    for (layer, (path, paper)) in ["direct", "indirect"].iter().zip(path.into_iter().zip(paper)) {
        path.must_agree(paper, &format!("{name}, {layer}"));
    }
}

const GROUND: ([f64; 3], f64, &str) = ([0.0, -100.0, 0.0], 100.0, "grey");
const BALL: ([f64; 3], f64, &str) = ([0.5, 0.5, 0.0], 0.5, "grey");
const LAMP: ([f64; 3], f64, &str) = ([0.0, 3.0, 2.0], 1.0, "lamp");

#[test]
fn lamps_in_the_ground_in_glass_and_in_each_other() {
    must_agree("lamp in the ground", &[GROUND, BALL, ([-1.0, 0.2, 0.0], 0.5, "lamp")], &[]);
    let in_glass = [([-1.0, 0.8, 0.0], 0.8, "glass"), ([-1.0, 0.8, 0.0], 0.5, "lamp")];
    must_agree("lamp in glass", &[&[GROUND, BALL][..], &in_glass].concat(), &[]);
    let poking = [([-1.0, 0.8, 0.0], 0.6, "glass"), ([-0.6, 0.8, 0.0], 0.5, "lamp")];
    must_agree("lamp poking out of glass", &[&[GROUND, BALL][..], &poking].concat(), &[]);
    let nested = [([-1.0, 1.0, 0.0], 0.7, "lamp"), ([-0.5, 1.0, 0.2], 0.6, "dim")];
    must_agree("overlapping lamps", &[&[GROUND, BALL][..], &nested].concat(), &[]);
}

#[test]
fn a_camera_among_and_inside_lamps() {
    must_agree("inside a lamp", &[GROUND, BALL, ([0.0, 1.0, 3.0], 20.0, "lamp")], &[]);
    let rooms = [
        ([0.0, 1.0, 0.0], 9.0, "dim"),
        ([-0.5, 1.0, 0.2], 0.6, "lamp"),
        ([0.0, 1.0, 0.0], 10.0, "lamp"),
    ];
    must_agree("a room of lamps", &[&[GROUND, BALL][..], &rooms].concat(), &[]);
    let sizes = [
        ([-1.0, 0.7, 0.0], 0.6, "lamp"),
        ([0.0, 3e4, 0.0], 1e4, "dim"),
        ([1.2, 0.3, 0.5], 0.2, "dim"),
        ([0.0, -2e6, 0.0], 1e6, "dim"),
    ];
    must_agree("lamps of many sizes", &[&[GROUND, BALL][..], &sizes].concat(), &[]);
}

#[test]
fn glowing_mirrors_glowing_glass_and_both_phongs() {
    let mirror = [([-0.8, 0.7, 0.0], 0.6, "mirrorlamp"), LAMP];
    must_agree("glowing mirror", &[&[GROUND, BALL][..], &mirror].concat(), &[]);
    let glass = [([-1.0, 1.0, 0.0], 0.7, "glasslamp"), ([-1.0, 1.0, 0.0], 0.3, "grey")];
    must_agree("glowing glass", &[&[GROUND, BALL][..], &glass].concat(), &[]);
    let phong = [([0.5, 0.5, 0.0], 0.5, "phong"), ([-0.7, 0.5, 0.0], 0.5, "phongc"), LAMP];
    must_agree("phong", &[&[GROUND][..], &phong].concat(), &[]);
}

#[test]
fn boundaries_hidden_in_glass_let_light_through() {
    let hidden = [
        ([0.0, 0.5, 0.0], 2.0, "glass"),
        ([0.2, 0.5, 0.0], 1.2, "water"),
        ([0.0, 0.5, 0.0], 0.5, "grey"),
        ([0.0, 1.9, 0.0], 0.4, "lamp"),
    ];
    must_agree("a hidden boundary before a lamp", &hidden, &[]);
    let underwater = [
        ([0.0, 1.0, 0.0], 8.0, "water"),
        ([-0.5, 1.0, 1.0], 0.7, "glass"),
        ([0.0, 3.0, 0.0], 0.8, "lamp"),
    ];
    must_agree("a camera under water", &[&[GROUND, BALL][..], &underwater].concat(), &[]);
}

#[test]
fn a_closed_room_stays_black_whatever_shines_outside() {
    // Rooms of matt walls, one of them far off the origin and one huge, with a ball poking through
    // the wall and one touching it from inside; two lamps outside. Not one path may see them.
    for (x, r) in [(0.0, 1.0), (30.0, 1.0), (0.0, 1e5)] {
        let room = [
            ([x, 0.0, 0.0], r, "grey"),
            ([x, 0.9 * r, 0.0], 0.2 * r, "grey"),
            ([x + 0.6 * r, 0.0, 0.0], 0.4 * r, "grey"),
            ([x, 3.0 * r, 0.0], r, "lamp"),
            ([x, 0.0, 4.0 * r], r, "lamp"),
            ([-0.1, 0.0, 0.0], 0.01, "grey"),
            ([-0.2, 0.0, 0.0], 0.01, "grey"),
            ([-0.3, 0.0, 0.0], 0.01, "grey"),
        ];
        // The last three keep the origin away from the second room.
        let count = if x > 0.0 { room.len() } else { 5 };
        let text = format!("{HEAD}{}", spheres(&room[..count]));
        let position = format!("camera.position=[{}, 0, 0]", x + 0.3 * r);
        let look_at = format!("camera.look_at=[{x}, {}, 0]", 0.5 * r);
        let view = [&position[..], &look_at, "camera.vertical_fov_degrees=80"];
        let size = ["image.width=64", "image.height=64", "render.samples_per_pixel=16"];
        let scene = scene(&text, &[&view[..], &size].concat());
        for &backend in Backend::AVAILABLE {
            let picture = outcome(&scene, backend).picture;
            let lit = (0..picture.len()).filter(|&i| picture.beauty(i).max_element() > 0.0).count();
            assert_eq!(lit, 0, "room of radius {r} at {x}, {}", backend.name());
        }
    }
}
