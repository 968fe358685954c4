//! The integrators and their ways to find light against each other, and paths told step by step.
//!
//! Means are judged over 32 seeds at a significance of 4e-4 each, see `common/render.rs`.

#[path = "common/render.rs"]
mod common;

use common::{Estimate, Rendered, picture, scene, scene_file};
use photosphere::accel::{Accel, Backend, BuildOptions, Cancel};
use photosphere::color::Rgb;
use photosphere::integrator::{End, SampleAddress, Step, World, of_scene};
use photosphere::scene::Scene;

/// A matt and a glossy ball, a mirror and a glass ball on a matt ground under two lamps and a sky.
const STILL_LIFE: &str = r#"
format = 1
[image]
width = 12
height = 8
[camera]
position = [0.0, 1.5, 7.0]
look_at = [0.0, 0.8, 0.0]
vertical_fov_degrees = 40.0
[background]
radiance = [0.2, 0.3, 0.4]
[materials.ground]
type = "diffuse"
albedo = [0.6, 0.6, 0.6]
[materials.glossy]
type = "phong"
albedo = [0.3, 0.3, 0.3]
specular = [0.5, 0.5, 0.5]
exponent = 40
[materials.mirror]
type = "mirror"
reflectance = [0.9, 0.9, 0.9]
[materials.glass]
type = "dielectric"
ior = 1.5
[materials.lamp]
type = "diffuse"
albedo = [0.5, 0.5, 0.5]
emission = [4.0, 3.0, 2.0]
[[spheres]]
name = "ground"
center = [0, -100, 0]
radius = 100
material = "ground"
[[spheres]]
name = "glossy"
center = [-2.2, 1, 0]
radius = 1
material = "glossy"
[[spheres]]
name = "mirror"
center = [0, 1, -0.5]
radius = 1
material = "mirror"
[[spheres]]
name = "glass"
center = [2.2, 1, 0]
radius = 1
material = "glass"
[[spheres]]
name = "large lamp"
center = [-1, 5, 2]
radius = 1.5
material = "lamp"
[[spheres]]
name = "small lamp"
center = [1, 0.3, 2]
radius = 0.3
material = "lamp"
[render]
samples_per_pixel = 16
"#;

fn accel_of(scene: &Scene) -> Box<dyn Accel> {
    Backend::BruteForce.build(scene.spheres(), &BuildOptions::default()).expect("builds")
}

#[test]
fn all_ways_to_find_light_have_the_same_mean() {
    let mean = |integrator: &str, estimator: &str, samples: &str| {
        let overrides = [integrator, estimator, samples].map(|o| format!("render.{o}"));
        let overrides = overrides.each_ref().map(String::as_str);
        Estimate::of_scene(STILL_LIFE, &overrides, Backend::BruteForce)
    };
    for integrator in ["integrator=path", "integrator=direct"] {
        let combined = mean(integrator, "estimator=mis", "samples_per_pixel=32");
        for (other, samples) in [("light", 32), ("bsdf", 128)] {
            let samples = format!("samples_per_pixel={samples}");
            let estimator = format!("estimator={other}");
            let what = format!("{integrator}, {other}");
            mean(integrator, &estimator, &samples).must_agree(combined, &what);
        }
    }
}

#[test]
fn each_way_to_find_light_does_what_its_name_says() {
    // Seen by nothing but matt surfaces, a lamp met by chance brings nothing to `light`, and
    // nothing is aimed at by `bsdf`: in a trace there are only shadow rays, or none.
    let count = |estimator: &str, chosen: &dyn Fn(&Step) -> bool| {
        let scene = scene(STILL_LIFE, &[&format!("render.estimator={estimator}")]);
        traces(&scene).iter().flat_map(|trace| &trace.steps).filter(|step| chosen(step)).count()
    };
    let by_chance = |step: &Step| {
        matches!(step, Step::Light { pdf: Some(_), pdf_light, added, .. }
        if *pdf_light > 0.0 && added.light != Rgb::ZERO)
    };
    let aimed = |step: &Step| matches!(step, Step::Aim { .. });
    assert_eq!(count("light", &by_chance), 0);
    assert_eq!(count("bsdf", &aimed), 0);
    assert!(count("mis", &by_chance) > 0 && count("mis", &aimed) > 0);
    assert!(count("light", &aimed) > 0);
}

