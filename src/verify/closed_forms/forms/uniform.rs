//! Scenes whose image is one constant.

use crate::scene::PreparedScene;

use super::{albedo, background_radiance, emission, uniform_answer};

/// The sum of `Le a^k` over all numbers of bounces `k`.
pub(super) fn furnace(shot: &PreparedScene, _: usize) -> Vec<Option<f64>> {
    uniform_answer(shot, emission(shot, "wall") / (1.0 - albedo(shot, "wall")))
}

/// The furnace sum up to the maximum path length: each edge except the first is a bounce.
pub(super) fn furnace_cut_short(shot: &PreparedScene, _: usize) -> Vec<Option<f64>> {
    let (le, a) = (emission(shot, "wall"), albedo(shot, "wall"));
    let edges = shot.render_settings().max_depth.unwrap_or(u32::MAX);
    uniform_answer(shot, (0..edges).map(|k| le * libm::pow(a, f64::from(k))).sum())
}

/// Returns the background radiance, unchanged by the scene.
pub(super) fn background(shot: &PreparedScene, _: usize) -> Vec<Option<f64>> {
    uniform_answer(shot, background_radiance(shot))
}
