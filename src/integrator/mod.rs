//! How much light? Light transport over batches of paths, one file per estimator.
//!
//! A batch of samples goes through the stages together: camera rays, closest hits, surfaces, light
//! samples, occlusion, scattering. So one call of the intersector serves many rays, and each stage
//! is a plain loop. What comes back for a sample depends on its address alone, never on its batch.

mod ambient_occlusion;
mod camera_rays;
mod dimension;
mod direct;
mod first_hits;
mod normals;
mod paper;
mod path;
mod raycast;
mod seen;
mod trace;
mod transport;

pub use trace::{Added, End, Step, Trace};

use crate::accel::Accel;
use crate::color::{Radiance, Seen};
use crate::geometry::PathRays;
use crate::material::Media;
use crate::math::{Hit, Isa, Ray};
use crate::sampling::Sampler;
use crate::scene::settings::Integrator as Kind;
use crate::scene::{Scene, Shot};
use crate::task::Cancel;

use ambient_occlusion::AmbientOcclusion;
use normals::Normals;
use raycast::Raycast;

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

/// What there is to be seen.
#[derive(Clone, Copy)]
pub struct World<'a> {
    /// The scene as the picture has it.
    pub shot: &'a Shot,
    /// The scene.
    pub scene: &'a Scene,
    /// An intersector over the scene's spheres.
    pub accel: &'a dyn Accel,
    /// Set from elsewhere to stop early; what is estimated then is to be thrown away.
    pub cancel: &'a Cancel,
}

impl<'a> World<'a> {
    /// A shot, with an intersector over its spheres.
    pub fn new(shot: &'a Shot, accel: &'a dyn Accel, cancel: &'a Cancel) -> Self {
        Self { shot, scene: shot.scene(), accel, cancel }
    }
}

/// One sample of one pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SampleAddress {
    /// Column in the full picture.
    pub x: u32,
    /// Row in the full picture, from the top.
    pub y: u32,
    /// Index of the sample.
    pub sample: u32,
}

/// What happened on the way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Rays traced, shadow rays included.
    pub rays: u64,
    /// Paths that were inside more dielectric spheres than can be remembered.
    pub media_overflows: u64,
    /// Paths cut off at the hard limit on their length.
    pub cut_off: u64,
}

/// Memory that one thread uses again for every batch.
#[derive(Default)]
pub struct Workspace {
    isa: Isa,
    paths: transport::Paths,
    next_paths: transport::Paths,
    start: transport::StartBlock,
    block: transport::Block,
    shadows: transport::Shadows,
    samplers: Vec<Sampler>,
    drawn: Vec<transport::Drawn>,
    /// The media that each sample's path is in, where something is a dielectric.
    media: Vec<Media>,
    /// The media that shadow rays start in, where something is not opaque.
    shadow_media: Vec<Media>,
    rays: Vec<Ray>,
    hits: Vec<Hit>,
    blocked: Vec<bool>,
    /// The share of the light of each shadow ray that arrives.
    passed: Vec<f32>,
    records_seen: bool,
    /// What each sample sees first, where that is recorded.
    seen: Vec<Seen>,
}

impl Workspace {
    /// With a choice of the instructions that vectors are computed with, which changes no bit.
    pub fn with(isa: Isa) -> Self {
        Self { isa, ..Self::default() }
    }

    /// Whether estimates from here on record what each sample sees first.
    pub fn record_seen(&mut self, wanted: bool) {
        self.records_seen = wanted;
    }

    /// What each sample of the last estimate sees first; empty where that is not recorded.
    pub fn seen(&self) -> &[Seen] {
        &self.seen
    }

    /// Forgets the records of the last estimate, and makes room for so many where they are wanted.
    fn begin_seen(&mut self, samples: usize) {
        self.seen.clear();
        self.seen.resize(if self.records_seen { samples } else { 0 }, Seen::NOTHING);
    }
}

impl Tally {
    /// Counts the rays that a backend was asked with. A ray that is not valid, or whose interval is
    /// empty, is not traced and does not count.
    fn count(&mut self, rays: &[Ray]) {
        let is_traced = |ray: &&Ray| ray.is_valid() && ray.t_min < ray.t_max;
        self.rays += rays.iter().filter(is_traced).count() as u64;
    }

    /// The same for the rays of paths.
    fn count_of(&mut self, rays: &PathRays, isa: Isa) {
        self.rays += rays.count_traced(isa) as u64;
    }
}

impl std::ops::Add for Tally {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            rays: self.rays + other.rays,
            media_overflows: self.media_overflows + other.media_overflows,
            cut_off: self.cut_off + other.cut_off,
        }
    }
}

/// The estimator that a shot asks for.
pub fn of_shot(shot: &Shot) -> Box<dyn Integrator> {
    let render = shot.render();
    match render.integrator {
        Kind::Path => Box::new(path::new(render)),
        Kind::Direct => Box::new(direct::new(render)),
        Kind::Paper(paper) => Box::new(paper::new(&paper, render)),
        Kind::AmbientOcclusion { distance } => {
            let distance = distance.unwrap_or(f64::INFINITY);
            Box::new(AmbientOcclusion { distance })
        }
        Kind::Normals => Box::new(Normals::new(render.samples_per_pixel)),
        Kind::Raycast { shadows } => Box::new(Raycast::new(shadows, render.samples_per_pixel)),
    }
}
