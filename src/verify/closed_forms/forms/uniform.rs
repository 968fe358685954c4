//! Answers that are one number for the whole picture.

use crate::scene::Shot;

use super::{albedo, emission, everywhere, field_radiance};

/// The sum of `Le a^k` over all numbers of bounces `k`.
pub(super) fn furnace(shot: &Shot, _: usize) -> Vec<Option<f64>> {
    everywhere(shot, emission(shot, "wall") / (1.0 - albedo(shot, "wall")))
}

/// The same sum up to the longest path: each edge but the first is a bounce.
pub(super) fn furnace_cut_short(shot: &Shot, _: usize) -> Vec<Option<f64>> {
    let (le, a) = (emission(shot, "wall"), albedo(shot, "wall"));
    let edges = shot.render().max_depth.unwrap_or(u32::MAX);
    everywhere(shot, (0..edges).map(|k| le * libm::pow(a, f64::from(k))).sum())
}

/// What was there without the scene.
pub(super) fn background(shot: &Shot, _: usize) -> Vec<Option<f64>> {
    everywhere(shot, field_radiance(shot))
}
