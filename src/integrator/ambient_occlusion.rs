//! `integrator = "ambient-occlusion"`: how open each point is. The cosine-weighted share of the
//! directions above it in which nothing is nearer than a distance (Landis 2002, "Production-Ready
//! Global Illumination").
//!
//! It is the picture of white matt surfaces, whatever they are made of, under a sky of radiance 1
//! that shines through all that is farther away, with light scattered once. So a camera ray that
//! meets nothing is white as well.

use crate::color::{Radiance, Rgb};
use crate::geometry::{PathRay, SurfaceHit};
use crate::math::{Frame, NO_SPHERE};
use crate::sampling::Hemisphere;
use crate::scene::Shot;

use super::camera_rays::{Strata, sampler_of};
use super::dimension::Vertex;
use super::estimate::Integrator;
use super::first_hits::first_hits;
use super::sample::{SampleAddress, Tally};
use super::workspace::Workspace;
use super::world::World;

/// Ambient occlusion by what is nearer than `distance`.
pub(super) struct AmbientOcclusion {
    pub(super) distance: f64,
}

impl Integrator for AmbientOcclusion {
    fn estimate(
        &self,
        world: World<'_>,
        samples: &[SampleAddress],
        radiance: &mut [Radiance],
        workspace: &mut Workspace,
    ) -> Tally {
        let World { shot, scene, accel, .. } = world;
        let mut tally = Tally::default();
        let found = first_hits(world, Strata::NONE, samples, workspace, &mut tally);

        // One ray for each sample whose own sphere does not stand in the way already.
        let Workspace { rays, blocked, .. } = workspace;
        rays.clear();
        let mut asked = Vec::with_capacity(samples.len());
        for ((index, first), &address) in found.iter().enumerate().zip(samples) {
            let ray = first.surface.map(|surface| self.ray(shot, address, &surface));
            let (direct, alpha) = match ray {
                Some(_) => (Rgb::ZERO, 1.0),
                None if scene.shows_background() => (Rgb::ONE, 0.0),
                None => (Rgb::ZERO, 0.0),
            };
            radiance[index] = Radiance { direct, indirect: Rgb::ZERO, alpha };
            if let Some(Some(ray)) = ray {
                rays.push(scene.spheres().ask(&ray));
                asked.push(index);
            }
        }
        blocked.clear();
        blocked.resize(rays.len(), false);
        accel.occluded(rays, blocked);
        tally.count(rays);
        for (index, _) in asked.into_iter().zip(&*blocked).filter(|(_, blocked)| !**blocked) {
            radiance[index].direct = Rgb::ONE;
        }
        tally
    }
}

impl AmbientOcclusion {
    /// A ray into the hemisphere above a point; `None` where its own sphere blocks it.
    fn ray(&self, shot: &Shot, address: SampleAddress, hit: &SurfaceHit) -> Option<PathRay> {
        let u = sampler_of(shot, Strata::NONE, address).get_2d(Vertex::at(1).towards_lamp());
        let direction = Frame::around(hit.facing_normal()).to_world(Hemisphere::Cosine.sample(u));
        hit.leave_towards(direction.normalize(), self.distance, NO_SPHERE)
    }
}
