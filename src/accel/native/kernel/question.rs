//! What rays are asked.

use crate::accel::native::query::BestHit;
use crate::math::Hit;

/// What a batch is asked.
pub(super) trait QueryMode {
    /// True if any hit will do.
    const ANY_HIT: bool;
    /// What each ray is told.
    type Output;

    fn output(best: BestHit) -> Self::Output;
}

/// Which sphere is hit first.
pub(super) struct ClosestHit;

/// Occlusion: is any sphere hit?
pub(super) struct AnyHit;

impl QueryMode for ClosestHit {
    const ANY_HIT: bool = false;
    type Output = Hit;

    #[inline(always)]
    fn output(best: BestHit) -> Hit {
        best.to_hit()
    }
}

impl QueryMode for AnyHit {
    const ANY_HIT: bool = true;
    type Output = bool;

    #[inline(always)]
    fn output(best: BestHit) -> bool {
        best.is_hit()
    }
}
