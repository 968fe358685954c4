//! Inside a glowing sphere: nothing is lost and nothing is made.

use photosphere::scene::settings::{PaperSettings, PathTermination};

use crate::kit::{ALLOWED, Judged, diffuse, glass, phong};
use crate::scenes::{BUBBLE, WALL, estimators, full_furnace, furnace, must_be, must_be_everywhere};

#[test]
fn a_furnace_glows_evenly_for_every_estimator_and_backend() {
    must_be_everywhere(&furnace(), 2.0, "furnace");
}

#[test]
fn white_mirror_and_glass_spheres_vanish_in_a_furnace() {
    must_be_everywhere(&full_furnace(), 2.0, "full furnace");
}

#[test]
fn a_camera_inside_glass_sees_radiance_times_the_squared_index() {
    // Looking out through its middle, where nothing is reflected back in a way that matters: the
    // uniform field has radiance 2 n^2 everywhere inside.
    let mut inside = full_furnace();
    inside.scene.camera([0.6, -0.4, -0.6], [0.6, -0.4, -3.0]);
    must_be(&inside, 2.0 * 1.5 * 1.5, "inside glass");
}

#[test]
fn a_path_of_limited_depth_gathers_the_first_terms_of_the_series() {
    for kit in estimators(&furnace()) {
        let mut expected = 0.0;
        for depth in 1..=4 {
            expected += 0.5f64.powi(depth - 1);
            let what = format!("{depth}, {}", kit.how());
            kit.clone().depth(depth as u32).mean().must_be(expected, &what);
        }
    }
}

#[test]
fn the_papers_stop_rules_lose_just_what_they_cut_off() {
    let paper = |stop| furnace().paper(PaperSettings { stop, ..PaperSettings::default() });
    paper(PathTermination::Depth).depth(5).mean().must_be(2.0 - 0.5f64.powi(4), "depth");
    // The weight after k bounces is 2^-k; the first below 0.01 is the seventh.
    paper(PathTermination::Threshold(0.01)).mean().must_be(2.0 - 0.5f64.powi(6), "threshold");
}

#[test]
fn the_furnace_shows_that_classic_phong_makes_energy_and_normalised_phong_does_not() {
    // A ball inside a black-walled emitter of radiance 1, seen face on: its radiance is its albedo.
    let ball = |normalized| {
        let mut kit = furnace();
        kit.material(WALL).surface = diffuse(0.0);
        kit.scene.field_of_view(10.0);
        kit.ball([0.0; 3], 1.0, phong([0.2, 0.8], 2.0, normalized)).mean()
    };
    let normalized = ball(true);
    assert!(normalized.mean <= 1.0 + ALLOWED * normalized.standard_error, "{normalized:?}");
    let classic = ball(false);
    // 0.2 + 0.8 * 2 pi / (n + 1) = 1.88 at normal incidence.
    assert!(classic.mean > 1.5, "{classic:?}");
}

#[test]
fn a_camera_knows_the_media_that_it_starts_in() {
    let view = |position: [f64; 3], towards: [f64; 3]| {
        let mut kit = full_furnace();
        kit.scene.camera(position, towards).field_of_view(20.0);
        kit
    };
    // In the bubble, entered last among equals: of air, in glass.
    let mut bubble = view([0.6, -0.4, 0.1], [0.6, -0.4, -3.0]);
    bubble.material(BUBBLE).surface = glass(1.0);
    bubble.mean().must_be(2.0, "bubble");
    // Where water of higher priority reaches into the glass.
    let overlap = view([1.1, -0.4, 0.0], [1.1, -0.4, -3.0]);
    overlap.mean().must_be(2.0 * 1.33 * 1.33, "overlap");
    // Outside, with rays that start inside the glass. A wider view would show rays that pass the
    // centre at more than radius / ior = 0.53: those are reflected inside the ball for ever.
    let mut near = view([0.6, -0.4, 3.0], [0.6, -0.4, 0.0]);
    near.scene.field_of_view(10.0);
    near.scene.description.camera.near = 2.6;
    near.mean().must_be(2.0 * 1.5 * 1.5, "near");
}
