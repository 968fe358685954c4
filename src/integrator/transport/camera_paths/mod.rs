//! Camera paths: generation of the first rays.

mod lanes;

pub(in super::super) use lanes::CameraRayBatch;

use crate::color::Rgb;
use crate::geometry::PathRay;
use crate::math::LANES;
use crate::sampling::Sampler;
use crate::scene::settings::MissPolicy;

use super::super::camera_rays::{generate_camera_ray, sampler_for};
use super::super::dimension;
use super::super::sample::SampleAddress;
use super::super::trace::{PathEvent, PathRecorder};
use super::super::workspace::Workspace;
use super::batch::PathBatch;
use super::paths::{Path, PathState};

/// Maximum number of times that a camera ray is redrawn after a miss, if the scene asks for it.
const MAX_CAMERA_RETRIES: u32 = 1000;

impl<R: PathRecorder> PathBatch<'_, R> {
    /// Generates the camera rays of all samples.
    pub(super) fn generate_camera_paths(&mut self, workspace: &mut Workspace) {
        let Workspace { isa, camera_batch, path_queue: paths, .. } = workspace;
        self.samplers.clear();
        paths.clear();
        let samples = self.samples;
        if lanes::supports_lanes(self.context.prepared, self.integrator) {
            for samples in samples.chunks(LANES) {
                let rays = paths.rays.push_block(samples.len());
                camera_batch.run(*isa, self.context.prepared, samples, rays);
                self.samplers.extend((0..samples.len()).map(|lane| camera_batch.sampler(lane)));
            }
        } else {
            for &address in samples {
                let sampler = sampler_for(self.context.prepared, self.integrator.strata, address);
                let ray = self.camera_ray(address, sampler, [dimension::PIXEL, dimension::LENS]);
                paths.rays.push(&ray);
                self.samplers.push(sampler);
            }
        }
        paths.states.extend((0..samples.len()).map(|sample| PathState::new(sample as u32)));
        if R::ENABLED || self.context.scene.has_media() {
            (0..samples.len()).for_each(|index| self.begin_camera_path(&paths.get(index)));
        }
    }

    fn camera_ray(
        &self,
        address: SampleAddress,
        sampler: Sampler,
        dimensions: [u32; 2],
    ) -> PathRay {
        generate_camera_ray(
            self.context.prepared,
            self.integrator.strata,
            address,
            sampler,
            dimensions,
        )
    }

    /// Redraws a camera ray that missed, if the scene asks for it. Returns true if it did.
    pub(super) fn retry_camera_ray(&mut self, path: &mut Path) -> bool {
        let redraws = self.integrator.miss == MissPolicy::Redraw && path.state.depth == 1;
        if !redraws || path.state.redraws >= MAX_CAMERA_RETRIES {
            return false;
        }
        path.state.redraws += 1;
        let first = dimension::camera_retry(path.state.redraws);
        let address = self.samples[path.state.batch_index as usize];
        path.ray = self.camera_ray(address, self.sampler(&path.state), [first, first + 2]);
        path.state.throughput = Rgb::ONE;
        self.begin_camera_path(path);
        true
    }

    fn begin_camera_path(&mut self, path: &Path) {
        let (ray, redraws) = (path.ray, path.state.redraws);
        if let Some(media) = self.media.get_mut(path.state.batch_index as usize) {
            media.reset(self.context.prepared.media_at(ray.at(ray.t_min)));
        }
        self.recorder.record(|| PathEvent::CameraRay { ray, redraws });
    }
}
