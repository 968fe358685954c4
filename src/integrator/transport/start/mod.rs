//! Camera rays: where paths begin.

mod many;

pub(in super::super) use many::StartBlock;

use crate::color::Rgb;
use crate::geometry::PathRay;
use crate::math::LANES;
use crate::sampling::Sampler;
use crate::scene::settings::Miss;

use super::super::camera_rays::{camera_ray, sampler_of};
use super::super::dimension;
use super::super::sample::SampleAddress;
use super::super::trace::{Recorder, Step};
use super::super::workspace::Workspace;
use super::batch::Batch;
use super::paths::{Path, State};

/// How often a camera ray that met nothing is drawn again where the scene asks for that.
const MOST_REDRAWS: u32 = 1000;

impl<R: Recorder> Batch<'_, R> {
    /// The paths of all samples, at the camera.
    pub(super) fn start_all(&mut self, workspace: &mut Workspace) {
        let Workspace { isa, start, paths, .. } = workspace;
        self.samplers.clear();
        paths.clear();
        let samples = self.samples;
        if many::can_start(self.world.shot, self.transport) {
            for samples in samples.chunks(LANES) {
                let rays = paths.rays.push_block(samples.len());
                start.run(*isa, self.world.shot, samples, rays);
                self.samplers.extend((0..samples.len()).map(|lane| start.sampler(lane)));
            }
        } else {
            for &address in samples {
                let sampler = sampler_of(self.world.shot, self.transport.strata, address);
                let ray = self.draw(address, sampler, [dimension::PIXEL, dimension::LENS]);
                paths.rays.push(&ray);
                self.samplers.push(sampler);
            }
        }
        paths.states.extend((0..samples.len()).map(|sample| State::new(sample as u32)));
        if R::LISTENS || self.world.scene.has_media() {
            (0..samples.len()).for_each(|index| self.leave_camera(&paths.get(index)));
        }
    }

    fn draw(&self, address: SampleAddress, sampler: Sampler, dimensions: [u32; 2]) -> PathRay {
        camera_ray(self.world.shot, self.transport.strata, address, sampler, dimensions)
    }

    /// Draws a camera ray again that met nothing, where the scene asks for that. Returns whether it
    /// did.
    pub(super) fn redraw(&mut self, path: &mut Path) -> bool {
        let redraws = self.transport.miss == Miss::Redraw && path.state.depth == 1;
        if !redraws || path.state.redraws >= MOST_REDRAWS {
            return false;
        }
        path.state.redraws += 1;
        let first = dimension::redraw(path.state.redraws);
        let address = self.samples[path.state.sample as usize];
        path.ray = self.draw(address, self.sampler(path), [first, first + 2]);
        path.state.throughput = Rgb::ONE;
        self.leave_camera(path);
        true
    }

    fn leave_camera(&mut self, path: &Path) {
        let (ray, redraws) = (path.ray, path.state.redraws);
        if let Some(media) = self.media.get_mut(path.state.sample as usize) {
            *media = self.world.shot.media_at(ray.at(ray.t_min));
        }
        self.recorder.note(|| Step::Camera { ray, redraws });
    }
}