#[test]
fn direct_light_is_the_direct_layer_of_all_light() {
    for text in [STILL_LIFE, &scene_file("paper/fig4.toml")] {
        for estimator in ["mis", "light", "bsdf"] {
            let small = ["image.width=24", "image.height=18", "render.samples_per_pixel=16"];
            let estimator = format!("render.estimator={estimator}");
            let overrides = [&small[..], &[&estimator]].concat();
            let all = picture(text, &[&overrides[..], &["render.integrator=path"]].concat());
            let direct = picture(text, &[&overrides[..], &["render.integrator=direct"]].concat());
            assert_eq!(direct.direct, all.direct, "{estimator}");
            assert!(direct.indirect.iter().all(|&light| light == Rgb::ZERO));
            assert!(all.indirect.iter().any(|&light| light != Rgb::ZERO));
        }
    }
}

#[test]
fn normals_are_exact_and_have_no_noise() {
    let view = ["render.integrator=normals", "image.width=3", "image.height=3", "render.seed=9"];
    let ball = r#"
format = 1
[image]
[camera]
position = [0, 0, 5]
look_at = [0, 0, 0]
vertical_fov_degrees = 30
[materials.any]
type = "mirror"
reflectance = [1, 1, 1]
[[spheres]]
center = [0, 0, 0]
radius = 1
material = "any"
"#;
    let normals = picture(ball, &view);
    assert_eq!(normals.direct[4], Rgb::new(0.5, 0.5, 1.0));
    assert_eq!(normals.direct[0], Rgb::ZERO, "beside the ball");
    // The ray through the middle of the right column's middle pixel: its height over the axis at
    // distance 1 is 2/3 tan 15 deg, and it meets the ball at the smaller root.
    let slope = 2.0 / 3.0 * 15f64.to_radians().tan();
    let (a, b, c) = (1.0 + slope * slope, -5.0, 24.0);
    let t = (-b - (b * b - a * c).sqrt()) / a;
    let expected = Rgb::new((0.5 + 0.5 * slope * t) as f32, 0.5, (0.5 + 0.5 * (5.0 - t)) as f32);
    assert!((normals.direct[5] - expected).abs().max_element() < 1e-6, "{}", normals.direct[5]);
    let other_seed = [&view[..], &["render.seed=10"]].concat();
    assert_eq!(normals.direct, picture(ball, &other_seed).direct);
}

/// Two balls of radius 1, their centres 4 apart, seen at the point between them.
const TWO_BALLS: &str = r#"
format = 1
[image]
width = 1
height = 1
[camera]
position = [0, 6, 0]
look_at = [0, 0, 0]
up = [1, 0, 0]
vertical_fov_degrees = 1e-6
[materials.matt]
type = "diffuse"
albedo = [0.1, 0.1, 0.1]
emission = [3, 3, 3]
[[spheres]]
center = [0, 0, 0]
radius = 1
material = "matt"
[[spheres]]
name = "over it"
center = [4, 1, 0]
radius = 2
material = "matt"
[render]
integrator = "ambient-occlusion"
samples_per_pixel = 256
"#;

#[test]
fn ambient_occlusion_is_one_less_the_covered_share() {
    let openness =
        |overrides: &[&str]| Estimate::of_scene(TWO_BALLS, overrides, Backend::BruteForce);
    // From the point (0, 1, 0) with normal +y the other ball's centre lies on the horizon, at the
    // distance 4. Its cone has sin^2 = 1/4; half of it is above the horizon. The share of the
    // cosine-weighted hemisphere that half a cone on the horizon covers is (a - sin a cos a) / pi,
    // with sin a = 1/2 the cone's half angle (Siegel and Howell, configuration factors).
    let a = (0.5f64).asin();
    let covered = (a - a.sin() * a.cos()) / std::f64::consts::PI;
    openness(&[]).must_be(1.0 - covered, "openness");
    // Its nearest point is 2 away.
    openness(&["render.ambient_occlusion.distance=1.99"]).must_be(1.0, "nothing is that near");
    let a_little = openness(&["render.ambient_occlusion.distance=2.5"]);
    assert!(a_little.mean > 1.0 - covered && a_little.mean < 1.0, "{a_little:?}");
    // Inside a ball nothing is open; where nothing is met, all is.
    let inside = ["spheres.over it.center=[0,1,0]".replace("over it", "\"over it\"")];
    let inside: Vec<&str> = inside.iter().map(String::as_str).collect();
    let inside = [&inside[..], &["camera.position=[0,2.5,0]"]].concat();
    openness(&inside).must_be(0.0, "inside");
    openness(&["camera.look_at=[0,7,0]", "camera.up=[1,0,0]"]).must_be(1.0, "nothing met");
}

