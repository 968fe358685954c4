//! The paper's integrator agrees with `path`, and errs as the paper says.

use photosphere::accel::Backend;

use crate::common::{Estimate, Rendered, picture, scene_file};
use crate::scenes::{ESTIMATORS, with};

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
