//! Paths on their way, their rays side by side, and the shadow rays of a stage.

use crate::color::Rgb;
use crate::geometry::{PathRay, PathRays, Side, SphereSet, SurfaceHit};
use crate::light::LightSampleContext;
use crate::material::MediumStack;
use crate::math::{DVec3, NO_SPHERE};

/// No path has more edges, nor passes more hidden boundaries; the ones that would are counted and
/// reported.
pub(super) const MAX_PATH_EDGES: u32 = 10_000;

/// A path on its way.
pub(super) struct Path {
    pub(super) ray: PathRay,
    pub(super) state: PathState,
}

/// All but the ray of a path.
#[derive(Clone, Copy)]
pub(super) struct PathState {
    /// Which sample of the batch it belongs to.
    pub(super) batch_index: u32,
    pub(super) throughput: Rgb,
    /// Edges, the ray's own included.
    pub(super) depth: u32,
    /// Vertices so far that scattered light in more than one direction.
    pub(super) scatter_count: u32,
    pub(super) redraws: u32,
    /// Hidden boundaries that it went straight through.
    pub(super) passthroughs: u32,
    /// Whether the ray was drawn from a density, which [`PathBatch::pdf`](super::batch::PathBatch::pdf) tells.
    pub(super) has_prev_vertex: bool,
    /// Squared index of refraction where the path is now: what refraction took from `throughput`
    /// and will give back.
    pub(super) eta_scale: f32,
}

/// A direction drawn from a density at a point: for weighting what the ray meets against light
/// sampling.
#[derive(Clone, Copy)]
pub(in crate::integrator) struct PrevVertex {
    pub(super) pdf: f64,
    pub(super) point: DVec3,
    pub(super) normal: DVec3,
    pub(super) id: u32,
    pub(super) side: Side,
    pub(super) is_two_sided: bool,
}

/// The paths of a stage.
#[derive(Default)]
pub(in crate::integrator) struct PathQueue {
    pub(super) rays: PathRays,
    pub(super) states: Vec<PathState>,
}

/// What a sample gains if nothing is in the way of a shadow ray.
pub(super) struct PendingDirect {
    pub(super) batch_index: u32,
    pub(super) radiance: Rgb,
    pub(super) is_direct: bool,
}

/// The shadow rays of a stage, and what each is worth.
#[derive(Default)]
pub(in crate::integrator) struct ShadowRays {
    pub(super) rays: PathRays,
    pub(super) pending: Vec<PendingDirect>,
}

/// The shadow rays of a stage.
pub(super) struct ShadowQueue<'w> {
    pub(super) shadow_rays: &'w mut ShadowRays,
    /// The media that each starts in, where something is not opaque.
    pub(super) media: &'w mut Vec<MediumStack>,
}

impl PathState {
    /// At the camera.
    pub(super) fn new(sample: u32) -> Self {
        Self {
            batch_index: sample,
            throughput: Rgb::ONE,
            depth: 1,
            scatter_count: 0,
            redraws: 0,
            passthroughs: 0,
            has_prev_vertex: false,
            eta_scale: 1.0,
        }
    }

    /// Whether light that the path comes across has been scattered once at most.
    pub(super) fn is_direct(&self) -> bool {
        self.scatter_count <= 1
    }

    /// The same of light that is aimed at, and scattered once more here.
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
    pub(super) fn push(&mut self, ray: &PathRay, gain: PendingDirect) {
        self.rays.push(ray);
        self.pending.push(gain);
    }
}

impl PrevVertex {
    /// None yet.
    pub(super) const NONE: Self = Self {
        pdf: 0.0,
        point: DVec3::ZERO,
        normal: DVec3::ZERO,
        id: NO_SPHERE,
        side: Side::Outside,
        is_two_sided: false,
    };

    pub(super) fn new(from: &LightSampleContext, pdf: f64) -> Self {
        let LightSampleContext { hit: SurfaceHit { id, point, normal, side, .. }, is_two_sided } =
            *from;
        Self { pdf, point, normal, id, side, is_two_sided }
    }

    /// Where it was drawn; how far the way there was is forgotten.
    pub(super) fn light_sample_context(&self, spheres: &SphereSet) -> LightSampleContext {
        let Self { point, normal, id, side, is_two_sided, .. } = *self;
        let radius = spheres.sphere(id).radius;
        LightSampleContext {
            hit: SurfaceHit { id, t: 0.0, point, normal, radius, side },
            is_two_sided,
        }
    }
}
