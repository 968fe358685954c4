//! What cameras must show whatever they look at, and crops.

#[path = "common/render.rs"]
mod common;

use common::{picture, scene};
use photosphere::color::Rgb;
use photosphere::scene::description::Projection;

/// Every camera, as options.
const CAMERAS: [&[&str]; 6] = [
    &["camera.vertical_fov_degrees=50"],
    &["camera.aperture_radius=0.3", "camera.focus_distance=2"],
    &["camera.aperture_radius=0.3", "camera.blades=5", "camera.rotation_degrees=20"],
    &["camera.type=orthographic", "camera.height=2"],
    &["camera.type=panoramic"],
    &[
        "camera.type=panoramic",
        "camera.horizontal_extent_degrees=90",
        "camera.vertical_extent_degrees=100",
    ],
];

fn with<'a>(some: &[&'a str], more: &[&'a str]) -> Vec<&'a str> {
    some.iter().chain(more).copied().collect()
}

/// Inside of a black ball that glows.
const GLOW: &str = r#"
format = 1
[image]
width = 5
height = 4
[camera]
position = [1.0, 2.0, 3.0]
look_at = [0.0, 1.0, 0.0]
[materials.wall]
type = "diffuse"
albedo = [0, 0, 0]
emission = [0.75, 0.5, 0.25]
[materials.glass]
type = "dielectric"
ior = 1.5
[[spheres]]
name = "wall"
center = [0, 0, 0]
radius = 1000
material = "wall"
[render]
samples_per_pixel = 16
"#;

#[test]
fn every_camera_filter_and_sampler_shows_a_constant_as_it_is() {
    for camera in CAMERAS {
        for filter in ["box", "tent", "gaussian", "blackman-harris"] {
            for sampler in ["sobol", "independent", "stratified"] {
                let filter = format!("image.filter={filter}");
                let sampler = format!("render.sampler={sampler}");
                let options = with(camera, &[&filter, &sampler]);
                let shown = picture(GLOW, &options);
                let constant = Rgb::new(0.75, 0.5, 0.25);
                assert!(shown.direct.iter().all(|&light| light == constant), "{options:?}");
            }
        }
    }
}

#[test]
fn every_camera_knows_the_glass_that_its_rays_start_in() {
    // Around the middle of a ball of glass no ray is trapped: light has n^2 times its radiance
    // there.
    let inside =
        format!("{GLOW}\n[[spheres]]\ncenter = [1, 2, 3]\nradius = 9\nmaterial = \"glass\"\n");
    for camera in CAMERAS {
        let shown = picture(&inside, &with(camera, &["image.filter=tent"]));
        for pixel in 0..shown.len() {
            let green = shown.beauty(pixel).y;
            assert!((green - 0.5 * 2.25).abs() < 1e-5, "{camera:?}: {green}");
        }
    }
    // A plane of parallel rays that reaches out of the glass on both sides: the rays of the middle
    // pixel start within it, near enough to its middle that none is trapped.
    let row = ["image.width=9", "image.height=1", "camera.type=orthographic", "camera.height=8"];
    let shown = picture(&inside, &row);
    for (pixel, expected) in [(0, 0.5), (4, 0.5 * 2.25), (8, 0.5)] {
        assert!((shown.beauty(pixel).y - expected).abs() < 1e-5, "{pixel}");
    }
}

#[test]
fn a_closed_lens_is_the_pinhole_bit_by_bit() {
    let text = common::scene_file("paper/fig4.toml");
    let small = ["image.width=24", "image.height=18", "render.samples_per_pixel=4"];
    let pinhole = picture(&text, &small);
    let closed = ["camera.aperture_radius=0", "camera.blades=6", "camera.focus_distance=3"];
    assert_eq!(picture(&text, &with(&small, &closed)), pinhole);
    // Almost closed, nearly all pixels are nearly the same.
    let normals = with(&small, &["render.integrator=normals"]);
    let sharp = picture(&text, &normals);
    let almost = with(&normals, &["camera.aperture_radius=1e-9", "camera.focus_distance=3"]);
    let almost = picture(&text, &almost);
    let differ = |i: &usize| (sharp.direct[*i] - almost.direct[*i]).abs().max_element() > 1e-5;
    assert_eq!((0..sharp.len()).filter(differ).count(), 0);
}

/// A wall of two halves, seen from 5 away: two balls so large that they are flat, one glowing. Their
/// surfaces cross where x = 0, between the fourth and the fifth of eight columns.
const WALL: &str = r#"
format = 1
[image]
width = 8
height = 6
[camera]
position = [0, 0, 5]
look_at = [0, 0, 0]
vertical_fov_degrees = 20
aperture_radius = 0.4
[materials.dark]
type = "diffuse"
albedo = [0, 0, 0]
[materials.bright]
type = "diffuse"
albedo = [0, 0, 0]
emission = [1, 1, 1]
[[spheres]]
name = "dark half"
center = [-1, 0, -1e6]
radius = 1e6
material = "dark"
[[spheres]]
name = "bright half"
center = [1, 0, -1e6]
radius = 1e6
material = "bright"
[render]
samples_per_pixel = 64
"#;

#[test]
fn a_plane_in_focus_does_not_depend_on_the_aperture() {
    let pinhole = picture(WALL, &["camera.aperture_radius=0"]);
    for pixel in 0..pinhole.len() {
        let expected = if pixel % 8 < 4 { 0.0 } else { 1.0 };
        assert_eq!(pinhole.beauty(pixel).x, expected);
    }
    // The lens is focused on the wall: on `look_at`, by distance, or by the name of a sphere.
    for focus in ["camera.near=0", "camera.focus_distance=5", "camera.focus_on=dark half"] {
        for blades in ["camera.blades=0", "camera.blades=7"] {
            assert_eq!(picture(WALL, &[focus, blades]), pinhole, "{focus}, {blades}");
        }
    }
    let blurred = picture(WALL, &["camera.focus_distance=3"]);
    let grey = |pixel: &usize| blurred.beauty(*pixel).x > 0.0 && blurred.beauty(*pixel).x < 1.0;
    assert!((0..blurred.len()).filter(grey).count() > 9, "both columns at the edge");
    assert!((blurred.mean().x - 0.5).abs() < 0.05);
}

#[test]
fn parallel_rays_are_those_of_a_camera_far_away() {
    let text = common::scene_file("paper/fig4.toml");
    // Another camera has no use for the angle of the scene's.
    let text: Vec<&str> = text.lines().filter(|line| !line.starts_with("vertical_fov")).collect();
    let text = text.join("\n");
    let look = ["camera.look_at=[0,1,0]", "render.integrator=normals"];
    let look = with(&look, &["image.width=40", "image.height=30"]);
    let parallel = ["camera.type=orthographic", "camera.height=4", "camera.position=[0,1,1e6]"];
    let parallel = picture(&text, &with(&look, &parallel));
    let fov = format!("camera.vertical_fov_degrees={:e}", 2.0 * (2e-6f64).atan().to_degrees());
    let far = picture(&text, &with(&look, &["camera.position=[0,1,1e6]", &fov]));
    let differ =
        |pixel: &usize| (parallel.direct[*pixel] - far.direct[*pixel]).abs().max_element() > 1e-4;
    let different = (0..far.len()).filter(differ).count();
    assert!(different == 0, "{different} of {}", far.len());
    assert!(far.direct.iter().any(|&color| color != far.direct[0]));
}

#[test]
fn a_crop_has_the_bits_of_the_whole_picture() {
    let text = common::scene_file("paper/fig4.toml");
    let small = ["image.width=37", "image.height=23", "image.filter=gaussian"];
    for integrator in ["path", "direct", "paper", "ambient-occlusion", "normals", "raycast"] {
        let integrator = format!("render.integrator={integrator}");
        let samples = "render.samples_per_pixel=20";
        let lens = ["camera.aperture_radius=0.1", &integrator, samples];
        let options = with(&small, &lens);
        let whole = picture(&text, &options);
        for (crop, [x0, y0, x1, y1]) in [
            ("image.crop=[0, 0, 37, 23]", [0, 0, 37, 23]),
            ("image.crop=[5, 7, 30, 8]", [5, 7, 30, 8]),
            ("image.crop=[36, 22, 37, 23]", [36, 22, 37, 23]),
            ("image.crop=[11, 2, 19, 21]", [11, 2, 19, 21]),
        ] {
            let part = picture(&text, &with(&options, &[crop]));
            assert_eq!((part.width, part.height), (x1 - x0, y1 - y0));
            for y in y0..y1 {
                let row = (y - y0) * part.width..(y - y0 + 1) * part.width;
                let same = y * 37 + x0..y * 37 + x1;
                assert_eq!(part.direct[row.clone()], whole.direct[same.clone()], "{crop}");
                assert_eq!(part.indirect[row], whole.indirect[same], "{crop}");
            }
        }
    }
}

#[test]
fn focus_on_finds_the_point_of_a_sphere_that_is_nearest() {
    let focus = |overrides: &[&str]| match scene(WALL, overrides).description().camera.projection {
        Projection::Perspective { lens: Some(lens), .. } => lens.focus_distance,
        other => panic!("{other:?}"),
    };
    assert_eq!(focus(&[]), 5.0);
    assert_eq!(focus(&["camera.focus_distance=7"]), 7.0);
    let aside = ["camera.focus_on=dark half", "spheres.0.center=[4, 0, 2]", "spheres.0.radius=1"];
    // The centre is 5 away at a cosine of 3/5; the nearest point 4.
    assert!((focus(&aside) - 4.0 * 0.6).abs() < 1e-12);
}
