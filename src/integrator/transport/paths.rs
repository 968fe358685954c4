//! Path queues, with rays stored side by side, and the shadow rays of a stage.

use crate::color::Rgb;
use crate::geometry::{PathRay, PathRays, Side, SphereSet, SurfaceHit};
use crate::light::{CategoryPmf, LightSampleContext};
use crate::material::MediumStack;
use crate::math::{DVec3, NO_SPHERE};

use super::chain::Chain;

/// Hard limit on the edges of a path and on the surfaces it passes straight through. Paths that
/// exceed it are counted and reported.
pub(super) const MAX_PATH_EDGES: u32 = 10_000;

/// A path in progress.
pub(super) struct Path {
    pub(super) ray: PathRay,
    pub(super) state: PathState,
}

/// The state of a path, except its ray.
#[derive(Clone, Copy)]
pub(super) struct PathState {
    /// Index of its sample in the batch.
    pub(super) batch_index: u32,
    pub(super) throughput: Rgb,
    /// Number of edges, including the current ray.
    pub(super) depth: u32,
    /// Number of vertices so far that scattered light in more than one direction.
    pub(super) scatter_count: u32,
    pub(super) redraws: u32,
    /// Number of surfaces passed straight through.
    pub(super) passthroughs: u32,
    /// Number of total reflections since the path last did anything else.
    pub(super) total_reflections: u16,
    /// True if the ray was sampled from a density; see
    /// [`PathBatch::pdf_light`](super::batch::PathBatch::pdf_light).
    pub(super) has_prev_vertex: bool,
    /// The polished balls that the path has met since it last scattered in more than one direction.
    pub(super) chain: Chain,
    /// Squared index of refraction at the path's current position: the factor by which refraction
    /// has divided `throughput` so far.
    pub(super) eta_scale: f32,
}

/// Previous-vertex record for MIS: where the ray's direction was sampled, and with which pdf.
#[derive(Clone, Copy)]
pub(in crate::integrator) struct PrevVertex {
    pub(super) pdf: f64,
    pub(super) point: DVec3,
    pub(super) normal: DVec3,
    pub(super) id: u32,
    pub(super) side: Side,
    pub(super) is_two_sided: bool,
    pub(super) is_lambertian: bool,
    /// With which probabilities it sampled each category of lights.
    pub(super) lights: CategoryPmf,
}

/// The paths of a stage.
#[derive(Default)]
pub(in crate::integrator) struct PathQueue {
    pub(super) rays: PathRays,
    pub(super) states: Vec<PathState>,
}

/// A contribution to a sample that is added if its shadow rays are unoccluded.
pub(super) struct PendingDirect {
    pub(super) batch_index: u32,
    pub(super) radiance: Rgb,
    pub(super) is_direct: bool,
    /// True if the next shadow ray is another leg of the same light path.
    pub(super) has_more: bool,
    /// Number of the connection at its vertex, from 1; 0 is the light sample.
    pub(super) connection: u8,
    /// True if it is what is behind a shadow catcher, whose alpha is what the ray does not
    /// transmit.
    pub(super) is_caught: bool,
}

/// The shadow rays of a stage and their pending contributions.
#[derive(Default)]
pub(in crate::integrator) struct ShadowRays {
    pub(super) rays: PathRays,
    pub(super) pending: Vec<PendingDirect>,
}

/// The queue that a stage pushes shadow rays to.
pub(super) struct ShadowQueue<'w> {
    pub(super) shadow_rays: &'w mut ShadowRays,
    /// The media that each ray starts in, in scenes with surfaces that shadow rays may pass.
    pub(super) media: &'w mut Vec<MediumStack>,
}

/// The queues of a stage.
pub(super) struct StageQueues<'w> {
    pub(super) paths: &'w mut PathQueue,
    pub(super) next: &'w mut PathQueue,
    pub(super) shadow: ShadowQueue<'w>,
}

impl PathState {
    /// A path that starts at the camera.
    pub(super) fn new(sample: u32) -> Self {
        Self {
            batch_index: sample,
            throughput: Rgb::ONE,
            depth: 1,
            scatter_count: 0,
            redraws: 0,
            passthroughs: 0,
            total_reflections: 0,
            has_prev_vertex: false,
            chain: Chain::Other,
            eta_scale: 1.0,
        }
    }

    /// Returns true if emission found now has been scattered at most once.
    pub(super) fn is_direct(&self) -> bool {
        self.scatter_count <= 1
    }

    /// Returns true if a light sample taken at this vertex counts as direct light.
    pub(super) fn is_light_sample_direct(&self) -> bool {
        self.scatter_count == 0
    }
}

impl PathQueue {
    pub(super) fn clear(&mut self) {
        self.rays.clear();
        self.states.clear();
    }

    #[inline(always)]
    pub(super) fn push(&mut self, path: &Path) {
        self.rays.push(&path.ray);
        self.states.push(path.state);
    }

    #[inline(always)]
    pub(super) fn get(&self, index: usize) -> Path {
        Path { ray: self.rays.get(index), state: self.states[index] }
    }
}

impl ShadowRays {
    pub(super) fn clear(&mut self) {
        self.rays.clear();
        self.pending.clear();
    }

    #[inline(always)]
    pub(super) fn push(&mut self, ray: &PathRay, pending: PendingDirect) {
        self.rays.push(ray);
        self.pending.push(pending);
    }
}

impl PrevVertex {
    /// The empty record.
    pub(super) const NONE: Self = Self {
        pdf: 0.0,
        point: DVec3::ZERO,
        normal: DVec3::ZERO,
        id: NO_SPHERE,
        side: Side::Outside,
        is_two_sided: false,
        is_lambertian: false,
        lights: CategoryPmf::NONE,
    };

    #[inline(always)]
    pub(super) fn new(from: &LightSampleContext, pdf: f64, lights: CategoryPmf) -> Self {
        let LightSampleContext { hit, is_two_sided, is_lambertian } = *from;
        let SurfaceHit { id, point, normal, side, .. } = hit;
        Self { pdf, point, normal, id, side, is_two_sided, is_lambertian, lights }
    }

    /// Returns the shading point of the record; its hit distance is not kept.
    pub(super) fn light_sample_context(&self, spheres: &SphereSet) -> LightSampleContext {
        let Self { point, normal, id, side, is_two_sided, is_lambertian, .. } = *self;
        let radius = spheres.sphere(id).radius;
        LightSampleContext {
            hit: SurfaceHit { id, t: 0.0, point, normal, radius, side },
            is_two_sided,
            is_lambertian,
        }
    }
}
