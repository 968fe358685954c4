//! Scenes whose image is one constant.

use crate::scene::PreparedScene;

use super::{albedo, background_radiance, emission, uniform_solution};

/// The sum of `Le a^k` over all numbers of bounces `k`.
pub(super) fn furnace(prepared: &PreparedScene, _: usize) -> Vec<Option<f64>> {
    uniform_solution(prepared, emission(prepared, "wall") / (1.0 - albedo(prepared, "wall")))
}

/// The furnace sum up to the maximum path length: each edge except the first is a bounce.
pub(super) fn furnace_cut_short(prepared: &PreparedScene, _: usize) -> Vec<Option<f64>> {
    let (le, a) = (emission(prepared, "wall"), albedo(prepared, "wall"));
    let edges = prepared.render_settings().max_depth.unwrap_or(u32::MAX);
    uniform_solution(prepared, (0..edges).map(|k| le * libm::pow(a, f64::from(k))).sum())
}

/// Returns the radiance of the emitter that every path finds.
pub(super) fn emitter(prepared: &PreparedScene, _: usize) -> Vec<Option<f64>> {
    uniform_solution(prepared, emission(prepared, "lamp"))
}

/// Returns the background radiance, unchanged by the scene.
pub(super) fn background(prepared: &PreparedScene, _: usize) -> Vec<Option<f64>> {
    uniform_solution(prepared, background_radiance(prepared))
}
