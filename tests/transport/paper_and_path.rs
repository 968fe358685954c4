//! The paper's integrator agrees with `path`, and errs as the paper says.

use photosphere::scene::settings::PaperSettings;

use crate::kit::{Judged, Kit};
use crate::scenes::estimators;

#[test]
fn paper_and_path_agree_on_the_papers_scene() {
    let kit = Kit::of_file("paper/fig2.toml", &["image.width=32", "image.height=24"]);
    let path = kit.clone().samples(16).mean();
    for paper in &estimators(&kit.samples(256))[1..] {
        paper.mean().must_agree(path, &format!("figure 2, {}", paper.how()));
    }
}

#[test]
fn the_error_falls_with_the_square_root_of_the_samples() {
    // Figures 5 to 7: the root mean square error over pixels and seeds against a long render,
    // whose own error is far below.
    let kit = Kit::of_file("paper/fig2.toml", &["image.width=16", "image.height=12"]);
    let reference = kit.clone().samples(16384).picture();
    let error = |samples: u32| {
        let mut paper = kit.clone().paper(PaperSettings::default()).samples(samples);
        let squares: f64 = (0..8)
            .map(|seed| {
                paper.settings.render.seed = seed + 1;
                let noisy = paper.picture();
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
