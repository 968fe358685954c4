//! `integrator = "path"`: lamps are sampled by their visible cone and the hemisphere by the BSDF, and
//! the two are combined by multiple importance sampling (Veach 1997, chapter 9; Kajiya 1986).

use crate::sampling::Hemisphere;
use crate::scene::description::{Miss, Stop};

use super::camera_rays::Strata;
use super::transport::{FindLamps, Transport};

/// The path tracer for paths of at most `max_depth` edges.
pub(super) fn new(max_depth: Option<u32>) -> Transport {
    Transport {
        lamps: FindLamps::ByNextEvent,
        hemisphere: Hemisphere::Cosine,
        stop: Stop::Roulette,
        miss: Miss::Background,
        strata: Strata::NONE,
        max_depth: max_depth.unwrap_or(u32::MAX),
    }
}
