//! The path tracer and its options, in which the path integrators differ.

use crate::sampling::Hemisphere;
use crate::scene::settings::{Estimator, MissPolicy, PathTermination};

use super::super::camera_rays::Strata;

/// Path tracing with its options.
pub(in crate::integrator) struct PathTracer {
    pub(in crate::integrator) estimator: Estimator,
    pub(in crate::integrator) hemisphere: Hemisphere,
    pub(in crate::integrator) stop: PathTermination,
    pub(in crate::integrator) miss: MissPolicy,
    pub(in crate::integrator) strata: Strata,
    /// Maximum path length, in edges.
    pub(in crate::integrator) max_depth: u32,
    /// Maximum number of scattering events, not counting mirrors and smooth glass: 1 is direct
    /// light.
    pub(in crate::integrator) max_scatterings: u32,
    /// Upper bound on what one path adds to a channel of indirect light; biased.
    pub(in crate::integrator) clamp_indirect: Option<f32>,
}
