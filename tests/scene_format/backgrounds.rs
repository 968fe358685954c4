//! Backgrounds, their images and their mistakes.

use photosphere::color::Rgb;
use photosphere::image_io::ImageWriter;
use photosphere::image_io::Picture;
use photosphere::math::DVec3;
use photosphere::scene::description::EnvironmentDescription;
use photosphere::scene::{SceneFile, read_text};

use crate::scenes::{SCENE, load, set, told};

#[test]
fn backgrounds_are_read_with_their_defaults() {
    let background = |options: &[&str]| load(SCENE, options).expect("good").description.background;
    let gradient = background(&["background.gradient={zenith=[0,0,1],horizon=[1,1,1]}"]);
    let white = [1.0; 3].into();
    let dome = EnvironmentDescription::Gradient {
        zenith: [0.0, 0.0, 1.0].into(),
        horizon: white,
        nadir: white,
    };
    assert_eq!(gradient.dome, dome);

    let sun = "background.sun={elevation_degrees=30,azimuth_degrees=90,irradiance=[1,1,1]}";
    let sun = background(&[sun, "background.sky={}"]).sun.expect("a sun");
    assert!(sun.direction.distance(DVec3::new(0.75f64.sqrt(), 0.5, 0.0)) < 1e-12);
    assert_eq!(sun.angular_diameter_degrees, 0.533);
    let sun = "background.sun={elevation_degrees=90,irradiance=[1,1,1]}";
    let up = background(&[sun, "background.up=[0,0,2]"]).sun.expect("a sun").direction;
    assert!(up.distance(DVec3::Z) < 1e-12);

    let transparent = background(&["background.transparent=true"]);
    assert!(transparent.transparent && !transparent.camera_visible);
}

#[test]
fn mistakes_in_backgrounds_say_what_to_do() {
    let sun = "background.sun={direction=[0,1,0],irradiance=[1,1,1]}";
    for (options, expected) in [
        (
            &["background.radiance=[1,1,1]", "background.sky={}", sun][..],
            "`background` has both `radiance` and `sky`",
        ),
        (&["background.sky={}"], "`background.sky` needs `[background.sun]`"),
        (
            &["background.sky={}", "background.sun={direction=[0,-1,0],irradiance=[1,1,1]}"],
            "needs a sun above the horizon",
        ),
        (
            &["background.sky={turbidity=11}", sun],
            "`background.sky.turbidity` must be a number from 2 to 10, not 11",
        ),
        (
            &["background.sun={irradiance=[1,1,1]}"],
            "`background.sun` needs `direction`, or `elevation_degrees`",
        ),
        (&["background.sun={direction=[0,1,0]}"], "`background.sun.irradiance` is missing"),
        (
            &["background.sun={direction=[0,0,0],irradiance=[1,1,1]}"],
            "`background.sun.direction` must not be [0, 0, 0]",
        ),
        (
            &["background.sun={direction=[0,1,0],elevation_degrees=3,irradiance=[1,1,1]}"],
            "`background.sun` has both a direction and angles",
        ),
        (&["background.gradient={zenith=[1,1,1]}"], "`background.gradient.horizon` is missing"),
        (&["background.up=[0,0,0]"], "`background.up` must not be [0, 0, 0]"),
        (
            &["background.transparent=true", "background.camera_visible=true"],
            "`background.camera_visible` is true, but",
        ),
        (&["background.image={}"], "`background.image.file` is missing"),
        (&["background.image={file=\"none.exr\"}"], "none.exr` as background: No such file"),
        (&["background.image={file=\"example.toml\"}"], "does not end in .exr or .hdr"),
    ] {
        let told = told(SCENE, options);
        assert!(told.len() == 1 && told[0].contains(expected), "{told:?} is not {expected}");
    }
}

#[test]
fn images_that_are_no_background_say_why() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, width: usize, height: usize, pixel: f32| {
        let layer = vec![Rgb::splat(1.0); width * height];
        let mut picture =
            Picture { width, height, direct: layer.clone(), indirect: layer, ..Picture::default() };
        picture.direct[5] = Rgb::new(1.0, pixel, 1.0);
        ImageWriter::new(&folder.path().join(name)).unwrap().write(&picture).unwrap();
    };
    write("square.exr", 4, 4, 1.0);
    write("square.hdr", 4, 4, 1.0);
    write("negative.exr", 4, 2, -3.0);
    write("nan.exr", 4, 2, f32::NAN);
    write("good.exr", 4, 2, 3.0);
    write("good.hdr", 4, 2, 3.0);
    // A header that announces eight rows of half a billion pixels.
    let mut bytes = std::fs::read(folder.path().join("good.exr")).unwrap();
    let name = b"dataWindow\0box2i\0";
    let at = (0..bytes.len()).find(|&i| bytes[i..].starts_with(name)).unwrap() + name.len() + 4;
    bytes[at + 8..at + 12].copy_from_slice(&(1i32 << 29).to_le_bytes());
    bytes[at + 12..at + 16].copy_from_slice(&7i32.to_le_bytes());
    std::fs::write(folder.path().join("bomb.exr"), bytes).unwrap();
    std::fs::write(folder.path().join("empty.exr"), "").unwrap();
    std::fs::write(folder.path().join("text.hdr"), "no picture").unwrap();
    let load = |name: &str| {
        let image = set(&format!("background.image={{file=\"{name}\"}}"));
        read_text("test.toml", SCENE, folder.path(), &[image]).and_then(SceneFile::build)
    };
    for (name, expected) in [
        ("square.exr", "it has 4 x 4 pixels, but"),
        ("square.hdr", "it has 4 x 4 pixels, but"),
        (
            "negative.exr",
            "1 of its pixels are negative, infinite or not a number, first the one in column 1, row 1, which is [2, -2, 2]",
        ),
        ("nan.exr", "which is [2, NaN, 2]"),
        ("bomb.exr", "it is shorter than its header says: 536870913 x 8 pixels"),
        ("empty.exr", "as background: "),
        ("text.hdr", "as background: "),
    ] {
        let told = load(name).expect_err("a mistake").diagnostics()[0].to_string();
        assert!(told.contains(expected), "{told} is not {expected}");
    }
    for name in ["good.exr", "good.hdr"] {
        let (scene, _) = load(name).expect("a good image");
        // Pixel (1, 1) is seen in the middle of its quarter. The lower of two rows is at the nadir.
        let seen = scene.background_radiance(DVec3::new(-1e-9, -1.0, -1e-9));
        assert!((seen - Rgb::new(2.0, 4.0, 2.0)).length() < 0.04, "{name}: {seen}");
    }
}
