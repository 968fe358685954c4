//! Light samples: from a vertex towards something that shines.

use crate::color::Rgb;
use crate::fault::fault;
use crate::geometry::{PathRay, SurfaceHit};
use crate::light::Receiver;
use crate::material::{Bsdf, Media};
use crate::math::{DVec3, Frame};
use crate::scene::Scene;

use super::super::dimension::Vertex;
use super::super::trace::{Recorder, Step};
use super::batch::Batch;
use super::opacity;
use super::paths::{Aims, Gain, Path};
use super::weight::weight;

impl Aims<'_> {
    /// One more shadow ray, and the media it starts in.
    pub(super) fn extend(&mut self, scene: &Scene, aimed: Option<(PathRay, Gain, &Media)>) {
        let Some((ray, gain, media)) = aimed else { return };
        self.shadows.push(&ray, gain);
        if scene.has_opacity() {
            self.media.push(*media);
        }
    }
}

impl<R: Recorder> Batch<'_, R> {
    /// The shadow ray from a vertex to a sampled light, if it can bring any, and the media it starts
    /// in; `beyond` are those on the other side of the surface, where they are others.
    pub(super) fn aim_at_light<'p>(
        &'p mut self,
        path: &Path,
        receiver: &Receiver,
        bsdf: &Bsdf<'_>,
        frame: &Frame,
        wo: DVec3,
        beyond: Option<&'p Media>,
    ) -> Option<(PathRay, Gain, &'p Media)> {
        let vertex = Vertex::at(path.state.depth);
        let sampler = self.sampler(path);
        let u = sampler.get_2d(vertex.towards_lamp());
        let scene = self.world.scene;
        let lights = self.world.shot.lights();
        let has_choice = lights.has_choice();
        let choose = if has_choice { sampler.get(vertex.lamp()) } else { 0.0 };
        let mut aim = lights.sample(scene.spheres(), receiver, choose, u)?;
        let wi = frame.to_local(aim.direction);
        let f = bsdf.eval(wo, wi);
        if f.max_element() <= 0.0 {
            return None;
        }
        let is_beyond = beyond.filter(|_| wi.z < 0.0);
        let media = is_beyond.unwrap_or_else(|| self.media_of(path));
        let leave = match scene.has_opacity() {
            true => SurfaceHit::leave_up_to,
            false => SurfaceHit::leave_towards,
        };
        let ray = leave(&receiver.hit, aim.direction, aim.distance, aim.source.sphere())?;
        aim.radiance = opacity::radiance(scene, &aim, receiver, media);
        let transmittance = match scene.has_media() {
            true => media.transmittance(aim.distance),
            false => Rgb::ONE,
        };
        let cos = if fault!(CosineMissing) { 1.0 } else { wi.z.abs() };
        let pdf_bsdf = bsdf.pdf(wo, wi);
        let weight = weight(self.transport.estimator, aim.pdf, pdf_bsdf);
        self.recorder.note(|| Step::Aim { sample: aim, transmittance, f, cos, pdf_bsdf, weight });
        let radiance = aim.radiance * transmittance;
        let light = path.state.throughput * f * radiance * (weight * cos / aim.pdf) as f32;
        if light == Rgb::ZERO {
            return None;
        }
        let is_direct = path.state.aims_directly();
        let media = is_beyond.unwrap_or_else(|| self.media_of(path));
        Some((ray, Gain { sample: path.state.sample, light, is_direct }, media))
    }
}
