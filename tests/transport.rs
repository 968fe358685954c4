//! Light transport against closed forms, for every estimator and every backend.
//!
//! Means are over 32 independent seeds and may be off by four standard errors (see
//! `common/render.rs` for the significance of that) and 1e-5 relative.

#[path = "common/render.rs"]
mod common;

use common::{ALLOWED, Estimate, Rendered, SEEDS, outcome, picture, scene, scene_file};
use photosphere::accel::Backend;

/// The estimators that solve the whole rendering equation, as overrides.
const ESTIMATORS: [&[&str]; 4] = [
    &["render.integrator=path"],
    &["render.integrator=paper"],
    &["render.integrator=paper", "render.paper.hemisphere=uniform-solid-angle"],
    &["render.integrator=paper", "render.paper.hemisphere=uniform-angle"],
];

fn with<'a>(some: &[&'a str], more: &[&'a str]) -> Vec<&'a str> {
    some.iter().chain(more).copied().collect()
}

/// Inside a sphere of albedo 1/2 and emission 1 every point has radiance 1/(1 - 1/2), whatever else
/// of reflectance 1 is in there.
const FURNACE: &str = r#"
format = 1
[image]
width = 6
height = 6
[camera]
position = [0.0, 0.0, 3.0]
look_at = [0.0, 0.0, 0.0]
vertical_fov_degrees = 60.0
[materials.wall]
type = "diffuse"
albedo = [0.5, 0.5, 0.5]
emission = [1.0, 1.0, 1.0]
[materials.white]
type = "diffuse"
albedo = [1.0, 1.0, 1.0]
[materials.mirror]
type = "mirror"
reflectance = [1.0, 1.0, 1.0]
[materials.glass]
type = "dielectric"
ior = 1.5
[materials.water]
type = "dielectric"
ior = 1.33
priority = 1
[[spheres]]
center = [1.0, 2.0, 0.5]
radius = 10.0
material = "wall"
[render]
samples_per_pixel = 16
"#;

const CONTENTS: &str = r#"
[[spheres]]
center = [-1.2, 0.0, 0.0]
radius = 0.6
material = "white"
[[spheres]]
center = [0.0, 0.9, 0.0]
radius = 0.7
material = "mirror"
[[spheres]]
name = "glass"
center = [0.6, -0.4, 0.0]
radius = 0.8
material = "glass"
[[spheres]]
name = "bubble"
center = [0.6, -0.4, 0.1]
radius = 0.4
material = "glass"
[[spheres]]
name = "water reaching into the glass"
center = [1.3, -0.4, 0.0]
radius = 0.5
material = "water"
"#;

#[test]
fn a_furnace_glows_evenly_for_every_estimator_and_backend() {
    for &backend in Backend::AVAILABLE {
        for estimator in ESTIMATORS {
            let what = format!("furnace, {} {estimator:?}", backend.name());
            Estimate::of_scene(FURNACE, estimator, backend).must_be(2.0, &what);
        }
    }
}

#[test]
fn white_mirror_and_glass_spheres_vanish_in_a_furnace() {
    let text = format!("{FURNACE}{CONTENTS}");
    for &backend in Backend::AVAILABLE {
        for estimator in ESTIMATORS {
            let what = format!("full furnace, {} {estimator:?}", backend.name());
            Estimate::of_scene(&text, estimator, backend).must_be(2.0, &what);
        }
    }
}

#[test]
fn a_camera_inside_glass_sees_radiance_times_the_squared_index() {
    let text = format!("{FURNACE}{CONTENTS}");
    // Looking out through its middle, where nothing is reflected back in a way that matters: the
    // uniform field has radiance 2 n^2 everywhere inside.
    let inside = ["camera.position=[0.6,-0.4,-0.6]", "camera.look_at=[0.6,-0.4,-3.0]"];
    for estimator in ESTIMATORS {
        let overrides = with(estimator, &inside);
        Estimate::of_scene(&text, &overrides, Backend::BruteForce)
            .must_be(2.0 * 1.5 * 1.5, &format!("inside glass, {estimator:?}"));
    }
}

#[test]
fn a_path_of_limited_depth_gathers_the_first_terms_of_the_series() {
    for estimator in ESTIMATORS {
        let mut expected = 0.0;
        for depth in 1..=4 {
            expected += 0.5f64.powi(depth - 1);
            let depth = format!("render.max_depth={depth}");
            let overrides = with(estimator, &[&depth, "render.samples_per_pixel=16"]);
            Estimate::of_scene(FURNACE, &overrides, Backend::BruteForce)
                .must_be(expected, &format!("{depth}, {estimator:?}"));
        }
    }
}

#[test]
fn the_papers_stop_rules_lose_just_what_they_cut_off() {
    let paper = ["render.integrator=paper", "render.samples_per_pixel=16"];
    let depth = with(&paper, &["render.paper.stop=depth", "render.max_depth=5"]);
    Estimate::of_scene(FURNACE, &depth, Backend::BruteForce).must_be(2.0 - 0.5f64.powi(4), "depth");
    // The weight after k bounces is 2^-k; the first below 0.01 is the seventh.
    let threshold = with(&paper, &["render.paper.stop=threshold", "render.paper.threshold=0.01"]);
    Estimate::of_scene(FURNACE, &threshold, Backend::BruteForce)
        .must_be(2.0 - 0.5f64.powi(6), "threshold");
}

/// A matt ball under a lamp that it sees entirely: radiance is `albedo L (R / d)^2 cos`.
const LONE_BALL: &str = r#"
format = 1
[image]
width = 2
height = 2
[camera]
position = [0.0, 0.0, 6.0]
look_at = [0.0, 0.0, 1.0]
vertical_fov_degrees = 0.0001
[materials.ball]
type = "diffuse"
albedo = [0.8, 0.8, 0.8]
[materials.lamp]
type = "diffuse"
albedo = [0.0, 0.0, 0.0]
emission = [7.0, 7.0, 7.0]
[[spheres]]
name = "ball"
center = [0.0, 0.0, 0.0]
radius = 1.0
material = "ball"
[[spheres]]
name = "lamp"
center = [0.0, 3.0, 5.0]
radius = 2.0
material = "lamp"
[render]
samples_per_pixel = 256
"#;

fn lone_ball_radiance() -> f64 {
    // From the point (0, 0, 1) with normal +z, the lamp's centre is at (0, 3, 4): distance 5.
    0.8 * 7.0 * (2.0f64 / 5.0).powi(2) * (4.0 / 5.0)
}

#[test]
fn a_lone_ball_under_a_lamp_has_its_closed_form_for_every_estimator_and_backend() {
    for &backend in Backend::AVAILABLE {
        for estimator in ESTIMATORS {
            for depth in [&[][..], &["render.max_depth=2"]] {
                let what = format!("lone ball, {} {estimator:?} {depth:?}", backend.name());
                Estimate::of_scene(LONE_BALL, &with(estimator, depth), backend)
                    .must_be(lone_ball_radiance(), &what);
            }
        }
    }
}

#[test]
fn raycasting_a_lone_ball_is_exact_and_shadows_can_be_left_out() {
    let cast = ["render.integrator=raycast", "render.samples_per_pixel=1"];
    let radiance = |more: &[&str]| picture(LONE_BALL, &with(&cast, more)).mean().y;
    let expected = lone_ball_radiance();
    assert!((radiance(&[]) - expected).abs() < 1e-5 * expected);
    assert!((radiance(&["render.raycast.shadows=true"]) - expected).abs() < 1e-5 * expected);
    // With the lamp behind something, only the shadow ray knows.
    let blocked = format!(
        "{LONE_BALL}\n[[spheres]]\ncenter = [0.0, 1.2, 2.6]\nradius = 0.5\nmaterial = \"ball\"\n"
    );
    let blocked = |shadows: &str| picture(&blocked, &with(&cast, &[shadows])).mean().y;
    assert!((blocked("render.raycast.shadows=false") - expected).abs() < 1e-5 * expected);
    assert_eq!(blocked("render.raycast.shadows=true"), 0.0);
}

#[test]
fn the_phong_highlight_has_the_published_value() {
    // Looking along the mirror direction of the lamp's centre: cos(alpha) = 1, so the classic form
    // sends specular E / cos and the normalised one specular (n + 2) / (2 pi) E.
    let irradiance = 7.0 * std::f64::consts::PI * (2.0f64 / 5.0).powi(2) * (4.0 / 5.0);
    let common = [
        "render.integrator=raycast",
        "render.samples_per_pixel=1",
        "materials.ball.type=phong",
        "materials.ball.albedo=[0,0,0]",
        "materials.ball.specular=[0.5,0.5,0.5]",
        "materials.ball.exponent=30",
        "camera.position=[0,-3,5]",
    ];
    let radiance = |form| picture(LONE_BALL, &with(&common, &[form])).mean().y;
    let normalized = radiance("materials.ball.normalized=true");
    let expected = 0.5 * 32.0 / std::f64::consts::TAU * irradiance;
    assert!((normalized - expected).abs() < 1e-4 * expected, "{normalized} {expected}");
    let classic = radiance("materials.ball.normalized=false");
    let expected = 0.5 * irradiance / 0.8;
    assert!((classic - expected).abs() < 1e-4 * expected, "{classic} {expected}");
}

#[test]
fn the_furnace_shows_that_classic_phong_makes_energy_and_normalised_phong_does_not() {
    // A ball inside a black-walled lamp of radiance 1, seen face on: its radiance is its albedo.
    let ball = |normalized: &str| {
        let text = format!(
            "{FURNACE}\n[[spheres]]\ncenter = [0, 0, 0]\nradius = 1.0\nmaterial = \"white\"\n"
        );
        let overrides = [
            "materials.wall.albedo=[0,0,0]",
            "camera.vertical_fov_degrees=10",
            "materials.white.type=phong",
            "materials.white.albedo=[0.2,0.2,0.2]",
            "materials.white.specular=[0.8,0.8,0.8]",
            "materials.white.exponent=2",
            normalized,
        ];
        Estimate::of_scene(&text, &overrides, Backend::BruteForce)
    };
    let normalized = ball("materials.white.normalized=true");
    assert!(normalized.mean <= 1.0 + ALLOWED * normalized.standard_error, "{normalized:?}");
    let classic = ball("materials.white.normalized=false");
    // 0.2 + 0.8 * 2 pi / (n + 1) = 1.88 at normal incidence.
    assert!(classic.mean > 1.5, "{classic:?}");
}

#[test]
fn paper_and_path_agree_on_the_papers_scene() {
    let text = scene_file("paper/fig2.toml");
    let small = ["image.width=32", "image.height=24"];
    let path = with(&small, &["render.samples_per_pixel=16"]);
    let path = Estimate::of_scene(&text, &path, Backend::BruteForce);
    for estimator in &ESTIMATORS[1..] {
        let paper = with(estimator, &with(&small, &["render.samples_per_pixel=256"]));
        let paper = Estimate::of_scene(&text, &paper, Backend::BruteForce);
        paper.must_agree(path, &format!("figure 2, {estimator:?}"));
    }
}

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

#[test]
fn direct_and_indirect_light_add_up_and_depth_two_is_direct() {
    let text = scene_file("paper/fig2.toml");
    let small = ["image.width=40", "image.height=30", "render.samples_per_pixel=16"];
    let all = picture(&text, &small);
    assert!(all.direct.iter().any(|c| c.y > 0.0) && all.indirect.iter().any(|c| c.y > 0.0));
    let direct = picture(&text, &with(&small, &["render.max_depth=2"]));
    assert_eq!(direct.direct, all.direct, "the same numbers draw the same first edges");
    assert!(direct.indirect.iter().all(|c| c.max_element() == 0.0));
    for i in 0..all.len() {
        assert_eq!(all.beauty(i), all.direct[i] + all.indirect[i]);
    }
}

#[test]
fn mirrors_and_glass_do_not_count_as_scattering() {
    // Nothing scatters: all light is direct, however many mirrors and glasses it passes.
    let black = ["materials.wall.albedo=[0,0,0]", "materials.white.albedo=[0,0,0]"];
    let seen = picture(&format!("{FURNACE}{CONTENTS}"), &black);
    assert!(seen.indirect.iter().all(|c| c.max_element() == 0.0));
    assert!(seen.direct.iter().filter(|c| c.y > 0.0).count() > seen.len() / 2);
    // A ball lit by a lamp and seen in a mirror is direct light as well: three edges, one scattering.
    let mirrored = picture(
        &scene_file("paper/fig4.toml"),
        &[
            "image.width=40",
            "image.height=30",
            "render.samples_per_pixel=16",
            "render.max_depth=3",
            "materials.floating.albedo=[0,0,0]",
            "camera.look_at=[-1.3,0.7,0]",
            "camera.vertical_fov_degrees=4",
        ],
    );
    assert!(mirrored.indirect.iter().all(|c| c.max_element() == 0.0));
    assert!(mirrored.direct.iter().filter(|c| c.y > 0.0).count() > mirrored.len() / 2);
}

#[test]
fn light_of_the_background_is_split_like_a_lamps() {
    let dark = ["materials.lamp.emission=[0,0,0]", "background.radiance=[1,1,1]"];
    let small = ["image.width=40", "image.height=30", "render.samples_per_pixel=16"];
    let at_depth =
        |depth| picture(&scene_file("paper/fig2.toml"), &with(&with(&dark, &small), &[depth]));
    let lit = |layer: &[photosphere::color::Rgb]| layer.iter().filter(|c| c.y > 0.0).count();
    assert_eq!(lit(&at_depth("render.max_depth=2").indirect), 0);
    assert!(lit(&at_depth("render.max_depth=3").indirect) > 100);
    assert!(lit(&at_depth("render.max_depth=3").direct) > 1100);
}

#[test]
fn a_camera_knows_the_media_that_it_starts_in() {
    let text = format!("{FURNACE}{CONTENTS}");
    let radiance = |position: &str, towards: &str, more: &[&str], index: f64, what: &str| {
        let view = [position, towards, "camera.vertical_fov_degrees=20"];
        Estimate::of_scene(&text, &with(&view, more), Backend::BruteForce)
            .must_be(2.0 * index * index, what);
    };
    // In the bubble, entered last among equals: of air, in glass.
    let air = ["spheres.bubble.material=air", "materials.air={type=\"dielectric\",ior=1.0}"];
    radiance("camera.position=[0.6,-0.4,0.1]", "camera.look_at=[0.6,-0.4,-3]", &air, 1.0, "bubble");
    // Where water of higher priority reaches into the glass.
    radiance("camera.position=[1.1,-0.4,0]", "camera.look_at=[1.1,-0.4,-3]", &[], 1.33, "overlap");
    // Outside, with rays that start inside the glass. A wider view would show rays that pass the
    // centre at more than radius / ior = 0.53: those are reflected inside the ball for ever.
    let near = ["camera.near=2.6", "camera.vertical_fov_degrees=10"];
    radiance("camera.position=[0.6,-0.4,3]", "camera.look_at=[0.6,-0.4,0]", &near, 1.5, "near");
}

#[test]
fn the_picture_has_the_same_bits_for_any_number_of_threads() {
    let text = scene_file("paper/fig4.toml");
    let small = ["image.width=60", "image.height=45", "render.samples_per_pixel=20"];
    let scene = scene(&text, &small);
    for &backend in Backend::AVAILABLE {
        let render = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            // Embree builds with its own threads, as many as there are in the pool.
            pool.expect("threads").install(|| outcome(&scene, backend).picture)
        };
        let one = render(1);
        for threads in [2, 7] {
            assert_eq!(one, render(threads), "{} on {threads} threads", backend.name());
        }
    }
}

