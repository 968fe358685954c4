//! `integrator = "path"`: light sampling and BSDF sampling, combined by multiple importance
//! sampling (Veach 1997, chapter 9; Kajiya 1986). The `estimator` setting selects either technique
//! alone for comparison.

use crate::sampling::Hemisphere;
use crate::scene::settings::{MissPolicy, PathTermination, RenderSettings};

use super::camera_rays::Strata;
use super::transport::PathTracer;

/// Creates the path tracer from the `[render]` settings.
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
