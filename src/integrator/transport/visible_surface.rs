//! The first visible surface of a path, for AOVs.
//!
//! The tests mirror those of [`super::shade`] and do not affect the path.

use crate::color::Rgb;
use crate::geometry::{Side, SurfaceHit};
use crate::math::Hit;

use super::super::aov;
use super::super::trace::PathRecorder;
use super::batch::PathBatch;
use super::opacity;
use super::paths::Path;

impl<R: PathRecorder> PathBatch<'_, R> {
    /// Records the hit of a path's edge, if recording is enabled and the path comes straight from
    /// the camera, or by way of mirrors and smooth glass.
    pub(super) fn record_visible_surface(&mut self, path: &Path, hit: Hit) {
        if self.visible_surfaces.is_empty() {
            return;
        }
        if path.state.depth > 1 {
            return self.record_surface_behind(path, hit);
        }
        let scene = self.context.scene;
        let Some(hit) = scene.spheres().resolve_hit(&path.ray, hit) else { return };
        let surface = scene.sphere_material(hit.id);
        let media = self.media_of(&path.state);
        let opacity = surface.opacity(hit.id, hit.side, media);
        let throughput = path.state.throughput * media.transmittance(hit.t - path.ray.t_min);
        let emission = throughput * (surface.material.emission * opacity);
        let is_seen = opacity::passes_opacity_test(&path.state, self.sampler(&path.state), opacity)
            && !self.is_straight_boundary(path, &hit);
        let sees_through = is_seen && self.is_delta(path, &hit);
        let record = &mut self.visible_surfaces[path.state.batch_index as usize];
        aov::add_emission(record, emission);
        if is_seen {
            aov::record_surface(record, scene, &hit);
            record.sees_through = sees_through;
        } else {
            record.distance += hit.t as f32;
        }
    }

    /// Records what is seen in mirrors and through smooth glass, for denoising.
    fn record_surface_behind(&mut self, path: &Path, hit: Hit) {
        let index = path.state.batch_index as usize;
        if !self.visible_surfaces[index].sees_through {
            return;
        }
        let scene = self.context.scene;
        let Some(hit) = scene.spheres().resolve_hit(&path.ray, hit) else {
            // What is behind has no colour of its own.
            let record = &mut self.visible_surfaces[index];
            record.denoising_albedo = path.state.throughput.clamp(Rgb::ZERO, Rgb::ONE);
            record.sees_through = false;
            return;
        };
        let surface = scene.sphere_material(hit.id);
        let media = self.media_of(&path.state);
        let opacity = surface.opacity(hit.id, hit.side, media);
        let throughput = path.state.throughput * media.transmittance(hit.t - path.ray.t_min);
        let is_seen = opacity::passes_opacity_test(&path.state, self.sampler(&path.state), opacity)
            && !self.is_straight_boundary(path, &hit);
        if is_seen {
            let sees_through = self.is_delta(path, &hit);
            let record = &mut self.visible_surfaces[index];
            aov::record_surface_behind(record, scene, &hit, throughput);
            record.sees_through = sees_through;
        }
    }

    /// Returns true if the surface of a hit has only delta lobes.
    fn is_delta(&self, path: &Path, hit: &SurfaceHit) -> bool {
        let surface = self.context.scene.sphere_material(hit.id);
        let media = self.media_of(&path.state);
        let boundary =
            surface.medium(hit.id).map(|medium| media.boundary(medium, hit.side == Side::Outside));
        let eta = boundary.and_then(|boundary| boundary.eta).unwrap_or(1.0);
        surface.material.bsdf(surface.albedo, eta, self.integrator.hemisphere).is_delta()
    }

    /// Records that a camera path misses.
    pub(super) fn record_background(&mut self, path: &Path, radiance: Rgb) {
        if let Some(record) = self.visible_surfaces.get_mut(path.state.batch_index as usize) {
            aov::add_emission(record, path.state.throughput * radiance);
            record.distance = 0.0;
        }
    }

    /// Returns true if the hit is a dielectric boundary that the path passes in a straight line.
    fn is_straight_boundary(&self, path: &Path, hit: &SurfaceHit) -> bool {
        let surface = self.context.scene.sphere_material(hit.id);
        let entering = hit.side == Side::Outside;
        let media = self.media_of(&path.state);
        let boundary = surface.medium(hit.id).map(|medium| media.boundary(medium, entering));
        boundary.is_some_and(|boundary| surface.is_straight(&boundary))
    }
}
