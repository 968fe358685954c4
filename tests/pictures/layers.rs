//! The layers of a picture show what they say.

use photosphere::accel::Backend;
use photosphere::color::{NO_ROW, Rgb};
use photosphere::film::{AOVS, Aov, Layer};
use photosphere::image_io::{ChannelValues, Picture};
use photosphere::job::render_with_accel;
use photosphere::math::Rect;
use photosphere::scene::description::{MaterialDescription, SurfaceModel};
use photosphere::scene::settings::{IntegratorSettings, PaperSettings, SamplerKind};
use photosphere::task::CancelToken;

use crate::kit::{Kit, built};

/// A ground, an emitter, a mirror, glass, a ball that is half there, and a diffuse ball before a
/// background.
fn kit() -> Kit {
    let mut kit = Kit::new(48, 36, 20);
    kit.settings.render.max_depth = Some(4);
    let scene = &mut kit.scene;
    scene.camera([0.0, 1.0, 6.0], [0.0, 1.0, 0.0]).field_of_view(40.0).background([0.2, 0.3, 0.4]);
    let ground = scene.diffuse([0.5, 0.25, 0.75]);
    let diffuse = scene.diffuse([0.25, 0.5, 0.125]);
    let mirror = scene.mirror([0.875, 0.75, 0.5]);
    let glass = scene.glass(1.5);
    let emitter = scene.emitter([4.0, 3.0, 2.0]);
    let red = SurfaceModel::Diffuse { albedo: Rgb::X, roughness: 0.0 };
    let half = scene.material(MaterialDescription {
        surface: red,
        opacity: 0.5,
        ..MaterialDescription::default()
    });
    scene
        .sphere(ground, [0.0, -100.0, 0.0], 100.0)
        .sphere(diffuse, [0.0, 1.0, 0.0], 1.0)
        .sphere(mirror, [-1.7, 0.7, 0.5], 0.7)
        .sphere(glass, [1.6, 0.7, 0.8], 0.7)
        .sphere(emitter, [0.8, 2.6, 0.0], 0.4)
        .sphere(half, [-0.8, 2.6, 0.0], 0.4);
    kit
}

/// The scene with an opaque ball in place of the one that is half there.
fn solid_kit() -> Kit {
    kit().with(|kit| kit.scene.description.materials[5].opacity = 1.0)
}

const EYE: [f32; 3] = [0.0, 1.0, 6.0];

fn rendered(kit: &Kit, kinds: &[Aov]) -> Picture {
    let prepared = kit.prepared();
    let accel = built(&prepared, Backend::Native);
    render_with_accel(&prepared, &*accel, kinds, &CancelToken::default()).expect("memory").picture
}

fn everything(kit: &Kit) -> Picture {
    rendered(kit, &AOVS.map(|row| row.aov))
}

fn floats<'p>(picture: &'p Picture, name: &str) -> &'p [f32] {
    let plane = picture.channels.iter().find(|plane| plane.name == name).expect(name);
    let ChannelValues::Float(values) = &plane.values else { panic!("{name} is whole") };
    values
}

fn whole<'p>(picture: &'p Picture, name: &str) -> &'p [u32] {
    let plane = picture.channels.iter().find(|plane| plane.name == name).expect(name);
    let ChannelValues::Uint(values) = &plane.values else { panic!("{name} is not whole") };
    values
}

fn triple(picture: &Picture, name: &str, channels: &str, pixel: usize) -> [f32; 3] {
    let mut channels = channels.chars();
    std::array::from_fn(|_| {
        let channel = channels.next().expect("three channels");
        floats(picture, &format!("{name}.{channel}"))[pixel]
    })
}

/// Pixels all of whose samples saw this material, and the sphere at whose centre has it.
fn covered(picture: &Picture, material: u32, albedo: [f32; 3]) -> Vec<usize> {
    let ids = whole(picture, "material_id");
    let is_covered = |&pixel: &usize| {
        ids[pixel] == material && triple(picture, "albedo", "RGB", pixel) == albedo
    };
    let found: Vec<usize> = (0..picture.len()).filter(is_covered).collect();
    assert!(found.len() > 20, "{material}: {}", found.len());
    found
}

#[test]
fn light_is_the_same_whatever_layers_are_kept() {
    let all = everything(&kit());
    let usual = rendered(&kit(), &Aov::DEFAULT);
    let few = rendered(&kit(), &[Aov::Mean(Layer::Depth)]);
    for picture in [&usual, &few] {
        assert_eq!(picture.direct, all.direct);
        assert_eq!(picture.indirect, all.indirect);
        assert_eq!(picture.alpha, None);
    }
    assert_eq!(few.hidden_layers, ["direct", "indirect"]);
    assert_eq!(few.channels.len(), 1);
    assert_eq!(floats(&few, "depth"), floats(&all, "depth"));
    assert!(usual.channels.is_empty() && usual.hidden_layers.is_empty());
}

