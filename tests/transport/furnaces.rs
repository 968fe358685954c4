//! Inside a glowing sphere: nothing is lost and nothing is made.

use photosphere::accel::Backend;

use crate::common::{ALLOWED, Estimate, Rendered};
use crate::scenes::{CONTENTS, ESTIMATORS, FURNACE, with};

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
