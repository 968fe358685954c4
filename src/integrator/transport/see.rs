//! What a path sees before anything has turned it, for the layers that show that.
//!
//! It asks the same questions as [`super::shade`] and changes nothing of a path.

use crate::color::Rgb;
use crate::geometry::{Side, SurfaceHit};
use crate::math::Hit;

use super::super::seen;
use super::super::trace::Recorder;
use super::batch::Batch;
use super::opacity;
use super::paths::Path;

impl<R: Recorder> Batch<'_, R> {
    /// Notes what the edge of a path meets, where that is wanted and the path looks straight from the
    /// camera.
    pub(super) fn see(&mut self, path: &Path, hit: Hit) {
        if self.seen.is_empty() || path.state.depth > 1 {
            return;
        }
        let scene = self.world.scene;
        let Some(hit) = scene.spheres().answer(&path.ray, hit) else { return };
        let surface = scene.surface(hit.id);
        let media = self.media_of(path);
        let presence = surface.presence(hit.id, hit.side, media);
        let throughput = path.state.throughput * media.transmittance(hit.t - path.ray.t_min);
        let emission = throughput * (surface.material.emission * presence);
        let is_seen =
            opacity::is_there(path, self.sampler(path), presence) && !self.is_hidden(path, &hit);
        let record = &mut self.seen[path.state.sample as usize];
        seen::add_emission(record, emission);
        if is_seen {
            seen::note(record, scene, &hit);
        } else {
            record.distance += hit.t as f32;
        }
    }

    /// Notes that a path meets nothing but the background.
    pub(super) fn see_nothing(&mut self, path: &Path, radiance: Rgb) {
        if let Some(record) = self.seen.get_mut(path.state.sample as usize) {
            seen::add_emission(record, path.state.throughput * radiance);
            record.distance = 0.0;
        }
    }

    /// Whether a dielectric's boundary lies hidden in another dielectric.
    fn is_hidden(&self, path: &Path, hit: &SurfaceHit) -> bool {
        let medium = self.world.scene.surface(hit.id).medium(hit.id);
        let entering = hit.side == Side::Outside;
        medium.is_some_and(|medium| self.media_of(path).meet(medium, entering).eta.is_none())
    }
}
