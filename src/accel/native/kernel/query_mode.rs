//! Query modes: closest hit and any hit.

use crate::accel::native::query::BestHit;
use crate::math::Hit;

/// A query mode.
pub(super) trait QueryMode {
    /// True if any hit is enough.
    const ANY_HIT: bool;
    /// The result for each ray.
    type Output;

    fn output(best: BestHit) -> Self::Output;
}

/// Finds the closest hit.
pub(super) struct ClosestHit;

/// Finds out if a ray is occluded.
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
