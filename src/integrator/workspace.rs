//! Memory that is used again.

use crate::color::VisibleSurface;
use crate::material::MediumStack;
use crate::math::{Hit, Isa, Ray};
use crate::sampling::Sampler;

use super::transport::{CameraRayBatch, DiffuseBatch, PathQueue, PrevVertex, ShadowRays};

/// Memory that one thread uses again for every batch.
#[derive(Default)]
pub struct Workspace {
    pub(super) isa: Isa,
    pub(super) path_queue: PathQueue,
    pub(super) next_path_queue: PathQueue,
    pub(super) camera_batch: CameraRayBatch,
    pub(super) diffuse_batch: DiffuseBatch,
    pub(super) shadow_rays: ShadowRays,
    pub(super) samplers: Vec<Sampler>,
    pub(super) prev_vertices: Vec<PrevVertex>,
    /// The media that each sample's path is in, where something is a dielectric.
    pub(super) media: Vec<MediumStack>,
    /// The media that shadow rays start in, where something is not opaque.
    pub(super) shadow_media: Vec<MediumStack>,
    pub(super) rays: Vec<Ray>,
    pub(super) hits: Vec<Hit>,
    pub(super) occluded: Vec<bool>,
    /// The share of the light of each shadow ray that arrives.
    pub(super) visibility: Vec<f32>,
    pub(super) records_visible_surfaces: bool,
    /// What each sample sees first, where that is recorded.
    pub(super) visible_surfaces: Vec<VisibleSurface>,
}

impl Workspace {
    /// With a choice of the instructions that vectors are computed with, which changes no bit.
    pub fn with_isa(isa: Isa) -> Self {
        Self { isa, ..Self::default() }
    }

    /// Whether estimates from here on record what each sample sees first.
    pub fn record_visible_surfaces(&mut self, wanted: bool) {
        self.records_visible_surfaces = wanted;
    }

    /// What each sample of the last estimate sees first; empty where that is not recorded.
    pub fn visible_surfaces(&self) -> &[VisibleSurface] {
        &self.visible_surfaces
    }

    /// Forgets the records of the last estimate, and makes room for so many where they are wanted.
    pub(super) fn reset_visible_surfaces(&mut self, samples: usize) {
        self.visible_surfaces.clear();
        self.visible_surfaces
            .resize(if self.records_visible_surfaces { samples } else { 0 }, VisibleSurface::NONE);
    }
}
