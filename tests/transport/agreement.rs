//! `path` and `paper` agree where light is awkward: two estimators that share no emitter sampling.
//!
//! Direct and indirect light are compared apart, over 32 seeds and within four standard errors (see
//! `common/kit.rs`); and a room without an emitter stays black whatever shines outside.

use photosphere::accel::Backend;
use photosphere::color::Rgb;
use photosphere::image_io::Picture;
use photosphere::scene::description::SurfaceModel;
use photosphere::scene::settings::PaperSettings;

use crate::kit::{Judged, Kit, MeanEstimate, diffuse, glass, mirror, phong, rendered};

/// What a ball is made of, and the radiance that it sends out.
type Look = (SurfaceModel, f32);
/// Centre, radius and look of a ball.
type Ball = ([f64; 3], f64, Look);

const GREY: Look = (diffuse(0.6), 0.0);
const LAMP: Look = (diffuse(0.3), 3.0);
const DIM: Look = (diffuse(0.0), 0.7);
const MIRROR_LAMP: Look = (mirror(0.5), 2.0);
const GLASS_LAMP: Look = (glass(1.5), 1.0);
const GLASS: Look = (glass(1.5), 0.0);
const WATER: Look = (
    SurfaceModel::Dielectric { ior: 1.33, roughness: 0.0, priority: -1, absorption: Rgb::ZERO },
    0.0,
);
const PHONG: Look = (phong([0.3, 0.5], 20.0, true), 0.0);
const CLASSIC_PHONG: Look = (phong([0.1, 0.2], 10.0, false), 0.0);

/// The setting of all of them; each adds its spheres.
fn scene(balls: &[Ball]) -> Kit {
    let mut kit = Kit::new(8, 8, 64).depth(5);
    kit.scene.camera([0.0, 1.0, 6.0], [0.0, 0.5, 0.0]).field_of_view(40.0).background([0.2; 3]);
    for &(center, radius, (surface, emission)) in balls {
        kit.glowing_ball(center, radius, surface, emission);
    }
    kit
}

/// Direct and indirect light of a scene, over seeds.
fn layers(kit: &Kit) -> [MeanEstimate; 2] {
    let pictures: Vec<Picture> = kit.pictures(Backend::BruteForce).collect();
    let mean = |layer: fn(&Picture) -> &Vec<Rgb>| {
        let of =
            |p: &Picture| layer(p).iter().map(|c| f64::from(c.y)).sum::<f64>() / p.len() as f64;
        MeanEstimate::from_values(&pictures.iter().map(of).collect::<Vec<_>>())
    };
    [mean(|p| &p.direct), mean(|p| &p.indirect)]
}

/// Compares the two ways for some balls that stand on or over the ground, beside another ball.
fn must_agree_on_the_ground(name: &str, balls: &[Ball]) {
    must_agree(name, &[&[GROUND, BALL][..], balls].concat());
}

fn must_agree(name: &str, balls: &[Ball]) {
    let path = layers(&scene(balls).samples(64));
    let paper = layers(&scene(balls).paper(PaperSettings::default()).samples(256));
    for (layer, (path, paper)) in ["direct", "indirect"].iter().zip(path.into_iter().zip(paper)) {
        path.must_agree(paper, &format!("{name}, {layer}"));
    }
}

const GROUND: Ball = ([0.0, -100.0, 0.0], 100.0, GREY);
const BALL: Ball = ([0.5, 0.5, 0.0], 0.5, GREY);
const LAMP_ABOVE: Ball = ([0.0, 3.0, 2.0], 1.0, LAMP);

#[test]
fn emitters_in_the_ground_in_glass_and_in_each_other() {
    must_agree_on_the_ground("lamp in the ground", &[([-1.0, 0.2, 0.0], 0.5, LAMP)]);
    let in_glass = [([-1.0, 0.8, 0.0], 0.8, GLASS), ([-1.0, 0.8, 0.0], 0.5, LAMP)];
    must_agree_on_the_ground("lamp in glass", &in_glass);
    let poking = [([-1.0, 0.8, 0.0], 0.6, GLASS), ([-0.6, 0.8, 0.0], 0.5, LAMP)];
    must_agree_on_the_ground("lamp poking out of glass", &poking);
    let nested = [([-1.0, 1.0, 0.0], 0.7, LAMP), ([-0.5, 1.0, 0.2], 0.6, DIM)];
    must_agree_on_the_ground("overlapping lamps", &nested);
}

