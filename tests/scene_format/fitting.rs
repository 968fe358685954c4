//! Cameras that are fitted to what a scene shows, and lenses that focus on what was named.

use photosphere::math::DVec3;
use photosphere::scene::description::{CameraDescription, ProjectionDescription};
use photosphere::scene::{PreparedScene, Scene, Settings};

use crate::scenes::load;

/// Two balls on a ground under a lamp, and two rows of a table.
const BALLS: &str = r#"format = 1
[image]
width = 60
height = 40
[camera]
fit = true
[materials.grey]
type = "diffuse"
albedo = [0.5, 0.5, 0.5]
[materials.lamp]
type = "diffuse"
albedo = [0, 0, 0]
emission = [9, 9, 9]
[[spheres]]
name = "ground"
center = [0, -200, 0]
radius = 200
material = "grey"
[[spheres]]
name = "lamp"
center = [3, 30, 1]
radius = 1
material = "lamp"
[[spheres]]
name = "ball"
center = [1, 1, 0.5]
radius = 1
material = "grey"
[[spheres]]
center = [0, 0.2, 3]
radius = 0.2
material = "grey"
[[sphere_tables]]
file = "grains.f32"
columns = ["x", "y", "z", "radius", "r", "g", "b"]
material = "grey"
"#;

const TYPES: [&[&str]; 4] = [
    &[],
    &["camera.type=orthographic"],
    &["camera.type=panoramic"],
    &[
        "camera.type=panoramic",
        "camera.horizontal_extent_degrees=40",
        "camera.vertical_extent_degrees=30",
    ],
];

fn built(text: &str, options: &[&str]) -> (Scene, Settings) {
    load(text, options).and_then(photosphere::scene::SceneFile::build).expect("a good scene")
}

fn camera(text: &str, options: &[&str]) -> CameraDescription {
    let (scene, settings) = built(text, options);
    scene.camera(&settings.image).expect("a camera")
}

/// What building a scene says.
fn told(text: &str, options: &[&str]) -> String {
    match load(text, options).and_then(photosphere::scene::SceneFile::build) {
        Ok(_) => "nothing".to_owned(),
        Err(error) => {
            assert!(error.diagnostics().iter().all(|told| told.location.is_some()), "{error}");
            error.to_string()
        }
    }
}

/// The ids of the spheres that some ray of a grid over the picture hits, each by itself.
fn seen(scene: &Scene, settings: &Settings, margin: f64) -> Vec<u32> {
    let prepared = PreparedScene::new(scene, *settings).expect("a good scene");
    let [width, height] = [settings.image.width, settings.image.height].map(f64::from);
    let steps = 400;
    let is_hit = |id: &u32| {
        let sphere = scene.spheres().sphere(*id);
        (0..steps * steps).any(|index| {
            let at = |i: i32| (f64::from(i) + 0.5) / f64::from(steps);
            let within = |share: f64| margin + (1.0 - 2.0 * margin) * share;
            let (x, y) = (within(at(index % steps)), within(at(index / steps)));
            let ray = prepared.camera().generate_ray(width * x, height * y, [0.5; 2]);
            sphere.first_root(ray.origin, ray.direction, 0.0, f64::INFINITY).is_some()
        })
    };
    (0..scene.spheres().len() as u32).filter(is_hit).collect()
}

#[test]
fn every_kind_of_camera_sees_all_but_the_ground_and_the_lamp() {
    for options in TYPES {
        let (scene, settings) = built(BALLS, options);
        let fitted = scene.camera(&settings.image).expect("a camera");
        assert_eq!(fitted.fit, None);
        let [low, high] = scene.subject_bounds();
        let grains = [[1.0, 2.0, 3.0, 0.5], [-1.0, 0.0, 1.0, 0.25]];
        let balls = [[1.0, 1.0, 0.5, 1.0], [0.0, 0.2, 3.0, 0.2]];
        let of = |pick: fn(f64, f64) -> f64, sign: f64| {
            let ends =
                grains.iter().chain(&balls).map(|[x, y, z, r]| DVec3::new(*x, *y, *z) + sign * *r);
            ends.reduce(|a, b| DVec3::new(pick(a.x, b.x), pick(a.y, b.y), pick(a.z, b.z)))
        };
        assert!(low.distance(of(f64::min, -1.0).expect("balls")) < 1e-6, "{low}");
        assert!(high.distance(of(f64::max, 1.0).expect("balls")) < 1e-6, "{high}");
        let lamp =
            scene.spheres().rows().iter().position(|row| *row == 1).expect("the lamp") as u32;
        let seen = seen(&scene, &settings, 0.04);
        assert!(!seen.contains(&lamp), "{options:?}: the lamp is far above");
        assert_eq!(seen.len(), scene.spheres().len() - 1, "{options:?}: {seen:?}");
    }
}

#[test]
fn shadow_catchers_are_not_what_is_shown() {
    let caught = BALLS.replace("name = \"ball\"", "name = \"ball\"\nshadow_catcher = true");
    let [_, high] = built(&caught, &[]).0.subject_bounds();
    let [_, all] = built(BALLS, &[]).0.subject_bounds();
    assert!((all.x, high.x) == (2.0, 1.5), "{high} of {all}");
}

