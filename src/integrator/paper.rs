//! `integrator = "paper"`: the estimator of the seed paper (Awan and Ko, "Ray tracing engine",
//! section 1.2). k x k sub-pixels, N paths each, and emitters hit only by BSDF sampling.
//!
//! `docs/paper-checklist.md` documents how it is interpreted where the paper is silent or wrong.

use crate::scene::settings::{Estimator, PaperSettings, RenderSettings};

use super::camera_rays::Strata;
use super::path;
use super::transport::PathTracer;

/// Creates the paper's estimator from its settings.
pub(super) fn new(paper: &PaperSettings, render: &RenderSettings) -> PathTracer {
    PathTracer {
        estimator: Estimator::Bsdf,
        hemisphere: paper.hemisphere,
        stop: paper.stop,
        miss: paper.miss,
        strata: Strata { subpixels: paper.subpixels, jitter: paper.jitter },
        ..path::new(render)
    }
}
