//! Answers that are one number for the whole picture.

use crate::scene::description::Description;

use super::{albedo, emission, everywhere, field_radiance};

/// The sum of `Le a^k` over all numbers of bounces `k`.
pub(super) fn furnace(scene: &Description, _: usize) -> Vec<Option<f64>> {
    everywhere(scene, emission(scene, "wall") / (1.0 - albedo(scene, "wall")))
}

/// The same sum up to the longest path: each edge but the first is a bounce.
pub(super) fn furnace_cut_short(scene: &Description, _: usize) -> Vec<Option<f64>> {
    let (le, a) = (emission(scene, "wall"), albedo(scene, "wall"));
    let edges = scene.render.max_depth.unwrap_or(u32::MAX);
    everywhere(scene, (0..edges).map(|k| le * libm::pow(a, f64::from(k))).sum())
}

/// What was there without the scene.
pub(super) fn background(scene: &Description, _: usize) -> Vec<Option<f64>> {
    everywhere(scene, field_radiance(scene))
}
