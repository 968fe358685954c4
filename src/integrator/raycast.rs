//! `integrator = "raycast"`: ray casting, the paper's starting point (its section 1.1). One ray
//! finds the closest object, which is shaded from its material and the emitters without tracing
//! further; by default not even shadow rays. Mirrors and glass, which need more rays, stay black.
//!
//! Each emitter is treated as a light at its centre that delivers `L pi (R / d)^2` to a surface
//! facing it. This is exact for a diffuse surface that sees the whole emitter, so the picture is
//! free of noise.

use std::f64::consts::PI;

use crate::color::{PathRadiance, Rgb};
use crate::geometry::{PathRay, SurfaceHit};
use crate::light::Emitter;
use crate::material::Bsdf;
use crate::math::{DVec3, Frame};
use crate::sampling::Hemisphere;
use crate::scene::Scene;

use super::aov;
use super::camera_rays::Strata;
use super::context::RenderContext;
use super::estimate::Integrator;
use super::primary_hits::{PrimaryHit, noise_free_strata, trace_primary_rays};
use super::sample::{RenderStats, SampleAddress};
use super::workspace::Workspace;

/// The ray casting integrator.
pub(super) struct Raycast {
    shadows: bool,
    strata: Strata,
}

impl Raycast {
    /// With one sample per pixel, the ray goes through the pixel's centre.
    pub(super) fn new(shadows: bool, samples_per_pixel: u32) -> Self {
        Self { shadows, strata: noise_free_strata(samples_per_pixel) }
    }
}

/// Light from one emitter, and its shadow ray.
struct DirectLight {
    radiance: Rgb,
    /// `None` where the surface itself blocks the light.
    shadow_ray: Option<PathRay>,
}

impl Integrator for Raycast {
    fn estimate(
        &self,
        context: RenderContext<'_>,
        samples: &[SampleAddress],
        radiance: &mut [PathRadiance],
        workspace: &mut Workspace,
    ) -> RenderStats {
        let RenderContext { prepared, scene, accel, .. } = context;
        let spheres = scene.spheres();
        let mut stats = RenderStats::default();
        let primary_hits = trace_primary_rays(context, self.strata, samples, workspace, &mut stats);
        let Workspace { rays, occluded, visible_surfaces, .. } = workspace;

        for (index, PrimaryHit { ray, hit: surface }) in primary_hits.into_iter().enumerate() {
            let radiance = &mut radiance[index];
            let mut record_emission = |light| {
                visible_surfaces.get_mut(index).map(|record| aov::add_emission(record, light))
            };
            let Some(surface) = surface else {
                *radiance = scene.camera_background(ray.direction);
                record_emission(radiance.direct);
                continue;
            };
            let mut light = scene.sphere_material(surface.id).material.emission;
            record_emission(light);
            let emitters = prepared.lights().emitters().iter();
            let mut direct_lights: Vec<DirectLight> = emitters
                .filter_map(|emitter| shade_light(scene, &surface, ray.direction, emitter))
                .collect();
            if self.shadows {
                direct_lights.retain(|direct_light| direct_light.shadow_ray.is_some());
                rays.clear();
                rays.extend(
                    direct_lights
                        .iter()
                        .filter_map(|direct_light| direct_light.shadow_ray)
                        .map(|ray| spheres.to_query(&ray)),
                );
                occluded.clear();
                occluded.resize(rays.len(), false);
                accel.occluded(rays, occluded);
                stats.count_rays(rays);
                let mut results = occluded.iter();
                direct_lights.retain(|_| results.next() == Some(&false));
            }
            light += direct_lights.iter().map(|direct_light| direct_light.radiance).sum::<Rgb>();
            *radiance = PathRadiance { direct: light, indirect: Rgb::ZERO, alpha: 1.0 };
        }
        stats
    }
}

/// Computes the light that a surface reflects towards the camera from one emitter.
fn shade_light(
    scene: &Scene,
    hit: &SurfaceHit,
    direction: DVec3,
    emitter: &Emitter,
) -> Option<DirectLight> {
    let sphere = scene.spheres().sphere(emitter.id);
    let to_center = sphere.center - hit.point;
    let distance = to_center.length();
    if emitter.id == hit.id || distance <= sphere.radius {
        return None;
    }
    let wi = to_center / distance;
    let surface = scene.sphere_material(hit.id);
    let bsdf: Bsdf = surface.material.bsdf(surface.albedo, 1.0, Hemisphere::Cosine);
    let frame = Frame::from_z(hit.facing_normal());
    let wi_local = frame.to_local(wi);
    let f = bsdf.eval(frame.to_local(-direction), wi_local);
    if f.max_element() <= 0.0 {
        return None;
    }
    let ray = hit.spawn_shadow_ray(wi, distance - sphere.radius, emitter.id);
    let irradiance = PI * (sphere.radius / distance).powi(2) * wi_local.z;
    let light = f * emitter.emission * irradiance as f32;
    Some(DirectLight { radiance: light, shadow_ray: ray })
}