#[test]
fn a_camera_among_and_inside_emitters() {
    must_agree_on_the_ground("inside a lamp", &[([0.0, 1.0, 3.0], 20.0, LAMP)]);
    let rooms =
        [([0.0, 1.0, 0.0], 9.0, DIM), ([-0.5, 1.0, 0.2], 0.6, LAMP), ([0.0, 1.0, 0.0], 10.0, LAMP)];
    must_agree_on_the_ground("a room of lamps", &rooms);
    let sizes = [
        ([-1.0, 0.7, 0.0], 0.6, LAMP),
        ([0.0, 3e4, 0.0], 1e4, DIM),
        ([1.2, 0.3, 0.5], 0.2, DIM),
        ([0.0, -2e6, 0.0], 1e6, DIM),
    ];
    must_agree_on_the_ground("lamps of many sizes", &sizes);
}

#[test]
fn glowing_mirrors_glowing_glass_and_both_phongs() {
    let mirror = [([-0.8, 0.7, 0.0], 0.6, MIRROR_LAMP), LAMP_ABOVE];
    must_agree_on_the_ground("glowing mirror", &mirror);
    let glass = [([-1.0, 1.0, 0.0], 0.7, GLASS_LAMP), ([-1.0, 1.0, 0.0], 0.3, GREY)];
    must_agree_on_the_ground("glowing glass", &glass);
    let phong = [([0.5, 0.5, 0.0], 0.5, PHONG), ([-0.7, 0.5, 0.0], 0.5, CLASSIC_PHONG), LAMP_ABOVE];
    must_agree("phong", &[&[GROUND][..], &phong].concat());
}

#[test]
fn boundaries_hidden_in_glass_let_light_through() {
    let hidden = [
        ([0.0, 0.5, 0.0], 2.0, GLASS),
        ([0.2, 0.5, 0.0], 1.2, WATER),
        ([0.0, 0.5, 0.0], 0.5, GREY),
        ([0.0, 1.9, 0.0], 0.4, LAMP),
    ];
    must_agree("a hidden boundary before a lamp", &hidden);
    let underwater = [
        ([0.0, 1.0, 0.0], 8.0, WATER),
        ([-0.5, 1.0, 1.0], 0.7, GLASS),
        ([0.0, 3.0, 0.0], 0.8, LAMP),
    ];
    must_agree_on_the_ground("a camera under water", &underwater);
}

#[test]
fn a_closed_room_stays_black_whatever_shines_outside() {
    // Rooms of diffuse walls, one of them far off the origin and one huge, with a ball poking
    // through the wall and one touching it from inside; two emitters outside. Not one path may see
    // them.
    for (x, r) in [(0.0, 1.0), (30.0, 1.0), (0.0, 1e5)] {
        let room = [
            ([x, 0.0, 0.0], r, GREY),
            ([x, 0.9 * r, 0.0], 0.2 * r, GREY),
            ([x + 0.6 * r, 0.0, 0.0], 0.4 * r, GREY),
            ([x, 3.0 * r, 0.0], r, LAMP),
            ([x, 0.0, 4.0 * r], r, LAMP),
            ([-0.1, 0.0, 0.0], 0.01, GREY),
            ([-0.2, 0.0, 0.0], 0.01, GREY),
            ([-0.3, 0.0, 0.0], 0.01, GREY),
        ];
        // The last three keep the origin away from the second room.
        let count = if x > 0.0 { room.len() } else { 5 };
        let mut kit = scene(&room[..count]).samples(16);
        kit.scene.camera([x + 0.3 * r, 0.0, 0.0], [x, 0.5 * r, 0.0]).field_of_view(80.0);
        (kit.settings.image.width, kit.settings.image.height) = (64, 64);
        let prepared = kit.prepared();
        for &backend in Backend::AVAILABLE {
            let picture = rendered(&prepared, backend).picture;
            let lit = (0..picture.len()).filter(|&i| picture.beauty(i).max_element() > 0.0).count();
            assert_eq!(lit, 0, "room of radius {r} at {x}, {}", backend.name());
        }
    }
}