#[test]
fn ambient_occlusion_is_a_white_scene_under_a_white_sky() {
    let white = |name: &str| format!("materials.{name}={{type=\"diffuse\", albedo=[1,1,1]}}");
    let materials = ["ground", "glossy", "mirror", "glass", "lamp"].map(white);
    let mut overrides: Vec<&str> = materials.iter().map(String::as_str).collect();
    overrides.extend(["background.radiance=[1,1,1]", "render.integrator=direct"]);
    let sky = Estimate::of_scene(STILL_LIFE, &overrides, Backend::BruteForce);
    let openness = ["render.integrator=ambient-occlusion"];
    Estimate::of_scene(STILL_LIFE, &openness, Backend::BruteForce).must_agree(sky, "white sky");
}

/// The traces of some samples of every pixel.
fn traces(scene: &Scene) -> Vec<photosphere::integrator::Trace> {
    let accel = accel_of(scene);
    let cancel = Cancel::default();
    let world = World { scene, accel: &*accel, cancel: &cancel };
    let integrator = of_scene(scene);
    let image = scene.description().image;
    let mut traces = Vec::new();
    for y in 0..image.height {
        for x in 0..image.width {
            for sample in 0..4 {
                let address = SampleAddress { x, y, sample };
                traces.push(integrator.trace(world, address).expect("it follows paths"));
            }
        }
    }
    traces
}

#[test]
fn a_trace_adds_up_to_its_sample_bit_by_bit() {
    for options in [
        &["render.integrator=path"][..],
        &["render.integrator=path", "render.clamp_indirect=0.5", "render.max_depth=5"],
        &["render.integrator=direct", "render.estimator=light"],
        &["render.integrator=paper", "render.paper.miss=redraw"],
        &["render.integrator=paper", "render.paper.stop=threshold"],
    ] {
        let scene = scene(STILL_LIFE, options);
        let accel = accel_of(&scene);
        let cancel = Cancel::default();
        let world = World { scene: &scene, accel: &*accel, cancel: &cancel };
        let traces = traces(&scene);
        // The renderer's own way: all samples in one batch.
        let samples: Vec<SampleAddress> = traces.iter().map(|trace| trace.address).collect();
        let mut radiance = vec![Default::default(); samples.len()];
        let tally =
            of_scene(&scene).estimate(world, &samples, &mut radiance, &mut Default::default());
        assert_eq!(tally.rays, traces.iter().map(|trace| trace.tally.rays).sum::<u64>());
        let mut lit = 0;
        for (trace, radiance) in traces.iter().zip(radiance) {
            for sum in [trace.sum(), trace.radiance] {
                assert_eq!(sum.direct, radiance.direct, "{options:?}");
                assert_eq!(sum.indirect, radiance.indirect, "{options:?}");
            }
            lit += usize::from(radiance.indirect != Rgb::ZERO);
            let ends = trace.steps.iter().filter(|step| matches!(step, Step::End(_))).count();
            assert_eq!(ends, 1, "a path ends once");
        }
        assert!(lit > 0 || options[0].ends_with("direct"));
    }
}

#[test]
fn integrators_without_paths_have_nothing_to_tell() {
    for name in ["normals", "ambient-occlusion", "raycast"] {
        let scene = scene(STILL_LIFE, &[&format!("render.integrator={name}")]);
        let accel = accel_of(&scene);
        let cancel = Cancel::default();
        let world = World { scene: &scene, accel: &*accel, cancel: &cancel };
        let address = SampleAddress { x: 0, y: 0, sample: 0 };
        assert!(of_scene(&scene).trace(world, address).is_none(), "{name}");
    }
}

