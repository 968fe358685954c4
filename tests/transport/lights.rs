//! Lights against closed forms.
//!
//! Means are over 32 independent seeds and may be off by four standard errors (see `common/kit.rs`
//! for the significance of that) and 1e-5 relative.

use std::f64::consts::PI;

use photosphere::accel::Backend;
use photosphere::color::Rgb;
use photosphere::image_io::ImageWriter;
use photosphere::image_io::Picture;
use photosphere::light::Orientation;
use photosphere::math::DVec3;
use photosphere::scene::description::{
    BackgroundDescription, EnvironmentDescription, SunDescription,
};
use photosphere::scene::settings::LightSamplerKind;

use crate::kit::{Judged, Kit, MeanEstimate, diffuse, glass, mirror};

/// One point of a diffuse plane, looked at from above. The plane is a giant.
fn point() -> Kit {
    let mut kit = Kit::new(1, 1, 256).depth(2);
    kit.scene.camera([0.0, 1.0, 0.0], [0.0; 3]).field_of_view(0.001);
    kit.scene.description.camera.up = DVec3::X;
    kit.ball([0.0, -1e7, 0.0], 1e7, diffuse(0.5));
    kit
}

/// The point under a dome.
fn under(dome: EnvironmentDescription) -> Kit {
    point().with(|kit| kit.scene.description.background.dome = dome)
}

/// Emitters in all directions above the plane, none before another, at many distances and of
/// several powers, none cut by the horizon; and the radiance that they make at the point: `albedo L
/// sin^2 cos` each.
fn emitters(count: u32) -> (Kit, f64) {
    let mut kit = point();
    let powers = [1.0, 2.0, 3.0].map(|power| kit.scene.emitter([power; 3]));
    let mut sum = 0.0;
    for i in 0..count {
        // A spiral over the hemisphere, whose turns are further apart than the emitters are wide.
        let cos = 1.0 - (f64::from(i) + 0.5) / f64::from(count) * 0.85;
        let azimuth = f64::from(i) * 2.399_963_229_728_653;
        let sin = (1.0 - cos * cos).sqrt();
        let distance = 2.0 + f64::from(i * 7919 % 101);
        let sin_rim = 0.5 / f64::from(count).sqrt();
        let center = [sin * azimuth.cos(), cos, sin * azimuth.sin()].map(|x| distance * x);
        kit.scene.sphere(powers[i as usize % 3], center, distance * sin_rim);
        sum += 0.5 * f64::from(1 + i % 3) * sin_rim * sin_rim * cos;
    }
    (kit, sum)
}

#[test]
fn many_emitters_shine_like_their_sum_however_they_are_chosen() {
    for count in [5, 100, 3000] {
        let (mut kit, sum) = emitters(count);
        for choice in
            [LightSamplerKind::Hierarchy, LightSamplerKind::Power, LightSamplerKind::Uniform]
        {
            kit.settings.render.light_choice = choice;
            let what = format!("{count} lamps, {choice:?}");
            kit.estimate(Backend::Native).must_be(sum, &what);
        }
    }
}

/// A sun at an elevation and an azimuth in degrees, so many of them wide.
fn sun(
    elevation: f64,
    azimuth: f64,
    angular_diameter_degrees: f64,
    irradiance: f32,
) -> SunDescription {
    let sky = Orientation::new(DVec3::Y, 0.0);
    SunDescription {
        direction: sky.direction(elevation.to_radians(), azimuth.to_radians()),
        angular_diameter_degrees,
        irradiance: Rgb::splat(irradiance),
    }
}

#[test]
fn a_sun_shines_on_a_plane_like_the_cosine_of_its_height() {
    // A disc above the horizon brings its irradiance times the cosine of its middle.
    for (elevation, diameter) in [(90.0, 0.5), (30.0, 0.5), (20.0, 0.002), (45.0, 80.0)] {
        let mut kit = point();
        kit.scene.description.background.sun = Some(sun(elevation, 77.0, diameter, 3.0));
        let expected = 0.5 / PI * 3.0 * f64::to_radians(elevation).sin();
        // Light by chance needs large lights.
        for kit in kit.both_ways().iter().take(1 + usize::from(diameter > 10.0)) {
            let what = format!("{diameter} degrees wide, {elevation} high, {}", kit.how());
            kit.mean().must_be(expected, &what);
        }
    }
}

