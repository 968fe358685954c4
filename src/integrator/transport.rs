//! Path tracing, stage by stage over a batch of paths.
//!
//! The recursion of the rendering equation, written as a loop: a path carries its `throughput`, the
//! product of `f cos / pdf` so far, and adds `throughput x emission` to its sample wherever it meets
//! light. Both [`super::path`] and [`super::paper`] are this loop with different choices.

use crate::color::{Radiance, Rgb};
use crate::geometry::{PathRay, Side, SurfaceHit};
use crate::material::{Bsdf, BsdfSample, Lobe, Media};
use crate::math::{DVec3, Frame, Hit};
use crate::sampling::{Hemisphere, Sampler, power_heuristic};
use crate::scene::description::{Miss, Stop};
use crate::scene::{Scene, Surface};

use super::camera_rays::{Strata, camera_ray, sampler_of};
use super::dimension::{self, Vertex};
use super::{Integrator, SampleAddress, Tally, Workspace, World};

/// Paths shorter than this many edges are never ended by roulette.
const ROULETTE_FROM: u32 = 4;
/// Longer paths are ended with at least 5 % probability, so that a closed mirror ends too.
const CERTAIN_UNTIL: u32 = 64;
/// No path has more edges, nor passes more hidden boundaries; the ones that would are counted and
/// reported.
const LONGEST: u32 = 10_000;
/// How often a camera ray that met nothing is drawn again where the scene asks for that.
const MOST_REDRAWS: u32 = 1000;

/// Path tracing with its choices.
pub(super) struct Transport {
    pub(super) lamps: FindLamps,
    pub(super) hemisphere: Hemisphere,
    pub(super) stop: Stop,
    pub(super) miss: Miss,
    pub(super) strata: Strata,
    /// The longest path, in edges.
    pub(super) max_depth: u32,
}

/// How lamps are found.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum FindLamps {
    /// Only when a path happens to meet one.
    ByChance,
    /// Also by a shadow ray from every vertex, weighted against chance.
    ByNextEvent,
}

/// A path on its way.
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
    media: Media,
    /// Squared index of refraction where the path is now: what refraction took from `throughput`
    /// and will give back.
    index_squared: f32,
}

/// A direction drawn from a density at a point.
#[derive(Clone, Copy)]
struct Drawn {
    at: SurfaceHit,
    pdf: f64,
}

/// A shadow ray, and what its sample gains if nothing is in its way.
pub(super) struct Shadow {
    sample: u32,
    ray: PathRay,
    light: Rgb,
    is_direct: bool,
}

impl Integrator for Transport {
    fn estimate(
        &self,
        world: World<'_>,
        samples: &[SampleAddress],
        radiance: &mut [Radiance],
        workspace: &mut Workspace,
    ) -> Tally {
        radiance.fill(Radiance::default());
        workspace.paths.clear();
        let starts = samples.iter().enumerate();
        workspace.paths.extend(starts.map(|(i, &address)| self.start(world.scene, i, address)));
        let mut batch =
            Batch { transport: self, world, samples, radiance, tally: Tally::default() };
        while !workspace.paths.is_empty() && !world.cancel.is_cancelled() {
            batch.advance(workspace);
        }
        batch.tally
    }
}

impl Transport {
    fn start(&self, scene: &Scene, sample: usize, address: SampleAddress) -> Path {
        let sampler = sampler_of(scene, address);
        let ray = camera_ray(scene, self.strata, address, sampler.get_2d(dimension::PIXEL));
        Path {
            sample: sample as u32,
            sampler,
            ray,
            throughput: Rgb::ONE,
            depth: 1,
            scatterings: 0,
            redraws: 0,
            passes: 0,
            drawn: None,
            media: scene.media_at(ray.at(ray.t_min)),
            index_squared: 1.0,
        }
    }

