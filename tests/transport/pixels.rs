//! Filters, sub-pixels and jitter: where in its pixel a sample falls.

use photosphere::accel::Backend;
use photosphere::math::DVec3;
use photosphere::scene::settings::{FilterKind, ImageSettings, MissPolicy, PaperSettings};

use crate::kit::{Kit, MeanEstimate};
use crate::scenes::{WALL, furnace};

#[test]
fn a_constant_scene_is_constant_under_every_filter_and_subpixel_count() {
    let mut away = furnace();
    away.scene.background([0.3, 0.7, 0.2]);
    away.scene.description.spheres[WALL].center = DVec3::new(0.0, 0.0, 99.0);
    for filter in
        [FilterKind::Box, FilterKind::Tent, FilterKind::Gaussian, FilterKind::BlackmanHarris]
    {
        let image = &mut away.settings.image;
        (image.filter, image.filter_radius) =
            (filter, ImageSettings::default_filter_radius(filter));
        let paper = away
            .clone()
            .paper(PaperSettings { subpixels: 3, ..PaperSettings::default() })
            .samples(18);
        for kit in [&away, &paper] {
            let picture = kit.picture();
            for i in 0..picture.len() {
                let what = format!("{filter:?} {}", kit.how());
                assert_eq!(picture.beauty(i).to_array(), [0.3, 0.7, 0.2], "{what}");
            }
        }
    }
}

/// A glowing ball with a sharp edge before a black background.
fn glowing_ball(paper: PaperSettings) -> Kit {
    let mut kit = furnace().depth(1).paper(paper);
    let ball = &mut kit.scene.description.spheres[WALL];
    (ball.center, ball.radius) = (DVec3::ZERO, 0.7);
    kit
}

#[test]
fn subpixels_lower_the_variance_at_an_edge() {
    let variance = |subpixels| {
        let kit = glowing_ball(PaperSettings { subpixels, ..PaperSettings::default() });
        let pictures: Vec<_> = kit.pictures(Backend::BruteForce).collect();
        let pixel = |i: usize| {
            let values: Vec<f64> = pictures.iter().map(|p| f64::from(p.beauty(i).y)).collect();
            MeanEstimate::from_values(&values).standard_error.powi(2)
        };
        (0..pictures[0].len()).map(pixel).sum::<f64>()
    };
    let (plain, strata) = (variance(1), variance(2));
    assert!(strata < 0.8 * plain, "{strata} {plain}");
}

#[test]
fn redrawing_after_a_miss_swells_silhouettes() {
    let after = |miss| {
        glowing_ball(PaperSettings { subpixels: 1, miss, ..PaperSettings::default() })
            .samples(64)
            .picture()
    };
    let (background, redrawn) = (after(MissPolicy::Background), after(MissPolicy::Redraw));
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
    let mut still = glowing_ball(PaperSettings { jitter: 0.0, ..PaperSettings::default() });
    let mut render = |seed| {
        still.settings.render.seed = seed;
        still.picture()
    };
    assert_eq!(render(1), render(2));
    // 2 x 2 fixed places: coverage in quarters.
    let picture = render(3);
    assert!((0..picture.len()).all(|i| (picture.beauty(i).y * 4.0).fract() == 0.0));
}
