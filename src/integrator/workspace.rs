//! Reusable per-thread memory.

use crate::color::{Rgb, VisibleSurface};
use crate::material::MediumStack;
use crate::math::{Hit, Isa, Ray};
use crate::sampling::Sampler;

use super::profile::{StageClock, StageProfile};
use super::transport::{
    CameraRayBatch, ChainRecord, PathQueue, PrevVertex, ShadowRays, VertexBatches,
};

/// Scratch memory that one thread reuses for every batch.
#[derive(Default)]
pub struct Workspace {
    pub(super) isa: Isa,
    pub(super) clock: StageClock,
    pub(super) path_queue: PathQueue,
    pub(super) next_path_queue: PathQueue,
    pub(super) camera_batch: CameraRayBatch,
    pub(super) vertex_batches: VertexBatches,
    pub(super) shadow_rays: ShadowRays,
    pub(super) samplers: Vec<Sampler>,
    pub(super) prev_vertices: Vec<PrevVertex>,
    /// Only used in scenes with connections.
    pub(super) chain_records: Vec<ChainRecord>,
    /// The media that each sample's path is in; empty in scenes without dielectrics.
    pub(super) media: Vec<MediumStack>,
    /// The media that shadow rays start in, in scenes with surfaces that they may pass.
    pub(super) shadow_media: Vec<MediumStack>,
    pub(super) rays: Vec<Ray>,
    pub(super) hits: Vec<Hit>,
    pub(super) occluded: Vec<bool>,
    /// The fraction of its light that each shadow ray transmits.
    pub(super) visibility: Vec<Rgb>,
    pub(super) records_visible_surfaces: bool,
    /// Each sample's first visible surface, if recorded.
    pub(super) visible_surfaces: Vec<VisibleSurface>,
}

impl Workspace {
    /// Creates a workspace that uses the given instruction set. Results are bit-identical for all
    /// of them.
    pub fn with_isa(isa: Isa) -> Self {
        Self { isa, ..Self::default() }
    }

    /// Creates a workspace that measures the stages of the path tracer.
    pub fn profiled() -> Self {
        Self { clock: StageClock::started(), ..Self::default() }
    }

    /// Returns what a profiled workspace has measured so far.
    pub fn profile(&self) -> Option<StageProfile> {
        self.clock.profile()
    }

    /// Enables or disables recording of each sample's first visible surface.
    pub fn record_visible_surfaces(&mut self, wanted: bool) {
        self.records_visible_surfaces = wanted;
    }

    /// Returns the first visible surface of each sample of the last estimate; empty if not
    /// recorded.
    pub fn visible_surfaces(&self) -> &[VisibleSurface] {
        &self.visible_surfaces
    }

    /// Clears the records of the last estimate and makes room for `samples` new ones if enabled.
    pub(super) fn reset_visible_surfaces(&mut self, samples: usize) {
        self.visible_surfaces.clear();
        self.visible_surfaces
            .resize(if self.records_visible_surfaces { samples } else { 0 }, VisibleSurface::NONE);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tasks that wait for others run them on their own stack, of 2 MiB, a workspace each.
    #[test]
    fn a_workspace_takes_little_of_the_stack() {
        let size = size_of::<Workspace>();
        assert!(size <= 8192, "{size} bytes");
    }
}
