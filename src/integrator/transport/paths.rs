//! Paths on their way, their rays side by side, and the shadow rays of a stage.

use crate::color::Rgb;
use crate::geometry::{PathRay, PathRays, Side, SphereSet, SurfaceHit};
use crate::light::Receiver;
use crate::material::Media;
use crate::math::{DVec3, NO_SPHERE};

/// No path has more edges, nor passes more hidden boundaries; the ones that would are counted and
/// reported.
pub(super) const LONGEST: u32 = 10_000;

/// A path on its way.
pub(super) struct Path {
    pub(super) ray: PathRay,
    pub(super) state: State,
}

/// All but the ray of a path.
#[derive(Clone, Copy)]
pub(super) struct State {
    /// Which sample of the batch it belongs to.
    pub(super) sample: u32,
    pub(super) throughput: Rgb,
    /// Edges, the ray's own included.
    pub(super) depth: u32,
    /// Vertices so far that scattered light in more than one direction.
    pub(super) scatterings: u32,
    pub(super) redraws: u32,
    /// Hidden boundaries that it went straight through.
    pub(super) passes: u32,
    /// Whether the ray was drawn from a density, which [`Batch::drawn`](super::batch::Batch::drawn) tells.
    pub(super) is_drawn: bool,
    /// Squared index of refraction where the path is now: what refraction took from `throughput`
    /// and will give back.
    pub(super) index_squared: f32,
}

/// A direction drawn from a density at a point: for weighting what the ray meets against light
/// sampling.
#[derive(Clone, Copy)]
pub(in crate::integrator) struct Drawn {
    pub(super) pdf: f64,
    pub(super) point: DVec3,
    pub(super) normal: DVec3,
    pub(super) id: u32,
    pub(super) side: Side,
    pub(super) is_two_sided: bool,
}

/// The paths of a stage.
#[derive(Default)]
pub(in crate::integrator) struct Paths {
    pub(super) rays: PathRays,
    pub(super) states: Vec<State>,
}

/// What a sample gains if nothing is in the way of a shadow ray.
pub(super) struct Gain {
    pub(super) sample: u32,
    pub(super) light: Rgb,
    pub(super) is_direct: bool,
}

/// The shadow rays of a stage, and what each is worth.
#[derive(Default)]
pub(in crate::integrator) struct Shadows {
    pub(super) rays: PathRays,
    pub(super) gains: Vec<Gain>,
}

/// The shadow rays of a stage.
pub(super) struct Aims<'w> {
    pub(super) shadows: &'w mut Shadows,
    /// The media that each starts in, where something is not opaque.
    pub(super) media: &'w mut Vec<Media>,
}

impl State {
    /// At the camera.
    pub(super) fn new(sample: u32) -> Self {
        Self {
            sample,
            throughput: Rgb::ONE,
            depth: 1,
            scatterings: 0,
            redraws: 0,
            passes: 0,
            is_drawn: false,
            index_squared: 1.0,
        }
    }

    /// Whether light that the path comes across has been scattered once at most.
    pub(super) fn is_direct(&self) -> bool {
        self.scatterings <= 1
    }

    /// The same of light that is aimed at, and scattered once more here.
    pub(super) fn aims_directly(&self) -> bool {
        self.scatterings == 0
    }
}

impl Paths {
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

impl Shadows {
    pub(super) fn clear(&mut self) {
        self.rays.clear();
        self.gains.clear();
    }

    #[inline(always)]
    pub(super) fn push(&mut self, ray: &PathRay, gain: Gain) {
        self.rays.push(ray);
        self.gains.push(gain);
    }
}

impl Drawn {
    /// None yet.
    pub(super) const NOTHING: Self = Self {
        pdf: 0.0,
        point: DVec3::ZERO,
        normal: DVec3::ZERO,
        id: NO_SPHERE,
        side: Side::Outside,
        is_two_sided: false,
    };

    pub(super) fn new(from: &Receiver, pdf: f64) -> Self {
        let Receiver { hit: SurfaceHit { id, point, normal, side, .. }, is_two_sided } = *from;
        Self { pdf, point, normal, id, side, is_two_sided }
    }

    /// Where it was drawn; how far the way there was is forgotten.
    pub(super) fn at(&self, spheres: &SphereSet) -> Receiver {
        let Self { point, normal, id, side, is_two_sided, .. } = *self;
        let radius = spheres.sphere(id).radius;
        Receiver { hit: SurfaceHit { id, t: 0.0, point, normal, radius, side }, is_two_sided }
    }
}
