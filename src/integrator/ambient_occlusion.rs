//! `integrator = "ambient-occlusion"`: the cosine-weighted fraction of the hemisphere above each
//! point that is unoccluded within a maximum distance (Landis 2002, "Production-Ready Global
//! Illumination").
//!
//! The picture equals single scattering from white diffuse surfaces, whatever their materials,
//! under a sky of radiance 1 that is visible through everything beyond that distance. A camera ray
//! that misses is therefore white as well.

use crate::color::{PathRadiance, Rgb};
use crate::geometry::{PathRay, SurfaceHit};
use crate::math::{Frame, NO_SPHERE};
use crate::sampling::Hemisphere;
use crate::scene::PreparedScene;

use super::camera_rays::{Strata, sampler_for};
use super::context::RenderContext;
use super::dimension::VertexDimensions;
use super::estimate::Integrator;
use super::primary_hits::trace_primary_rays;
use super::sample::{RenderStats, SampleAddress};
use super::workspace::Workspace;

/// Ambient occlusion by surfaces nearer than `distance`.
pub(super) struct AmbientOcclusion {
    pub(super) distance: f64,
}

impl Integrator for AmbientOcclusion {
    fn estimate(
        &self,
        context: RenderContext<'_>,
        samples: &[SampleAddress],
        radiance: &mut [PathRadiance],
        workspace: &mut Workspace,
    ) -> RenderStats {
        let RenderContext { prepared, scene, accel, .. } = context;
        let mut stats = RenderStats::default();
        let primary_hits =
            trace_primary_rays(context, Strata::UNSTRATIFIED, samples, workspace, &mut stats);

        // One ray per sample, except where the sphere itself blocks it.
        let Workspace { rays, occluded, .. } = workspace;
        rays.clear();
        let mut ray_samples = Vec::with_capacity(samples.len());
        for ((index, primary), &address) in primary_hits.iter().enumerate().zip(samples) {
            let ray = primary.hit.map(|surface| self.occlusion_ray(prepared, address, &surface));
            let (direct, alpha) = match ray {
                Some(_) => (Rgb::ZERO, 1.0),
                None => (scene.seen_by_camera(Rgb::ONE), 0.0),
            };
            radiance[index] = PathRadiance { direct, indirect: Rgb::ZERO, alpha };
            if let Some(Some(ray)) = ray {
                rays.push(scene.spheres().to_query(&ray));
                ray_samples.push(index);
            }
        }
        occluded.clear();
        occluded.resize(rays.len(), false);
        accel.occluded(rays, occluded);
        stats.count_rays(rays);
        for (index, _) in
            ray_samples.into_iter().zip(&*occluded).filter(|(_, occluded)| !**occluded)
        {
            radiance[index].direct = Rgb::ONE;
        }
        stats
    }
}

impl AmbientOcclusion {
    /// Samples an occlusion ray above a hit point; `None` where the sphere itself blocks it.
    fn occlusion_ray(
        &self,
        prepared: &PreparedScene,
        address: SampleAddress,
        hit: &SurfaceHit,
    ) -> Option<PathRay> {
        let u = sampler_for(prepared, Strata::UNSTRATIFIED, address)
            .get_2d(VertexDimensions::at(1).light_direction());
        let direction = Frame::from_z(hit.facing_normal()).to_world(Hemisphere::Cosine.sample(u));
        hit.spawn_shadow_ray(direction.normalize(), self.distance, NO_SPHERE)
    }
}