#[test]
fn a_fitted_camera_is_the_one_that_it_prints() {
    for options in TYPES {
        let (scene, settings) = built(BALLS, options);
        let mut fixed = scene.description().clone();
        fixed.camera = scene.camera(&settings.image).expect("a camera");
        let keys = fixed.to_keys()["camera"].to_string();
        let fixed: Vec<String> = serde_json::from_str::<serde_json::Map<_, _>>(&keys)
            .expect("keys")
            .into_iter()
            .map(|(key, value)| format!("camera.{key}={value}"))
            .collect();
        let fixed: Vec<&str> = fixed.iter().map(String::as_str).collect();
        let text = BALLS.replace("fit = true\n", "");
        assert_eq!(Some(camera(&text, &fixed)), scene.camera(&settings.image).ok());
    }
}

#[test]
fn the_direction_may_be_that_of_what_is_up() {
    for (direction, towards) in
        [("y", DVec3::Y), ("[0, -3, 0]", DVec3::NEG_Y), ("-x", DVec3::NEG_X)]
    {
        let CameraDescription { position, look_at, up, .. } =
            camera(BALLS, &[&format!("camera.direction={direction}")]);
        assert!((position - look_at).normalize().dot(towards) > 1.0 - 1e-9, "{direction}");
        assert!(up.cross(towards).length() > 0.5, "{direction}");
    }
}

#[test]
fn a_picture_of_another_shape_has_another_camera() {
    let (scene, mut settings) = built(BALLS, &[]);
    let wide = scene.camera(&settings.image).expect("a camera");
    (settings.image.width, settings.image.height) = (40, 60);
    let narrow = scene.camera(&settings.image).expect("a camera");
    assert_ne!(wide, narrow);
    assert_ne!(scene.content_hash(), built(BALLS, &["camera.margin=0.1"]).0.content_hash());
    assert_eq!(scene.content_hash(), built(BALLS, &["camera.up=[0, 7, 0]"]).0.content_hash());
}

/// The focus distance of a lens.
fn focus(options: &[&str]) -> f64 {
    let text = BALLS
        .replace("fit = true", "position = [0, 1, 9]\nlook_at = [0, 1, 0]\naperture_radius = 0.1");
    let ProjectionDescription::Perspective { lens: Some(lens), .. } =
        camera(&text, options).projection
    else {
        panic!("no lens");
    };
    lens.focus_distance
}

#[test]
fn a_lens_focuses_on_rows_and_on_pixels() {
    assert_eq!(focus(&[]), 9.0);
    // The ball at z = 0.5 with radius 1, and the row at (1, 2, 3) with radius 0.5.
    let depth = |center: DVec3, radius: f64| {
        let to = center - DVec3::new(0.0, 1.0, 9.0);
        -to.z * (1.0 - radius / to.length())
    };
    let ball = focus(&["camera.focus_on=ball"]);
    assert!((ball - depth(DVec3::new(1.0, 1.0, 0.5), 1.0)).abs() < 1e-12);
    let row = focus(&["camera.focus_on=\"grains.f32:0\""]);
    assert!((row - depth(DVec3::new(1.0, 2.0, 3.0), 0.5)).abs() < 1e-6);
    // In the middle of the picture, the ground is behind the small balls.
    let pixel = focus(&["camera.focus_on_pixel=[33, 20]"]);
    assert!((7.0..9.0).contains(&pixel), "{pixel}");
    let fitted = |options: &[&str]| {
        let options: Vec<_> = [&["camera.aperture_radius=0.1"][..], options].concat();
        let camera = camera(BALLS, &options);
        (camera.lens().expect("a lens").focus_distance, camera.position.distance(camera.look_at))
    };
    let (usual, distance) = fitted(&[]);
    assert_eq!(usual, distance);
    assert!(fitted(&["camera.focus_on=ball"]).0 < distance);
}

#[test]
fn what_cannot_be_focused_on_is_told_with_its_place() {
    let lens = "camera.aperture_radius=0.1";
    let cases = [
        (
            "camera.focus_on=\"grains.f32:7\"",
            "`camera.focus_on` names the row 7, which `grains.f32` does not have",
        ),
        (
            "camera.focus_on=\"grain.f32:1\"",
            "`camera.focus_on` must be the name of a sphere, not \"grain.f32:1\"",
        ),
        (
            "camera.focus_on_pixel=[60, 0]",
            "`camera.focus_on_pixel` is [60, 0], but the picture has 60 x 40 pixels",
        ),
        (
            "camera.focus_on_pixel=[0, 0]",
            "`camera.focus_on_pixel`: there is no sphere in the pixel [0, 0]",
        ),
    ];
    for (option, message) in cases {
        let direction = "camera.direction=\"10,5\"";
        let found = told(BALLS, &[lens, direction, option]);
        assert!(found.ends_with(message) && found != message, "{option}: {found}");
    }
}