/// What the camera sees straight is what paths of one edge bring.
#[test]
fn emission_is_the_light_of_paths_of_one_edge() {
    let all = everything(&kit());
    let straight =
        rendered(&kit().with(|kit| kit.settings.render.max_depth = Some(1)), &Aov::DEFAULT);
    for pixel in 0..all.len() {
        let emission = triple(&all, "emission", "RGB", pixel);
        assert_eq!(emission, straight.beauty(pixel).to_array(), "{pixel}");
        for (emission, direct) in emission.into_iter().zip(all.direct[pixel].to_array()) {
            assert!(emission <= direct);
        }
    }
    assert!((0..all.len()).any(|pixel| triple(&all, "emission", "RGB", pixel)[0] == 4.0));
}

#[test]
fn normals_are_those_of_the_integrator_for_them() {
    let all = everything(&kit());
    let alpha = all.alpha.clone().expect("asked for");
    // Its samples go through the same places; it knows nothing of opacity.
    let solid = everything(&solid_kit());
    let normals = rendered(&kit().integrator(IntegratorSettings::Normals), &Aov::DEFAULT);
    let solid_alpha = solid.alpha.clone().expect("asked for");
    for pixel in 0..all.len() {
        let expected = normals.beauty(pixel).to_array();
        let normal = triple(&solid, "normal", "XYZ", pixel);
        for (normal, expected) in normal.into_iter().zip(expected) {
            let color = 0.5 * solid_alpha[pixel] + 0.5 * normal;
            assert!((color - expected).abs() < 1e-6, "{pixel}: {color} {expected}");
        }
        assert!(alpha[pixel] <= solid_alpha[pixel]);
    }
    // A quarter of the samples go through both walls of the ball that is half there. Twelve pixels
    // of 20 samples have a standard error of 0.028.
    let ids = whole(&all, "sphere_id");
    let half: Vec<f32> = (0..all.len())
        .filter(|&pixel| ids[pixel] == 5 && solid_alpha[pixel] == 1.0)
        .map(|pixel| alpha[pixel])
        .collect();
    assert!(half.len() >= 12);
    let mean = half.iter().sum::<f32>() / half.len() as f32;
    assert!((mean - 0.75).abs() < 0.12, "{mean}");
}

#[test]
fn albedo_depth_and_position_are_those_of_the_first_surface() {
    let all = everything(&kit());
    let balls = [
        (0, [0.5, 0.25, 0.75], [0.0, -100.0, 0.0], 100.0),
        (1, [0.25, 0.5, 0.125], [0.0, 1.0, 0.0], 1.0),
        (2, [0.875, 0.75, 0.5], [-1.7, 0.7, 0.5], 0.7),
        (3, [1.0; 3], [1.6, 0.7, 0.8], 0.7),
    ];
    for (material, albedo, center, radius) in balls {
        for pixel in covered(&all, material, albedo) {
            let at = triple(&all, "position", "XYZ", pixel);
            let distance = |from: [f32; 3]| {
                let squares = (0..3).map(|axis| (at[axis] - from[axis]).powi(2));
                squares.sum::<f32>().sqrt()
            };
            // The mean over the samples lies within the ball, by half a pixel's width squared over
            // its radius where it is seen face on; at grazing incidence a pixel is long.
            let depth = floats(&all, "depth")[pixel];
            assert!(distance(center) < radius * 1.0001, "{material} {pixel}");
            assert!((distance(EYE) - depth).abs() < 0.02 * depth, "{material} {pixel}");
        }
    }
    // Where a ball covers part of a pixel before the background, its distance is still its own.
    let alpha = all.alpha.as_deref().expect("asked for");
    let depths = floats(&all, "depth");
    let partly = (0..all.len()).filter(|&pixel| alpha[pixel] > 0.0 && alpha[pixel] < 1.0);
    assert!(partly.clone().count() > 10);
    for pixel in partly {
        assert!(depths[pixel] > 4.0 && depths[pixel] < 40.0, "{pixel}: {}", depths[pixel]);
    }
    for pixel in (0..all.len()).filter(|&pixel| alpha[pixel] == 0.0) {
        assert_eq!(depths[pixel], f32::INFINITY);
        assert_eq!(triple(&all, "position", "XYZ", pixel), [0.0; 3]);
        assert_eq!(whole(&all, "sphere_id")[pixel], NO_ROW);
        assert_eq!(whole(&all, "material_id")[pixel], NO_ROW);
    }
}

#[test]
fn ids_do_not_depend_on_samples_and_counts_are_counts() {
    let few = everything(&kit().with(|kit| kit.settings.render.samples_per_pixel = 1));
    let mut kit = kit().with(|kit| kit.settings.render.seed = 9);
    let more = everything(&kit);
    for name in ["sphere_id", "material_id"] {
        assert_eq!(whole(&few, name), whole(&more, name));
    }
    // Row 18 of 36, column 24 of 48: just below and right of the middle, on the diffuse ball.
    assert_eq!(whole(&few, "sphere_id")[18 * 48 + 24], 1);
    assert_eq!(whole(&more, "sample_count"), vec![20; 48 * 36]);
    kit.settings.image.crop = Some(Rect { x: 10, y: 12, width: 20, height: 8 });
    let crop = everything(&kit);
    for (pixel, &id) in whole(&crop, "sphere_id").iter().enumerate() {
        let there = (12 + pixel / 20) * 48 + 10 + pixel % 20;
        assert_eq!(id, whole(&more, "sphere_id")[there]);
        assert_eq!(floats(&crop, "depth")[pixel], floats(&more, "depth")[there]);
    }
}