#[test]
fn a_sample_does_not_depend_on_its_batch_or_order() {
    use photosphere::color::Radiance;
    use photosphere::integrator::{SampleAddress, Workspace, World, of_scene};
    let text = scene_file("paper/fig4.toml");
    for integrator in ["render.integrator=path", "render.integrator=paper"] {
        let scene = scene(&text, &["image.width=64", "image.height=48", integrator]);
        let accel =
            Backend::BruteForce.build(scene.spheres(), &Default::default()).expect("builds");
        let cancel = Default::default();
        let world = World { scene: &scene, accel: &*accel, cancel: &cancel };
        let estimate = |samples: &[SampleAddress]| {
            let mut radiance = vec![Radiance::default(); samples.len()];
            of_scene(&scene).estimate(world, samples, &mut radiance, &mut Workspace::default());
            radiance.iter().map(|r| (r.direct, r.indirect)).collect::<Vec<_>>()
        };
        let address = |i: u32| SampleAddress { x: i * 7 % 64, y: i * 5 % 48, sample: i % 13 };
        let samples: Vec<_> = (0..500).map(address).collect();
        let together = estimate(&samples);
        let alone: Vec<_> = samples.iter().flat_map(|&s| estimate(&[s])).collect();
        assert_eq!(together, alone);
        let backwards: Vec<_> = samples.iter().rev().copied().collect();
        let mut again = estimate(&backwards);
        again.reverse();
        assert_eq!(together, again);
    }
}

