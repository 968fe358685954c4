//! Path tracing, stage by stage over a batch of paths.
//!
//! The recursion of the rendering equation, written as a loop: a path carries its `throughput`, the
//! product of `f cos / pdf` so far, and adds `throughput x emission` to its sample wherever it meets
//! light. [`super::path`], [`super::direct`] and [`super::paper`] are this loop with different choices.
//! A [`super::trace::Recorder`] may listen to it.
//!
//! The stages of one edge, a file each where they are more than a loop: camera rays ([`start`]),
//! closest hits ([`batch`]), surfaces and their emission ([`shade`]), light samples ([`aim`]), the
//! next directions and who goes on ([`scatter`]), occlusion ([`batch`]).

mod aim;
mod batch;
mod matt;
mod opacity;
mod scatter;
mod see;
mod shade;
mod start;

use std::mem::take;

use crate::color::{Radiance, Rgb};
use crate::geometry::{PathRay, PathRays, Side, SphereSet, SurfaceHit};
use crate::light::Receiver;
use crate::material::Media;
use crate::math::{DVec3, NO_SPHERE};
use crate::sampling::Hemisphere;
use crate::scene::settings::{Estimator, Miss, Stop};

use super::camera_rays::Strata;
use super::trace::{Silent, Step, Trace};
use super::{Integrator, SampleAddress, Tally, Workspace, World};

use batch::Batch;

pub(super) use matt::Block;
pub(super) use start::StartBlock;

/// No path has more edges, nor passes more hidden boundaries; the ones that would are counted and
/// reported.
const LONGEST: u32 = 10_000;

/// Path tracing with its choices.
pub(super) struct Transport {
    pub(super) estimator: Estimator,
    pub(super) hemisphere: Hemisphere,
    pub(super) stop: Stop,
    pub(super) miss: Miss,
    pub(super) strata: Strata,
    /// The longest path, in edges.
    pub(super) max_depth: u32,
    /// How often light may be scattered, mirrors and smooth glass not counted: 1 is direct light.
    pub(super) most_scatterings: u32,
    /// The most that one path may add to a channel of indirect light; biased.
    pub(super) clamp_indirect: Option<f32>,
}

/// A path on its way.
struct Path {
    ray: PathRay,
    state: State,
}

/// All but the ray of a path.
#[derive(Clone, Copy)]
struct State {
    /// Which sample of the batch it belongs to.
    sample: u32,
    throughput: Rgb,
    /// Edges, the ray's own included.
    depth: u32,
    /// Vertices so far that scattered light in more than one direction.
    scatterings: u32,
    redraws: u32,
    /// Hidden boundaries that it went straight through.
    passes: u32,
    /// Whether the ray was drawn from a density, which [`Batch::drawn`] tells.
    is_drawn: bool,
    /// Squared index of refraction where the path is now: what refraction took from `throughput`
    /// and will give back.
    index_squared: f32,
}

/// A direction drawn from a density at a point: for weighting what the ray meets against light
/// sampling.
#[derive(Clone, Copy)]
pub(super) struct Drawn {
    pdf: f64,
    point: DVec3,
    normal: DVec3,
    id: u32,
    side: Side,
    is_two_sided: bool,
}

/// The paths of a stage.
#[derive(Default)]
pub(super) struct Paths {
    rays: PathRays,
    states: Vec<State>,
}

/// What a sample gains if nothing is in the way of a shadow ray.
struct Gain {
    sample: u32,
    light: Rgb,
    is_direct: bool,
}

/// The shadow rays of a stage, and what each is worth.
#[derive(Default)]
pub(super) struct Shadows {
    rays: PathRays,
    gains: Vec<Gain>,
}

/// The shadow rays of a stage.
struct Aims<'w> {
    shadows: &'w mut Shadows,
    /// The media that each starts in, where something is not opaque.
    media: &'w mut Vec<Media>,
}

impl State {
    /// At the camera.
    fn new(sample: u32) -> Self {
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
    fn is_direct(&self) -> bool {
        self.scatterings <= 1
    }

    /// The same of light that is aimed at, and scattered once more here.
    fn aims_directly(&self) -> bool {
        self.scatterings == 0
    }
}

impl Paths {
    fn clear(&mut self) {
        self.rays.clear();
        self.states.clear();
    }

    #[inline(always)]
    fn push(&mut self, path: &Path) {
        self.rays.push(&path.ray);
        self.states.push(path.state);
    }

    #[inline(always)]
    fn get(&self, index: usize) -> Path {
        Path { ray: self.rays.get(index), state: self.states[index] }
    }
}

impl Shadows {
    fn clear(&mut self) {
        self.rays.clear();
        self.gains.clear();
    }

    #[inline(always)]
    fn push(&mut self, ray: &PathRay, gain: Gain) {
        self.rays.push(ray);
        self.gains.push(gain);
    }
}

impl Drawn {
    /// None yet.
    const NOTHING: Self = Self {
        pdf: 0.0,
        point: DVec3::ZERO,
        normal: DVec3::ZERO,
        id: NO_SPHERE,
        side: Side::Outside,
        is_two_sided: false,
    };

    fn new(from: &Receiver, pdf: f64) -> Self {
        let Receiver { hit: SurfaceHit { id, point, normal, side, .. }, is_two_sided } = *from;
        Self { pdf, point, normal, id, side, is_two_sided }
    }

    /// Where it was drawn; how far the way there was is forgotten.
    fn at(&self, spheres: &SphereSet) -> Receiver {
        let Self { point, normal, id, side, is_two_sided, .. } = *self;
        let radius = spheres.sphere(id).radius;
        Receiver { hit: SurfaceHit { id, t: 0.0, point, normal, radius, side }, is_two_sided }
    }
}

impl Integrator for Transport {
    fn estimate(
        &self,
        world: World<'_>,
        samples: &[SampleAddress],
        radiance: &mut [Radiance],
        workspace: &mut Workspace,
    ) -> Tally {
        let tally = Tally::default();
        let recorder = &mut Silent;
        workspace.begin_seen(samples.len());
        let Workspace { media, seen, samplers, drawn, .. } = workspace;
        let (media, seen, samplers, drawn) = (take(media), take(seen), take(samplers), take(drawn));
        let transport = self;
        Batch { transport, world, samples, radiance, media, seen, samplers, drawn, tally, recorder }
            .run(workspace)
    }

    fn trace(&self, world: World<'_>, address: SampleAddress) -> Option<Trace> {
        let mut steps: Vec<Step> = Vec::new();
        let mut radiance = [Radiance::default()];
        let batch = Batch {
            transport: self,
            world,
            samples: &[address],
            radiance: &mut radiance,
            media: Vec::new(),
            seen: Vec::new(),
            samplers: Vec::new(),
            drawn: Vec::new(),
            tally: Tally::default(),
            recorder: &mut steps,
        };
        let tally = batch.run(&mut Workspace::default());
        let [radiance] = radiance;
        Some(Trace { address, steps, radiance, tally })
    }
}
