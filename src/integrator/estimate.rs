//! What every integrator can do.

use crate::color::Radiance;

use super::sample::{SampleAddress, Tally};
use super::trace::Trace;
use super::workspace::Workspace;
use super::world::World;

/// An estimator of the light that arrives at a pixel.
pub trait Integrator: Send + Sync {
    /// Estimates the radiance of each sample. The slices have equal lengths.
    fn estimate(
        &self,
        world: World<'_>,
        samples: &[SampleAddress],
        radiance: &mut [Radiance],
        workspace: &mut Workspace,
    ) -> Tally;

    /// Tells the path of one sample step by step: the very path that [`Self::estimate`] takes there.
    /// `None` for an integrator that follows no paths.
    fn trace(&self, _world: World<'_>, _address: SampleAddress) -> Option<Trace> {
        None
    }
}
