//! Connections in lanes.

use crate::light::ConnectedPoint;
use crate::light::specular::{EndLanes, RootFinder, RootLanes, SpecularPath};
use crate::math::LANES;

/// The connections of a batch to all pairs of a few.
#[derive(Default)]
pub(super) struct ConnectionLanes {
    pub(super) finder: RootFinder,
    pub(super) ends: EndLanes,
    /// Of the first pairs, as many as were met.
    pub(super) pairs: Vec<PairLanes>,
}

#[derive(Default)]
pub(super) struct PairLanes {
    /// The lanes that are solved, as a set of bits.
    pub(super) lanes: u32,
    /// The point of the light; `None` if the light does not face the ball.
    pub(super) points: [Option<ConnectedPoint>; LANES],
    /// The roots of each kind, in order.
    pub(super) roots: [RootLanes; SpecularPath::OVER_DIELECTRIC.len()],
}

impl ConnectionLanes {
    /// Returns the point of the light of the n-th pair and the roots of each kind, if the lane is
    /// solved.
    #[inline(always)]
    pub(super) fn of_lane(
        &self,
        n: u32,
        lane: usize,
    ) -> Option<(Option<&ConnectedPoint>, &[RootLanes])> {
        let pair = self.pairs.get(n as usize)?;
        (pair.lanes >> lane & 1 != 0).then(|| (pair.points[lane].as_ref(), &pair.roots[..]))
    }

    /// Forgets all lanes.
    pub(super) fn clear(&mut self) {
        self.pairs.iter_mut().for_each(|pair| pair.lanes = 0);
    }
}