#[test]
fn a_constant_scene_is_constant_under_every_filter_and_subpixel_count() {
    let text = FURNACE
        .replace("[materials.wall]", "[background]\nradiance = [0.3, 0.7, 0.2]\n[materials.wall]");
    let away = ["spheres.0.center=[0,0,99]"];
    for filter in ["box", "tent", "gaussian", "blackman-harris"] {
        let filter = format!("image.filter={filter}");
        for estimator in [
            &["render.integrator=path"][..],
            &["render.integrator=paper", "render.paper.subpixels=3", "render.samples_per_pixel=18"],
        ] {
            let picture = picture(&text, &with(&with(estimator, &away), &[&filter]));
            for i in 0..picture.len() {
                assert_eq!(picture.beauty(i).to_array(), [0.3, 0.7, 0.2], "{filter} {estimator:?}");
            }
        }
    }
}

/// A glowing ball with a sharp edge before a black background.
fn glowing_ball() -> String {
    FURNACE.replace("radius = 10.0", "radius = 0.7").replace("[1.0, 2.0, 0.5]", "[0.0, 0.0, 0.0]")
}

#[test]
fn subpixels_lower_the_variance_at_an_edge() {
    let variance = |overrides: &[&str]| {
        let pictures: Vec<_> = (0..SEEDS)
            .map(|seed| {
                let seed = format!("render.seed={seed}");
                picture(&glowing_ball(), &with(overrides, &[&seed, "render.max_depth=1"]))
            })
            .collect();
        let pixel = |i: usize| {
            let values: Vec<f64> = pictures.iter().map(|p| f64::from(p.beauty(i).y)).collect();
            Estimate::of(&values).standard_error.powi(2)
        };
        (0..pictures[0].len()).map(pixel).sum::<f64>()
    };
    let paper = "render.integrator=paper";
    let plain = variance(&[paper, "render.paper.subpixels=1", "render.samples_per_pixel=16"]);
    let strata = variance(&[paper, "render.paper.subpixels=2", "render.samples_per_pixel=16"]);
    assert!(strata < 0.8 * plain, "{strata} {plain}");
}

