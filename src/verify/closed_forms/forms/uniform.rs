//! Answers that are one number for the whole picture.

use crate::scene::PreparedScene;

use super::{albedo, background_radiance, emission, uniform_answer};

/// The sum of `Le a^k` over all numbers of bounces `k`.
pub(super) fn furnace(shot: &PreparedScene, _: usize) -> Vec<Option<f64>> {
    uniform_answer(shot, emission(shot, "wall") / (1.0 - albedo(shot, "wall")))
}

/// The same sum up to the longest path: each edge but the first is a bounce.
pub(super) fn furnace_cut_short(shot: &PreparedScene, _: usize) -> Vec<Option<f64>> {
    let (le, a) = (emission(shot, "wall"), albedo(shot, "wall"));
    let edges = shot.render_settings().max_depth.unwrap_or(u32::MAX);
    uniform_answer(shot, (0..edges).map(|k| le * libm::pow(a, f64::from(k))).sum())
}

/// What was there without the scene.
pub(super) fn background(shot: &PreparedScene, _: usize) -> Vec<Option<f64>> {
    uniform_answer(shot, background_radiance(shot))
}