    /// Whether a path that has just scattered goes on, with its throughput made up for that.
    fn survives(&self, path: &mut Path, vertex: Vertex) -> bool {
        match self.stop {
            Stop::Depth => path.throughput.max_element() > 0.0,
            Stop::Threshold(threshold) => f64::from(path.throughput.max_element()) >= threshold,
            Stop::Roulette => {
                if path.depth < ROULETTE_FROM {
                    return path.throughput.max_element() > 0.0;
                }
                let most = if path.depth < CERTAIN_UNTIL { 1.0 } else { 0.95 };
                let weight = path.throughput.max_element() * path.index_squared;
                let survival = weight.min(most);
                path.throughput /= survival.max(f32::MIN_POSITIVE);
                path.sampler.get(vertex.roulette()) < f64::from(survival)
            }
        }
    }
}

/// The samples that are estimated together.
struct Batch<'a> {
    transport: &'a Transport,
    world: World<'a>,
    samples: &'a [SampleAddress],
    radiance: &'a mut [Radiance],
    tally: Tally,
}

impl Batch<'_> {
    /// One edge for every path: closest hits, shading, shadow rays. Paths that end are dropped, the
    /// others keep their order.
    fn advance(&mut self, workspace: &mut Workspace) {
        let Workspace { paths, shadows, rays, hits, blocked } = workspace;
        let spheres = self.world.scene.spheres();

        // Ask for the closest hits.
        rays.clear();
        rays.extend(paths.iter().map(|path| spheres.ask(&path.ray)));
        hits.clear();
        hits.resize(rays.len(), Hit::MISS);
        self.world.accel.closest(rays, hits);
        self.tally.rays += rays.len() as u64;

        // Shade: gather emission, aim at a lamp, scatter.
        shadows.clear();
        let mut answers = hits.iter();
        paths.retain_mut(|path| {
            let hit = answers.next().copied().unwrap_or(Hit::MISS);
            match spheres.answer(&path.ray, hit) {
                Some(surface) => self.shade(path, &surface, shadows),
                None => self.miss(path),
            }
        });

        // Ask for the shadows.
        rays.clear();
        rays.extend(shadows.iter().map(|shadow| spheres.ask(&shadow.ray)));
        blocked.clear();
        blocked.resize(rays.len(), false);
        self.world.accel.occluded(rays, blocked);
        self.tally.rays += rays.len() as u64;
        for (shadow, _) in shadows.iter().zip(blocked).filter(|(_, blocked)| !**blocked) {
            self.add(shadow.sample, shadow.light, shadow.is_direct);
        }
    }

    /// A path that meets nothing: it sees the background. Returns whether it goes on.
    fn miss(&mut self, path: &mut Path) -> bool {
        let redraws = self.transport.miss == Miss::Redraw && path.depth == 1;
        if redraws && path.redraws < MOST_REDRAWS {
            path.redraws += 1;
            let u = path.sampler.get_2d(dimension::redraw(path.redraws));
            let address = self.samples[path.sample as usize];
            path.ray = camera_ray(self.world.scene, self.transport.strata, address, u);
            path.media = self.world.scene.media_at(path.ray.at(path.ray.t_min));
            return true;
        }
        let light = path.throughput * self.world.scene.background();
        self.add(path.sample, light, path.scatterings <= 1);
        false
    }

    /// A path that meets a surface. Returns whether it goes on.
    fn shade(&mut self, path: &mut Path, hit: &SurfaceHit, shadows: &mut Vec<Shadow>) -> bool {
        let scene = self.world.scene;
        let surface = scene.surface(hit.id);
        self.gather_emission(path, hit, &surface);

        // Straight through where a dielectric's boundary lies hidden in another one.
        let boundary =
            surface.medium(hit.id).map(|m| path.media.meet(m, hit.side == Side::Outside));
        let eta = boundary.map_or(Some(1.0), |boundary| boundary.eta);
        let beyond = boundary.map_or(path.media, |boundary| boundary.beyond);
        let Some(eta) = eta else { return self.pass_through(path, hit, beyond) };

        // Is another edge allowed?
        if path.depth >= self.transport.max_depth {
            return false;
        }
        if path.depth >= LONGEST {
            self.tally.cut_off += 1;
            return false;
        }

        // Aim at a lamp, then scatter.
        let bsdf = surface.material.bsdf(surface.albedo, eta, self.transport.hemisphere);
        let frame = Frame::around(hit.facing_normal());
        let vertex = Vertex::at(path.depth);
        let wo = frame.to_local(-path.ray.direction);
        if self.transport.lamps == FindLamps::ByNextEvent && !bsdf.is_delta() {
            shadows.extend(aim_at_lamp(scene, path, hit, &bsdf, &frame, wo));
        }
        let [lobe, direction] = [vertex.lobe(), vertex.direction()];
        let u = path.sampler.get_2d(direction);
        let Some(sample) = bsdf.sample(wo, path.sampler.get(lobe), u) else { return false };
        self.scatter(path, hit, &sample, frame.to_world(sample.wi), beyond)
            && self.transport.survives(path, vertex)
            && {
                path.depth += 1;
                true
            }
    }

    /// Adds what a surface sends out by itself.
    fn gather_emission(&mut self, path: &Path, hit: &SurfaceHit, surface: &Surface<'_>) {
        if !surface.material.is_emissive() {
            return;
        }
        let weight = match (self.transport.lamps, path.drawn) {
            (FindLamps::ByNextEvent, Some(Drawn { at, pdf })) => {
                let scene = self.world.scene;
                let aimed = scene.lights().pdf(scene.spheres(), &at, hit.id, path.ray.direction);
                power_heuristic(pdf, aimed) as f32
            }
            _ => 1.0,
        };
        let light = path.throughput * surface.material.emission * weight;
        self.add(path.sample, light, path.scatterings <= 1);
    }

    /// Goes on in the same direction on the other side of a surface.
    fn pass_through(&mut self, path: &mut Path, hit: &SurfaceHit, beyond: Media) -> bool {
        self.enter(path, beyond);
        path.drawn = None;
        path.passes += 1;
        if path.passes >= LONGEST {
            self.tally.cut_off += 1;
            return false;
        }
        hit.leave(path.ray.direction).is_some_and(|ray| {
            path.ray = ray;
            true
        })
    }

    /// Turns the path into the sampled direction.
    fn scatter(
        &mut self,
        path: &mut Path,
        hit: &SurfaceHit,
        sample: &BsdfSample,
        direction: DVec3,
        beyond: Media,
    ) -> bool {
        let Some(ray) = hit.leave(direction.normalize()) else { return false };
        path.ray = ray;
        path.throughput *= sample.weight;
        path.index_squared *= (sample.eta * sample.eta) as f32;
        if sample.lobe == Lobe::Delta {
            path.drawn = None;
        } else {
            path.drawn = Some(Drawn { at: *hit, pdf: sample.pdf });
            path.scatterings += 1;
        }
        if sample.wi.z < 0.0 {
            self.enter(path, beyond);
        }
        true
    }

    fn enter(&mut self, path: &mut Path, media: Media) {
        self.tally.media_overflows += u64::from(media.overflowed() && !path.media.overflowed());
        path.media = media;
    }

    fn add(&mut self, sample: u32, light: Rgb, is_direct: bool) {
        let radiance = &mut self.radiance[sample as usize];
        let layer = if is_direct { &mut radiance.direct } else { &mut radiance.indirect };
        *layer += light;
    }
}

/// The shadow ray from a vertex to a sampled lamp, if it can bring any light.
fn aim_at_lamp(
    scene: &Scene,
    path: &Path,
    hit: &SurfaceHit,
    bsdf: &Bsdf,
    frame: &Frame,
    wo: DVec3,
) -> Option<Shadow> {
    let vertex = Vertex::at(path.depth);
    let choose = path.sampler.get(vertex.lamp());
    let u = path.sampler.get_2d(vertex.towards_lamp());
    let aim = scene.lights().sample(scene.spheres(), hit, choose, u)?;
    let wi = frame.to_local(aim.direction);
    let f = bsdf.eval(wo, wi);
    if f.max_element() <= 0.0 {
        return None;
    }
    let ray = hit.leave_towards(aim.direction, aim.distance, aim.lamp.id)?;
    let weight = power_heuristic(aim.pdf, bsdf.pdf(wo, wi));
    let light = path.throughput * f * aim.lamp.emission * (weight * wi.z / aim.pdf) as f32;
    Some(Shadow { sample: path.sample, ray, light, is_direct: path.scatterings == 0 })
}
