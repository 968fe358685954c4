//! Filters, sub-pixels and jitter: where in its pixel a sample falls.

use crate::common::{Estimate, SEEDS, picture};
use crate::scenes::{FURNACE, with};

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
