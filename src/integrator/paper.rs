//! `integrator = "paper"`: the estimator of the seed paper (Awan and Ko, "Ray tracing engine",
//! section 1.2). k x k sub-pixels, N paths each, lamps found by chance only.
//!
//! Where the paper is silent or wrong, `docs/paper.md` says how it is read here.

use crate::scene::description::Paper;

use super::camera_rays::Strata;
use super::transport::{FindLamps, Transport};

/// The paper's estimator with its options, for paths of at most `max_depth` edges.
pub(super) fn new(paper: &Paper, max_depth: Option<u32>) -> Transport {
    Transport {
        lamps: FindLamps::ByChance,
        hemisphere: paper.hemisphere,
        stop: paper.stop,
        miss: paper.miss,
        strata: Strata { subpixels: paper.subpixels, jitter: paper.jitter },
        max_depth: max_depth.unwrap_or(u32::MAX),
    }
}
