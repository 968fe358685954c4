//! What integrators that follow paths differ in.

use crate::sampling::Hemisphere;
use crate::scene::settings::{Estimator, MissPolicy, PathTermination};

use super::super::camera_rays::Strata;

/// Path tracing with its choices.
pub(in crate::integrator) struct PathTracer {
    pub(in crate::integrator) estimator: Estimator,
    pub(in crate::integrator) hemisphere: Hemisphere,
    pub(in crate::integrator) stop: PathTermination,
    pub(in crate::integrator) miss: MissPolicy,
    pub(in crate::integrator) strata: Strata,
    /// The longest path, in edges.
    pub(in crate::integrator) max_depth: u32,
    /// How often light may be scattered, mirrors and smooth glass not counted: 1 is direct light.
    pub(in crate::integrator) max_scatterings: u32,
    /// The most that one path may add to a channel of indirect light; biased.
    pub(in crate::integrator) clamp_indirect: Option<f32>,
}