/// Inside a sphere of albedo 0.99 that glows: the longest chains there are.
const BRIGHT_ROOM: &str = r#"
format = 1
[image]
width = 4
height = 4
[camera]
position = [0, 0, 0.5]
look_at = [0, 0, 0]
[materials.wall]
type = "diffuse"
albedo = [0.99, 0.99, 0.99]
emission = [0.01, 0.01, 0.01]
[[spheres]]
center = [0, 0, 0]
radius = 1
material = "wall"
[render]
estimator = "bsdf"
samples_per_pixel = 4
"#;

#[test]
fn roulette_keeps_weights_and_their_variance_bounded() {
    // Every vertex adds 0.01 times the weight, which roulette holds at 1: the number of vertices is
    // geometric with mean 100 at most, so the radiance 1 has a standard deviation of at most 1 (a
    // geometric number's is below its mean). Ending long paths with 5 % whatever they weigh would
    // make the variance infinite here: each edge would multiply the second moment by 0.99^2 / 0.95.
    let traces = traces(&scene(BRIGHT_ROOM, &["image.width=32", "image.height=32"]));
    let samples: Vec<f64> = traces
        .iter()
        .map(|trace| f64::from(trace.sum().direct.y + trace.sum().indirect.y))
        .collect();
    let n = samples.len() as f64;
    let mean = samples.iter().sum::<f64>() / n;
    let variance = samples.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1.0);
    assert!(variance < 1.5, "{variance}");
    for step in traces.iter().flat_map(|trace| &trace.steps) {
        if let Step::Roulette { throughput, .. } = step {
            assert!(throughput.max_element() <= 1.0 + 1e-6, "{step:?}");
        }
    }
    Estimate::of_scene(BRIGHT_ROOM, &[], Backend::BruteForce).must_be(1.0, "bright room");
}

#[test]
fn a_path_of_heavy_weight_survives_and_a_light_one_comes_to_weigh_one() {
    let scene = scene(STILL_LIFE, &[]);
    let mut seen = [0; 2];
    for trace in traces(&scene) {
        let mut before = 1.0f32;
        let mut index_squared = 1.0f64;
        for step in &trace.steps {
            match *step {
                Step::Scatter { throughput, eta, .. } => {
                    before = throughput.max_element();
                    index_squared *= eta * eta;
                }
                Step::Roulette { survival, survives, throughput } if survives => {
                    let after = throughput.max_element() * index_squared as f32;
                    assert!(after <= 1.0f32.max(before * index_squared as f32) + 1e-5);
                    assert!((after - 1.0).abs() < 1e-5 || survival == 1.0);
                    seen[usize::from(survival == 1.0)] += 1;
                }
                _ => {}
            }
        }
        assert!(trace.steps.iter().all(|step| !matches!(step, Step::End(End::CutOff))));
    }
    assert!(seen[0] > 0, "{seen:?}");
}

#[test]
fn clamping_takes_light_away_from_the_indirect_layer_only() {
    let free = picture(STILL_LIFE, &[]);
    let clamped = picture(STILL_LIFE, &["render.clamp_indirect=0.1"]);
    assert_eq!(clamped.direct, free.direct);
    assert!(clamped.indirect.iter().zip(&free.indirect).all(|(a, b)| a.cmple(*b + 1e-6).all()));
    assert!(clamped.mean().y < free.mean().y);
    let barely = picture(STILL_LIFE, &["render.clamp_indirect=1e9"]);
    assert_eq!(barely.indirect, free.indirect);
}

#[test]
fn options_that_bias_are_named() {
    let biases = |overrides: &[&str]| scene(STILL_LIFE, overrides).description().render.biases();
    assert!(biases(&[]).is_empty());
    assert!(biases(&["render.integrator=paper"]).is_empty());
    assert!(biases(&["render.integrator=normals", "render.max_depth=3"]).is_empty());
    assert_eq!(biases(&["render.clamp_indirect=10"]), ["clamp_indirect = 10"]);
    assert_eq!(
        biases(&[
            "render.integrator=paper",
            "render.max_depth=5",
            "render.paper.stop=depth",
            "render.paper.miss=redraw",
        ]),
        ["max_depth = 5", "paper.stop = \"depth\"", "paper.miss = \"redraw\""]
    );
}