#[test]
fn skies_shine_on_a_plane_like_their_integrals() {
    let gradient = EnvironmentDescription::Gradient {
        zenith: Rgb::splat(5.0),
        horizon: Rgb::splat(1.0),
        nadir: Rgb::splat(70.0),
    };
    for (sky, expected) in [
        // albedo L
        (EnvironmentDescription::Constant { radiance: Rgb::splat(4.0) }, 0.5 * 4.0),
        // albedo times twice the integral of (1 + 4 h) h over the height h
        (gradient, 0.5 * (1.0 + 2.0 * 4.0 / 3.0)),
    ] {
        for kit in under(sky).both_ways() {
            let what = format!("{:?}, {}", kit.scene.description.background.dome, kit.how());
            kit.mean().must_be(expected, &what);
        }
    }
}

/// An image whose rows differ and whose columns differ, with a pixel that outshines all others. Its
/// light is linear in the height between the rows' means, whatever the columns are. The rows' nodes
/// lie where each holds the light of its area.
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
    ImageWriter::new(&file).expect("a place").write(&picture).expect("room");

    let row_mean = |row: usize| {
        let row = &pixels[width * row..width * (row + 1)];
        row.iter().map(|&value| f64::from(value)).sum::<f64>() / width as f64
    };
    // Heights and means from the zenith down to the horizon, half-way between rows 3 and 4.
    let angle = |row: usize| (row as f64 + 0.5) / height as f64 * PI;
    let node = |row: usize| (angle(row).cos() / angle(0).cos(), row_mean(row));
    let mut nodes: Vec<_> = (0..height / 2).map(node).collect();
    nodes.push((0.0, 0.5 * (row_mean(3) + row_mean(4))));
    let band = |pair: &[(f64, f64)]| {
        // Simpson's rule is exact for the parabola that linear radiance times height is.
        let [(a, at_a), (b, at_b)] = [pair[0], pair[1]];
        (a - b) / 6.0 * (a * at_a + (a + b) * (at_a + at_b) + b * at_b)
    };
    let expected = 0.5 * 2.0 * nodes.windows(2).map(band).sum::<f64>();

    for rotation_degrees in [0.0, 200.0] {
        for kit in under(EnvironmentDescription::Image {
            file: file.clone(),
            rotation_degrees,
            scale: 1.0,
        })
        .both_ways()
        {
            let what = format!("image, {rotation_degrees} degrees, {}", kit.how());
            kit.mean().must_be(expected, &what);
        }
    }
}

/// Everything at once: what each brings adds up, however the choice among them falls.
#[test]
fn emitters_sky_and_sun_add_up() {
    let (mut kit, sum) = emitters(40);
    let (zenith, horizon, nadir) = (Rgb::splat(0.3), Rgb::ZERO, Rgb::ZERO);
    kit.scene.description.background = BackgroundDescription {
        dome: EnvironmentDescription::Gradient { zenith, horizon, nadir },
        sun: Some(sun(50.0, 0.0, 0.533, 0.2)),
        ..BackgroundDescription::default()
    };
    let all = kit.mean();
    // The emitters cover some of the sky, and one may cover the sun.
    for material in &mut kit.scene.description.materials {
        material.emission = Rgb::ZERO;
    }
    let by_sky = kit.mean();
    let alone = MeanEstimate { mean: all.mean - by_sky.mean, ..all };
    alone.must_agree(MeanEstimate { mean: sum, ..by_sky }, "lamps beside sky and sun");
}

/// A diffuse, a glass and a mirror ball before a background.
fn balls() -> Kit {
    let mut kit = Kit::new(60, 20, 64);
    kit.scene.camera([0.0, 0.0, 20.0], [0.0; 3]).field_of_view(10.0).background([1.0; 3]);
    kit.ball([-3.0, 0.0, 0.0], 1.0, diffuse(0.5));
    kit.ball([0.0, 0.0, 0.0], 1.0, glass(1.5));
    kit.ball([3.0, 0.0, 0.0], 1.0, mirror(1.0));
    kit
}

#[test]
fn a_hidden_background_shines_but_is_not_seen_by_the_camera() {
    for mut kit in balls().both_ways() {
        kit.scene.description.background.camera_visible = false;
        let hidden = kit.picture();
        kit.scene.description.background.transparent = true;
        let transparent = kit.picture();
        assert!(hidden.alpha.is_none());
        assert_eq!(hidden.direct, transparent.direct);
        let alpha = transparent.alpha.as_ref().expect("asked for");
        assert_eq!((transparent.beauty(0), alpha[0]), (Rgb::ZERO, 0.0));
        // Glass and mirror balls show the background, so they are as opaque as the diffuse one.
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
