//! What rays are asked.

use crate::accel::native::query::Best;
use crate::math::Hit;

/// What a batch is asked.
pub(super) trait Question {
    /// Whether any hit will do.
    const ANY: bool;
    /// What each ray is told.
    type Answer;

    fn answer(best: Best) -> Self::Answer;
}

/// Which sphere is hit first.
pub(super) struct Closest;

/// Whether any sphere is hit.
pub(super) struct Any;

impl Question for Closest {
    const ANY: bool = false;
    type Answer = Hit;

    #[inline(always)]
    fn answer(best: Best) -> Hit {
        best.hit()
    }
}

impl Question for Any {
    const ANY: bool = true;
    type Answer = bool;

    #[inline(always)]
    fn answer(best: Best) -> bool {
        best.is_hit()
    }
}
