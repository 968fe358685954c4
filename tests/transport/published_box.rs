//! The classic nine-sphere box as published, against figures of other programs.
//!
//! Two independent programs, in double and in extended precision, and the published one agree on
//! them. The box is hard because of its lamp: a sphere of radius 600 that protrudes by 0.27 from a
//! wall of radius 1e5.

use photosphere::accel::Backend;
use photosphere::math::Hit;
use photosphere::scene::PreparedScene;

use crate::kit::{Judged, Kit, MeanEstimate, built, rendered};

const BOX: &str = "cornell-spheres.toml";

/// Points of a regular grid in each pixel and direction.
const GRID: u32 = 4;

/// The fraction of the image in which the lamp is visible.
fn lamp_fraction(prepared: &PreparedScene, backend: Backend) -> f64 {
    let (image, spheres) = (prepared.image_settings(), prepared.scene().spheres());
    let row = prepared.description().spheres.iter().position(|s| s.name.as_deref() == Some("lamp"));
    let row = row.expect("a lamp") as u32;
    let lamp = spheres.rows().iter().position(|&of_id| of_id == row).expect("an id") as u32;
    let accel = built(prepared, backend);
    let offset = |i: u32| (f64::from(i) + 0.5) / f64::from(GRID);
    let mut hit_count = 0;
    for y in 0..GRID * image.height {
        let ray = |x| prepared.camera().generate_ray(offset(x), offset(y), [0.5; 2]);
        let rays: Vec<_> = (0..GRID * image.width).map(|x| spheres.to_query(&ray(x))).collect();
        let mut hits = vec![Hit::MISS; rays.len()];
        accel.closest(&rays, &mut hits);
        hit_count += hits.iter().filter(|hit| hit.id == lamp).count();
    }
    hit_count as f64 / f64::from(GRID * image.width * GRID * image.height)
}

#[test]
fn the_lamp_fills_its_share_of_the_picture() {
    let prepared = Kit::of_file(BOX, &[]).prepared();
    for &backend in Backend::AVAILABLE {
        let fraction = lamp_fraction(&prepared, backend);
        // A grid of 5e6 points gives the area of an ellipse to about 2e-4 of it.
        let error = fraction / 0.00896118 - 1.0;
        assert!(error.abs() < 1e-3, "{}: {fraction:.8}, off by {error:.1e}", backend.name());
    }
}

#[test]
fn all_backends_give_the_same_picture() {
    let small = ["image.width=128", "image.height=96", "render.samples_per_pixel=8"];
    for scene in [BOX, "smallpt.toml"] {
        let prepared = Kit::of_file(scene, &small).prepared();
        let pictures = Backend::AVAILABLE.iter().map(|&b| rendered(&prepared, b).picture);
        let pictures: Vec<_> = pictures.collect();
        for (backend, picture) in Backend::AVAILABLE.iter().zip(&pictures) {
            assert!(picture == &pictures[0], "{scene}: `{}` differs", backend.name());
        }
    }
}

#[test]
fn the_mean_is_the_published_one() {
    let small =
        ["image.width=64", "image.height=48", "render.samples_per_pixel=64", "render.max_depth=8"];
    let kit = Kit::of_file(BOX, &small);
    let pictures: Vec<_> = kit.pictures(Backend::BruteForce).collect();
    for (channel, published) in [0.34347, 0.26913, 0.34355].into_iter().enumerate() {
        let means: Vec<f64> =
            pictures.iter().map(|picture| picture.mean().to_array()[channel]).collect();
        let published = MeanEstimate { mean: published, standard_error: 1e-4, seeds: 1_000_000 };
        MeanEstimate::from_values(&means).must_agree(published, &format!("channel {channel}"));
    }
}