#[test]
fn redrawing_after_a_miss_swells_silhouettes() {
    let paper = [
        "render.integrator=paper",
        "render.paper.subpixels=1",
        "render.samples_per_pixel=64",
        "render.max_depth=1",
    ];
    let background = picture(&glowing_ball(), &paper);
    let redrawn = picture(&glowing_ball(), &with(&paper, &["render.paper.miss=redraw"]));
    let partly = |i: &usize| (0.001..0.999).contains(&background.beauty(*i).y);
    let edges: Vec<usize> = (0..background.len()).filter(partly).collect();
    assert!(!edges.is_empty());
    for i in edges {
        assert_eq!(redrawn.beauty(i).y, 1.0, "pixel {i} is wholly covered after redrawing");
    }
    assert_eq!(redrawn.beauty(0).y, 0.0, "an empty pixel ends all the same");
}

#[test]
fn without_jitter_a_pixel_has_no_noise_of_its_own() {
    let still = ["render.integrator=paper", "render.max_depth=1", "render.paper.jitter=0"];
    let render = |seed: &str| picture(&glowing_ball(), &with(&still, &[seed]));
    assert_eq!(render("render.seed=1"), render("render.seed=2"));
    // 2 x 2 fixed places: coverage in quarters.
    let picture = render("render.seed=3");
    assert!((0..picture.len()).all(|i| (picture.beauty(i).y * 4.0).fract() == 0.0));
}

#[test]
fn the_error_falls_with_the_square_root_of_the_samples() {
    // Figures 5 to 7: the root mean square error over pixels and seeds against a long render,
    // whose own error is far below.
    let text = scene_file("paper/fig2.toml");
    let small = ["image.width=16", "image.height=12"];
    let reference = picture(&text, &with(&small, &["render.samples_per_pixel=16384"]));
    let error = |samples: u32| {
        let samples = format!("render.samples_per_pixel={samples}");
        let squares: f64 = (0..8)
            .map(|seed| {
                let seed = format!("render.seed={}", seed + 1);
                let more = ["render.integrator=paper", &samples, &seed];
                let noisy = picture(&text, &with(&small, &more));
                let square =
                    |i| f64::from((noisy.beauty(i) - reference.beauty(i)).length_squared());
                (0..noisy.len()).map(square).sum::<f64>()
            })
            .sum();
        squares.sqrt()
    };
    let slope = (error(400) / error(4)).log10() / 2.0;
    println!("slope {slope:.3}");
    // 8 x 192 pixels: the ratio of the two errors is known to a few percent, the slope to 0.02.
    assert!((slope + 0.5).abs() < 0.06, "{slope}");
}
