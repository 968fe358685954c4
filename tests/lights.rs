//! Lights against closed forms.
//!
//! Means are over 32 independent seeds and may be off by four standard errors (see
//! `common/render.rs` for the significance of that) and 1e-5 relative.

#[path = "common/render.rs"]
mod common;

use std::f64::consts::PI;

use common::{Estimate, Rendered, SEEDS, outcome, picture, scene};
use photosphere::accel::Backend;
use photosphere::color::Rgb;
use photosphere::film::Picture;
use photosphere::output::Target;

/// One point of a matt plane, looked at from above. The plane is a giant.
const POINT: &str = r#"
format = 1
[image]
width = 1
height = 1
[camera]
position = [0.0, 1.0, 0.0]
look_at = [0.0, 0.0, 0.0]
up = [1.0, 0.0, 0.0]
vertical_fov_degrees = 0.001
[materials.matt]
type = "diffuse"
albedo = [0.5, 0.5, 0.5]
[[spheres]]
center = [0.0, -1e7, 0.0]
radius = 1e7
material = "matt"
[render]
samples_per_pixel = 256
max_depth = 2
"#;

/// Lamps in all directions above the plane, none before another, at many distances and of several
/// powers; and the radiance that they make at the point: `albedo L sin^2 cos` each.
fn lamps(count: u32) -> (String, f64) {
    let mut text = String::new();
    for power in 1..=3 {
        text += &format!(
            "[materials.lamp{power}]\ntype = \"diffuse\"\nalbedo = [0, 0, 0]\n\
             emission = [{power}, {power}, {power}]\n"
        );
    }
    let mut sum = 0.0;
    for i in 0..count {
        // A spiral over the hemisphere, whose turns are further apart than the lamps are wide.
        let cos = 1.0 - (f64::from(i) + 0.5) / f64::from(count) * 0.95;
        let azimuth = f64::from(i) * 2.399_963_229_728_653;
        let sin = (1.0 - cos * cos).sqrt();
        let distance = 2.0 + f64::from(i * 7919 % 101);
        let sin_rim = 0.5 / f64::from(count).sqrt();
        let power = 1 + i % 3;
        let center = [sin * azimuth.cos(), cos, sin * azimuth.sin()].map(|x| distance * x);
        text += &format!(
            "[[spheres]]\ncenter = {center:?}\nradius = {}\nmaterial = \"lamp{power}\"\n",
            distance * sin_rim
        );
        sum += 0.5 * f64::from(power) * sin_rim * sin_rim * cos;
    }
    (text, sum)
}

#[test]
fn many_lamps_shine_like_their_sum_however_they_are_chosen() {
    for count in [5, 100, 3000] {
        let (lamps, sum) = lamps(count);
        let text = format!("{POINT}{lamps}");
        for choice in ["hierarchy", "power", "uniform"] {
            let choice = format!("render.light_choice={choice}");
            Estimate::of_scene(&text, &[&choice], Backend::Native)
                .must_be(sum, &format!("{count} lamps, {choice}"));
        }
    }
}

/// The ways to estimate that solve the whole equation; light by chance needs large lights.
const INTEGRATORS: [&str; 2] = ["render.integrator=path", "render.integrator=paper"];

#[test]
fn a_sun_shines_on_a_plane_like_the_cosine_of_its_height() {
    // A disc above the horizon brings its irradiance times the cosine of its middle.
    for (elevation, diameter) in [(90.0, 0.5), (30.0, 0.5), (20.0, 0.002), (45.0, 80.0)] {
        let sun = format!(
            "background.sun={{elevation_degrees={elevation},azimuth_degrees=77,\
             angular_diameter_degrees={diameter},irradiance=[3,3,3]}}"
        );
        let expected = 0.5 / PI * 3.0 * f64::to_radians(elevation).sin();
        for integrator in &INTEGRATORS[..1 + usize::from(diameter > 10.0)] {
            Estimate::of_scene(POINT, &[&sun, integrator], Backend::BruteForce)
                .must_be(expected, &format!("{sun}, {integrator}"));
        }
    }
}

#[test]
fn skies_shine_on_a_plane_like_their_integrals() {
    let gradient = "background.gradient={zenith=[5,5,5],horizon=[1,1,1],nadir=[70,70,70]}";
    for (sky, expected) in [
        // albedo L
        ("background.radiance=[4,4,4]", 0.5 * 4.0),
        // albedo times twice the integral of (1 + 4 h) h over the height h
        (gradient, 0.5 * (1.0 + 2.0 * 4.0 / 3.0)),
    ] {
        for integrator in INTEGRATORS {
            Estimate::of_scene(POINT, &[sky, integrator], Backend::BruteForce)
                .must_be(expected, &format!("{sky}, {integrator}"));
        }
    }
}

