//! Camera rays: where paths begin.

use crate::color::Rgb;
use crate::scene::description::Miss;

use super::super::camera_rays::{camera_ray, sampler_of};
use super::super::dimension;
use super::super::trace::{Recorder, Step};
use super::Path;
use super::batch::Batch;

/// How often a camera ray that met nothing is drawn again where the scene asks for that.
const MOST_REDRAWS: u32 = 1000;

impl<R: Recorder> Batch<'_, R> {
    /// The path of a sample, at the camera.
    pub(super) fn start(&mut self, sample: usize) -> Path {
        let scene = self.world.scene;
        let address = self.samples[sample];
        let sampler = sampler_of(scene, self.transport.strata, address);
        let dimensions = [dimension::PIXEL, dimension::LENS];
        let ray = camera_ray(scene, self.transport.strata, address, sampler, dimensions);
        let path = Path {
            sample: sample as u32,
            sampler,
            ray,
            throughput: Rgb::ONE,
            depth: 1,
            scatterings: 0,
            redraws: 0,
            passes: 0,
            drawn: None,
            index_squared: 1.0,
        };
        self.leave_camera(&path);
        path
    }

    /// Draws a camera ray again that met nothing, where the scene asks for that. Returns whether it
    /// did.
    pub(super) fn redraw(&mut self, path: &mut Path) -> bool {
        let redraws = self.transport.miss == Miss::Redraw && path.depth == 1;
        if !redraws || path.redraws >= MOST_REDRAWS {
            return false;
        }
        path.redraws += 1;
        let first = dimension::redraw(path.redraws);
        let (scene, strata) = (self.world.scene, self.transport.strata);
        let address = self.samples[path.sample as usize];
        path.ray = camera_ray(scene, strata, address, path.sampler, [first, first + 2]);
        path.throughput = Rgb::ONE;
        self.leave_camera(path);
        true
    }

    fn leave_camera(&mut self, path: &Path) {
        let Path { ray, redraws, .. } = *path;
        if let Some(media) = self.media.get_mut(path.sample as usize) {
            *media = self.world.scene.media_at(ray.at(ray.t_min));
        }
        self.recorder.note(|| Step::Camera { ray, redraws });
    }
}
