//! What every integrator can do.

use crate::color::PathRadiance;

use super::sample::{RenderStats, SampleAddress};
use super::trace::PathTrace;
use super::workspace::Workspace;
use super::world::RenderContext;

/// An estimator of the light that arrives at a pixel.
pub trait Integrator: Send + Sync {
    /// Estimates the radiance of each sample. The slices have equal lengths.
    fn estimate(
        &self,
        world: RenderContext<'_>,
        samples: &[SampleAddress],
        radiance: &mut [PathRadiance],
        workspace: &mut Workspace,
    ) -> RenderStats;

    /// Tells the path of one sample step by step: the very path that [`Self::estimate`] takes there.
    /// `None` for an integrator that follows no paths.
    fn trace_path(&self, _world: RenderContext<'_>, _address: SampleAddress) -> Option<PathTrace> {
        None
    }
}