/// An image whose rows differ and whose columns differ, with a pixel that outshines all others. Its
/// light is linear in the height between the rows' means, whatever the columns are.
#[test]
fn an_image_shines_on_a_plane_like_its_interpolation() {
    let folder = tempfile::tempdir().expect("a folder");
    let (width, height) = (16, 8);
    let pixel = |i: usize| match i {
        37 => 500.0,
        _ => ((i * 29) % 17) as f32,
    };
    let pixels: Vec<f32> = (0..width * height).map(pixel).collect();
    let direct = pixels.iter().map(|&value| Rgb::splat(value)).collect();
    let indirect = vec![Rgb::ZERO; width * height];
    let picture = Picture { width, height, direct, indirect, ..Picture::default() };
    let file = folder.path().join("image.exr");
    Target::new(&file).expect("a place").write(&picture).expect("room");

    let row_mean = |row: usize| {
        let row = &pixels[width * row..width * (row + 1)];
        row.iter().map(|&value| f64::from(value)).sum::<f64>() / width as f64
    };
    // Heights and means from the zenith down to the horizon, half-way between rows 3 and 4.
    let angle = |row: usize| (row as f64 + 0.5) / height as f64 * PI;
    let mut nodes = vec![(1.0, row_mean(0))];
    nodes.extend((0..height / 2).map(|row| (angle(row).cos(), row_mean(row))));
    nodes.push((0.0, 0.5 * (row_mean(3) + row_mean(4))));
    let band = |pair: &[(f64, f64)]| {
        // Simpson's rule is exact for the parabola that linear radiance times height is.
        let [(a, at_a), (b, at_b)] = [pair[0], pair[1]];
        (a - b) / 6.0 * (a * at_a + (a + b) * (at_a + at_b) + b * at_b)
    };
    let expected = 0.5 * 2.0 * nodes.windows(2).map(band).sum::<f64>();

    for rotation in [0, 200] {
        let image = format!(
            "background.image={{file={:?},rotation_degrees={rotation}}}",
            file.display().to_string()
        );
        for integrator in INTEGRATORS {
            Estimate::of_scene(POINT, &[&image, integrator], Backend::BruteForce)
                .must_be(expected, &format!("image, {rotation} degrees, {integrator}"));
        }
    }
}

/// Everything at once: what each brings adds up, however the choice among them falls.
#[test]
fn lamps_sky_and_sun_add_up() {
    let (lamps, sum) = lamps(40);
    let text = format!("{POINT}{lamps}");
    let sun = "background.sun={elevation_degrees=50,irradiance=[0.2,0.2,0.2]}";
    let gradient = "background.gradient={zenith=[0.3,0.3,0.3],horizon=[0,0,0]}";
    // The lamps cover some of the sky, and one may cover the sun.
    let with = |more: &[&str], seed: &str| {
        let overrides = [more, &[seed]].concat();
        outcome(&scene(&text, &overrides), Backend::BruteForce).picture.mean().y
    };
    let estimate = |more: &[&str]| {
        let seeds = 0..SEEDS;
        Estimate::of(&seeds.map(|s| with(more, &format!("render.seed={s}"))).collect::<Vec<_>>())
    };
    let dark = ["materials.lamp1", "materials.lamp2", "materials.lamp3"]
        .map(|lamp| format!("{lamp}.emission=[0,0,0]"));
    let dark: Vec<&str> = dark.iter().map(|set| &**set).collect();
    let by_sky = estimate(&[&dark[..], &[sun, gradient]].concat());
    let all = estimate(&[sun, gradient]);
    let alone = Estimate { mean: all.mean - by_sky.mean, ..all };
    alone.must_agree(Estimate { mean: sum, ..by_sky }, "lamps beside sky and sun");
}

/// A matt, a glass and a mirror ball before a background that the camera does not see.
const BALLS: &str = r#"
format = 1
[image]
width = 60
height = 20
[camera]
position = [0.0, 0.0, 20.0]
look_at = [0.0, 0.0, 0.0]
vertical_fov_degrees = 10.0
[background]
radiance = [1.0, 1.0, 1.0]
[materials.matt]
type = "diffuse"
albedo = [0.5, 0.5, 0.5]
[materials.glass]
type = "dielectric"
ior = 1.5
[materials.mirror]
type = "mirror"
reflectance = [1.0, 1.0, 1.0]
[[spheres]]
center = [-3.0, 0.0, 0.0]
radius = 1.0
material = "matt"
[[spheres]]
center = [0.0, 0.0, 0.0]
radius = 1.0
material = "glass"
[[spheres]]
center = [3.0, 0.0, 0.0]
radius = 1.0
material = "mirror"
[render]
samples_per_pixel = 64
"#;

#[test]
fn a_hidden_background_shines_but_is_not_seen_by_the_camera() {
    for integrator in ["path", "paper"] {
        let integrator = format!("render.integrator={integrator}");
        let hidden = picture(BALLS, &[&integrator, "background.camera_visible=false"]);
        let transparent = picture(BALLS, &[&integrator, "background.transparent=true"]);
        assert!(hidden.alpha.is_none());
        assert_eq!(hidden.direct, transparent.direct);
        let alpha = transparent.alpha.as_ref().expect("asked for");
        assert_eq!((transparent.beauty(0), alpha[0]), (Rgb::ZERO, 0.0));
        // Glass and mirror balls show the background, so they are as opaque as the matt one.
        for (x, least) in [(12, 0.45), (30, 0.95), (47, 0.95)] {
            let pixel = 10 * 60 + x;
            assert_eq!(alpha[pixel], 1.0);
            assert!(transparent.beauty(pixel).y >= least, "{}", transparent.beauty(pixel));
        }
        // On a silhouette, what is covered is as bright as what is inside.
        let edges = (0..alpha.len()).filter(|&i| alpha[i] > 0.2 && alpha[i] < 0.8 && i % 60 > 36);
        let bright = edges.map(|i| transparent.beauty(i).y - alpha[i]);
        assert!(bright.clone().count() > 5 && bright.clone().all(|off| off.abs() < 1e-5));
    }
}
