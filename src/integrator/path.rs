//! `integrator = "path"`: lights are aimed at and the hemisphere is sampled by the BSDF, and the two
//! are combined by multiple importance sampling (Veach 1997, chapter 9; Kajiya 1986). Either can be
//! had alone for comparison: `estimator`.

use crate::sampling::Hemisphere;
use crate::scene::settings::{Miss, Render, Stop};

use super::camera_rays::Strata;
use super::transport::Transport;

/// The path tracer that `[render]` asks for.
pub(super) fn new(render: &Render) -> Transport {
    Transport {
        estimator: render.estimator,
        hemisphere: Hemisphere::Cosine,
        stop: Stop::Roulette,
        miss: Miss::Background,
        strata: Strata::NONE,
        max_depth: render.max_depth.unwrap_or(u32::MAX),
        most_scatterings: u32::MAX,
        clamp_indirect: render.clamp_indirect.map(|limit| limit as f32),
    }
}
