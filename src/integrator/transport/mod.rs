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

use crate::color::{Radiance, Rgb};
use crate::geometry::{PathRay, Side, SphereSet, SurfaceHit};
use crate::light::Receiver;
use crate::material::Media;
use crate::math::DVec3;
use crate::sampling::{Hemisphere, Sampler};
use crate::scene::description::{Estimator, Miss, Stop};

use super::camera_rays::Strata;
use super::trace::{Silent, Step, Trace};
use super::{Integrator, SampleAddress, Tally, Workspace, World};

use batch::Batch;

pub(super) use matt::Block;

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
#[derive(Clone, Copy)]
pub(super) struct Path {
    /// Which sample of the batch it belongs to.
    sample: u32,
    sampler: Sampler,
    ray: PathRay,
    throughput: Rgb,
    /// Edges, the ray's own included.
    depth: u32,
    /// Vertices so far that scattered light in more than one direction.
    scatterings: u32,
    redraws: u32,
    /// Hidden boundaries that it went straight through.
    passes: u32,
    /// Where the ray was drawn from a density, for weighting it against light sampling.
    drawn: Option<Drawn>,
    /// Squared index of refraction where the path is now: what refraction took from `throughput`
    /// and will give back.
    index_squared: f32,
}

/// A direction drawn from a density at a point.
#[derive(Clone, Copy)]
struct Drawn {
    pdf: f64,
    point: DVec3,
    normal: DVec3,
    id: u32,
    side: Side,
    is_two_sided: bool,
}

/// A shadow ray, and what its sample gains if nothing is in its way.
pub(super) struct Shadow {
    sample: u32,
    ray: PathRay,
    light: Rgb,
    is_direct: bool,
}

/// The shadow rays of a stage.
struct Aims<'w> {
    shadows: &'w mut Vec<Shadow>,
    /// The media that each starts in, where something is not opaque.
    media: &'w mut Vec<Media>,
}

impl Drawn {
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
        let media = std::mem::take(&mut workspace.media);
        workspace.begin_seen(samples.len());
        let seen = std::mem::take(&mut workspace.seen);
        Batch { transport: self, world, samples, radiance, media, seen, tally, recorder }
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
            tally: Tally::default(),
            recorder: &mut steps,
        };
        let tally = batch.run(&mut Workspace::default());
        let [radiance] = radiance;
        Some(Trace { address, steps, radiance, tally })
    }
}
