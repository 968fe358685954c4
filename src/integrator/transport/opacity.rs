//! Shadow rays through surfaces that are there only with a probability, their opacity.
//!
//! A path decides at every such surface whether it is there. A shadow ray need not: it is walked
//! from surface to surface by repeated closest queries, and its light is multiplied with the
//! probability that nothing was there, which has the same mean and less noise. Both are weighted
//! against each other as ever: the probability is a factor of the light on its way, the same for a
//! direction that was aimed and for one that was found by chance.

use crate::color::Rgb;
use crate::fault::fault;
use crate::geometry::{PathRay, Side, SurfaceHit};
use crate::light::{LightSample, Receiver, Source};
use crate::material::Media;
use crate::math::{Hit, Ray};
use crate::sampling::Sampler;
use crate::scene::Scene;

use super::super::dimension;
use super::super::sample::Tally;
use super::super::world::World;
use super::paths::{Drawn, LONGEST, Path, Shadows};

/// Whether a path finds a surface there that is there with this probability.
pub(super) fn is_there(path: &Path, sampler: Sampler, presence: f32) -> bool {
    sampler.get(dimension::opacity(path.state.depth, path.state.passes)) < f64::from(presence)
}

/// Whether this is the far wall of a lamp whose near wall let the path in: light is aimed at the
/// near one alone.
pub(super) fn is_behind_a_lamp(scene: &Scene, drawn: Option<&Drawn>, hit: &SurfaceHit) -> bool {
    let is_within = |at: &Receiver| at.is_within(hit.id, &scene.spheres().sphere(hit.id));
    scene.has_opacity()
        && hit.side == Side::Inside
        && drawn.is_some_and(|drawn| !is_within(&drawn.at(scene.spheres())))
}

/// Walks all shadow rays to their ends; `passed` becomes the share of the light of each that arrives.
/// `media` are those that each starts in: light aimed at a lamp enters none, since a surface that is
/// there ends it.
pub(super) fn walk(
    world: World<'_>,
    shadows: &mut Shadows,
    media: &[Media],
    rays: &mut Vec<Ray>,
    hits: &mut Vec<Hit>,
    passed: &mut Vec<f32>,
) -> Tally {
    let spheres = world.scene.spheres();
    let mut tally = Tally::default();
    passed.clear();
    passed.resize(shadows.gains.len(), 1.0);
    let mut active: Vec<usize> = (0..shadows.gains.len()).collect();
    for _ in 0..LONGEST {
        // What is estimated after a request to stop is not used.
        if active.is_empty() || world.cancel.is_cancelled() {
            return tally;
        }
        rays.clear();
        rays.extend(active.iter().map(|&i| spheres.ask(&shadows.rays.get(i))));
        hits.clear();
        hits.resize(rays.len(), Hit::MISS);
        world.accel.closest(rays, hits);
        tally.count(rays);
        let mut answers = hits.iter();
        active.retain(|&i| {
            let hit = answers.next().copied().unwrap_or(Hit::MISS);
            let hit = spheres.answer(&shadows.rays.get(i), hit);
            let Some(hit) = hit else { return false };
            let (share, ray) = pass(world.scene, &shadows.rays.get(i), &media[i], &hit);
            passed[i] *= share;
            let behind = ray.filter(|_| passed[i] > 0.0);
            behind.inspect(|ray| shadows.rays.set(i, ray)).is_some()
        });
    }
    tally.cut_off += active.len() as u64;
    active.into_iter().for_each(|i| passed[i] = 0.0);
    tally
}

/// The share of the light that a surface lets through, and the ray behind it, if there is more to ask.
fn pass(scene: &Scene, ray: &PathRay, media: &Media, hit: &SurfaceHit) -> (f32, Option<PathRay>) {
    let (lamp, left) = (ray.aims_at, ray.t_max - hit.t);
    if hit.id == lamp || left <= 0.0 {
        return (1.0, None);
    }
    let presence = scene.surface(hit.id).presence(hit.id, hit.side, media);
    let behind = hit.leave_up_to(ray.direction, left, lamp);
    if presence >= 1.0 || behind.is_none() {
        return (0.0, None);
    }
    (if fault!(ShadowsOfNothing) { presence } else { 1.0 - presence }, behind)
}

/// The radiance that a light sends to a receiver in `media`, its own opacity included. Only a lamp of
/// glass seen from inside needs care: it is there if the path has entered it.
pub(super) fn radiance(
    scene: &Scene,
    aim: &LightSample,
    receiver: &Receiver,
    media: &Media,
) -> Rgb {
    match aim.source {
        Source::Lamp(id)
            if scene.has_opacity() && receiver.is_within(id, &scene.spheres().sphere(id)) =>
        {
            let surface = scene.surface(id);
            surface.material.emission * surface.presence(id, Side::Inside, media)
        }
        _ => aim.radiance,
    }
}
