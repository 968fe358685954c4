//! `integrator = "path"`: lights are aimed at and the hemisphere is sampled by the BSDF, and the two
//! are combined by multiple importance sampling (Veach 1997, chapter 9; Kajiya 1986). Either can be
//! had alone for comparison: `estimator`.

use crate::sampling::Hemisphere;
use crate::scene::settings::{MissPolicy, PathTermination, RenderSettings};

use super::camera_rays::Strata;
use super::transport::PathTracer;

/// The path tracer that `[render]` asks for.
pub(super) fn new(render: &RenderSettings) -> PathTracer {
    PathTracer {
        estimator: render.estimator,
        hemisphere: Hemisphere::Cosine,
        stop: PathTermination::Roulette,
        miss: MissPolicy::Background,
        strata: Strata::UNSTRATIFIED,
        max_depth: render.max_depth.unwrap_or(u32::MAX),
        max_scatterings: u32::MAX,
        clamp_indirect: render.clamp_indirect.map(|limit| limit as f32),
    }
}