/// Over 64 seeds the squared distance from the mean is what the layer says.
#[test]
fn variance_is_that_of_the_mean() {
    let mut kit = kit();
    (kit.settings.image.width, kit.settings.image.height) = (8, 6);
    // Three blocks, and a fourth that is not finished.
    kit.settings.render.samples_per_pixel = 50;
    kit.settings.render.sampler = SamplerKind::Independent;
    let mut picture = |seed| {
        kit.settings.render.seed = seed;
        rendered(&kit, &[Aov::Variance])
    };
    let pictures: Vec<Picture> = (0..64).map(&mut picture).collect();
    let (mut found, mut said) = (0.0, 0.0);
    for pixel in 0..48 {
        let values: Vec<f64> = pictures.iter().map(|p| f64::from(p.beauty(pixel).y)).collect();
        let mean = values.iter().sum::<f64>() / 64.0;
        found += values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / 63.0;
        let stated = pictures.iter().map(|p| f64::from(floats(p, "variance.G")[pixel]));
        said += stated.sum::<f64>() / 64.0;
    }
    // 48 pixels of 64 seeds each: the relative error of the sum is about sqrt(2 / 63 / 48) = 2.6 %
    // for normal values, which these are not quite.
    assert!((found / said - 1.0).abs() < 0.15, "{found} {said}");
}

#[test]
fn integrators_that_follow_no_paths_have_layers_too() {
    let all = everything(&solid_kit());
    for integrator in [
        IntegratorSettings::Raycast { shadows: false },
        IntegratorSettings::AmbientOcclusion { distance: None },
        IntegratorSettings::Normals,
        IntegratorSettings::Direct,
        IntegratorSettings::Paper(PaperSettings {
            subpixels: 1,
            samples: 20,
            ..PaperSettings::default()
        }),
    ] {
        let other = everything(&solid_kit().integrator(integrator));
        for name in ["albedo.R", "normal.Y", "depth", "position.Z"] {
            assert_eq!(floats(&other, name), floats(&all, name), "{integrator:?} {name}");
        }
        if !matches!(
            integrator,
            IntegratorSettings::AmbientOcclusion { .. } | IntegratorSettings::Normals
        ) {
            assert_eq!(floats(&other, "emission.R"), floats(&all, "emission.R"), "{integrator:?}");
        }
    }
}

/// In a mirror and through glass, the layers for denoising show what is behind; elsewhere they are
/// the first surface.
#[test]
fn layers_for_denoising_see_through_mirrors_and_glass() {
    let mut kit = Kit::new(24, 18, 16);
    let scene = &mut kit.scene;
    scene.camera([0.0, 0.0, 6.0], [0.0, 0.0, 0.0]).field_of_view(40.0).background([0.2, 0.3, 0.4]);
    let wall = scene.diffuse([0.25, 0.5, 0.125]);
    let mirror = scene.mirror([0.5, 0.75, 1.0]);
    let glass = scene.glass(1.5);
    // All of it is in a room; the mirror covers the left of the picture, glass the right.
    scene.sphere(wall, [0.0, 0.0, 0.0], 50.0).sphere(mirror, [-1.0, 0.0, 0.0], 0.9).sphere(
        glass,
        [1.0, 0.0, 0.0],
        0.9,
    );
    let picture = rendered(&kit, &AOVS.map(|row| row.aov));
    let ids = whole(&picture, "material_id");
    let albedo = |pixel| triple(&picture, "denoising_albedo", "RGB", pixel);
    let normal = |pixel| triple(&picture, "denoising_normal", "XYZ", pixel);
    let middle = |x: usize| 9 * 24 + x;
    assert_eq!((ids[middle(7)], ids[middle(16)], ids[middle(0)]), (1, 2, 0));
    assert_eq!(albedo(middle(7)), [0.125, 0.375, 0.125], "the wall times the mirror");
    assert_eq!(albedo(middle(0)), triple(&picture, "albedo", "RGB", middle(0)));
    assert_eq!(normal(middle(0)), triple(&picture, "normal", "XYZ", middle(0)));
    // A ray to the middle of the mirror comes back to the wall behind the camera, which faces it.
    assert!(normal(middle(7))[2] < -0.5, "{:?}", normal(middle(7)));
    // Glass takes no colour; light in it may take many turns, so that some is lost to the roulette.
    let seen = albedo(middle(16));
    for (seen, wall) in seen.into_iter().zip([0.25, 0.5, 0.125]) {
        assert!((seen / wall - 1.0).abs() < 0.1, "{seen} {wall}");
    }
    assert_eq!(triple(&picture, "albedo", "RGB", middle(16)), [1.0; 3]);
}
