//! The trait that every integrator implements.

use crate::color::PathRadiance;

use super::context::RenderContext;
use super::sample::{RenderStats, SampleAddress};
use super::trace::PathTrace;
use super::workspace::Workspace;

/// Estimates the radiance that arrives at a pixel.
pub trait Integrator: Send + Sync {
    /// Estimates the radiance of each sample. The slices have equal lengths.
    fn estimate(
        &self,
        context: RenderContext<'_>,
        samples: &[SampleAddress],
        radiance: &mut [PathRadiance],
        workspace: &mut Workspace,
    ) -> RenderStats;

    /// Traces the path of one sample event by event: exactly the path that [`Self::estimate`]
    /// takes. `None` for integrators that do not follow paths.
    fn trace_path(
        &self,
        _context: RenderContext<'_>,
        _address: SampleAddress,
    ) -> Option<PathTrace> {
        None
    }
}
