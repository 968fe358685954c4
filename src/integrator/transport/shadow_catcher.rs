//! Shadow catchers: spheres that the camera sees only by the light that other spheres take from
//! them.
//!
//! Where a camera ray hits one, the picture shows what is behind everything, with the opacity of
//! the shadow: the share of the direct light of the point that is blocked. Light counts by what it
//! would send to a white diffuse surface. The share is estimated by one shadow ray to a light that
//! is chosen among some candidates in proportion to what each would send (resampled importance
//! sampling; Talbot, Cline and Egbert 2005). The candidates come from light sampling and from the
//! cosine, weighted by the balance heuristic. Their number is finite, so that the share is off by
//! what their total varies: little, as light sampling is nearly proportional to what arrives.
//!
//! Other light paths meet the sphere as any other.

use crate::color::{Rgb, luminance};
use crate::fault::fault;
use crate::geometry::{PathRay, SurfaceHit};
use crate::light::{CategoryPmf, LightSample, LightSampleContext, LightSource};
use crate::math::{Frame, renormalize};
use crate::sampling::{Hemisphere, Sampler};

use super::super::dimension;
use super::super::trace::{ChosenLight, PathEvent, PathRecorder, Termination};
use super::batch::PathBatch;
use super::paths::{Path, PendingDirect, ShadowQueue};

/// Candidates of each kind.
const CANDIDATES: u32 = 8;

/// Steps of a lattice in three dimensions: powers of the inverse of the root of x^4 = x + 1
/// (Roberts 2018), which spread candidates well.
const LATTICE: [f64; 3] =
    [0.819_172_513_396_164_4, 0.671_043_606_703_789_3, 0.549_700_477_901_970_5];

/// Light that would arrive at the point, and how likely it is chosen.
struct Candidate {
    ray: PathRay,
    sample: LightSample,
    weight: f64,
}

impl<R: PathRecorder> PathBatch<'_, R> {
    /// Shades a camera path that hits a shadow catcher, and ends it.
    pub(super) fn shade_shadow_catcher(
        &mut self,
        path: &Path,
        hit: &SurfaceHit,
        shadow_queue: &mut ShadowQueue<'_>,
    ) -> Option<PathRay> {
        let (state, direction) = (&path.state, path.ray.direction);
        let wo = -direction;
        self.recorder.record(|| PathEvent::Hit {
            depth: state.depth,
            hit: *hit,
            wo,
            opacity: 1.0,
            transmittance: Rgb::ONE,
            throughput: state.throughput,
        });
        let scene = self.context.scene;
        let behind = scene.seen_by_camera(scene.background_radiance(direction));
        let radiance = state.throughput * behind;
        let batch_index = state.batch_index;
        let pending = PendingDirect {
            batch_index,
            radiance,
            is_direct: true,
            has_more: false,
            connection: 0,
            is_caught: true,
        };
        let arriving = self.choose_arriving_light(hit, self.sampler(state));
        self.recorder.record(|| PathEvent::ShadowCatcher {
            behind,
            light: arriving.as_ref().map(|(_, light)| *light),
        });
        match arriving {
            Some((ray, _)) if !fault!(CatcherVisibilityLost) => {
                shadow_queue.shadow_rays.push(&ray, pending);
                if scene.has_passable_surfaces() {
                    shadow_queue.media.push(self.media_of(state).clone());
                }
            }
            // No light arrives, so that none can be missing.
            _ => self.add_direct(&pending, Rgb::ONE),
        }
        self.terminate(Termination::ShadowCatcher)
    }

    /// One of the candidates, with its shadow ray.
    fn choose_arriving_light(
        &self,
        hit: &SurfaceHit,
        sampler: Sampler,
    ) -> Option<(PathRay, ChosenLight)> {
        let ctx = LightSampleContext { hit: *hit, is_two_sided: false, is_lambertian: true };
        let frame = Frame::from_z(hit.facing_normal());
        let category_pmf = self.context.prepared.lights().category_pmf(&ctx);
        let u = sampler.get_2d(dimension::SHADOW_CATCHER);
        let [u_select, u_choice] = sampler.get_2d(dimension::SHADOW_CATCHER + 2);
        let mut candidates = Vec::with_capacity(2 * CANDIDATES as usize);
        for index in 0..CANDIDATES {
            let shifted = |u: f64, axis: usize| (u + f64::from(index) * LATTICE[axis]).fract();
            let u = [shifted(u[0], 0), shifted(u[1], 1)];
            let of_light = (shifted(u_select, 2), u);
            candidates.extend(self.sampled_light(&ctx, &frame, &category_pmf, of_light));
            candidates.extend(self.light_by_cosine(&ctx, &frame, &category_pmf, u));
        }
        let total: f64 = candidates.iter().map(|candidate| candidate.weight).sum();
        let mut left = u_choice * total;
        let is_chosen = |candidate: &Candidate| {
            left -= candidate.weight;
            left < 0.0
        };
        let chosen = candidates.iter().position(is_chosen);
        // Rounding may leave a little.
        let chosen = chosen.or(candidates.len().checked_sub(1))?;
        let count = candidates.len();
        let Candidate { ray, sample, weight } = candidates.swap_remove(chosen);
        let probability = weight / total;
        (total > 0.0).then_some((ray, ChosenLight { sample, probability, count }))
    }

    /// A candidate of light sampling.
    fn sampled_light(
        &self,
        ctx: &LightSampleContext,
        frame: &Frame,
        category_pmf: &CategoryPmf,
        (u_select, u): (f64, [f64; 2]),
    ) -> Option<Candidate> {
        let (lights, spheres) = (self.context.prepared.lights(), self.context.scene.spheres());
        let sample = lights.sample_by(category_pmf, spheres, ctx, u_select, u)?;
        let cos = frame.to_local(sample.direction).z;
        // The cosine finds no emitter here, only what is infinitely far away.
        let by_cosine = match sample.source {
            LightSource::Environment => Hemisphere::Cosine.pdf(cos.max(0.0)),
            LightSource::Emitter(_) | LightSource::FarWall(_) => 0.0,
        };
        self.candidate(ctx, &sample, cos / (sample.pdf + by_cosine))
    }

    /// A candidate of the environment, sampled by the cosine.
    fn light_by_cosine(
        &self,
        ctx: &LightSampleContext,
        frame: &Frame,
        category_pmf: &CategoryPmf,
        u: [f64; 2],
    ) -> Option<Candidate> {
        let lights = self.context.prepared.lights();
        let local = Hemisphere::Cosine.sample(u);
        let direction = renormalize(frame.to_world(local));
        let (radiance, map_pdf) = lights.environment().radiance_and_pdf(direction);
        let by_light = lights.environment_pdf(category_pmf, direction, map_pdf);
        let sample = LightSample {
            source: LightSource::Environment,
            direction,
            distance: f64::INFINITY,
            radiance,
            pdf: by_light,
            is_exact: false,
        };
        let by_cosine = Hemisphere::Cosine.pdf(local.z);
        let cos = if fault!(CatcherWithoutCosine) { 1.0 } else { local.z };
        self.candidate(ctx, &sample, cos / (by_cosine + by_light))
    }

    /// The candidate with its shadow ray, if it can contribute.
    fn candidate(
        &self,
        ctx: &LightSampleContext,
        sample: &LightSample,
        factor: f64,
    ) -> Option<Candidate> {
        let LightSample { source, direction, distance, radiance, .. } = *sample;
        let weight = f64::from(luminance(radiance)) * factor;
        if !(weight > 0.0 && weight.is_finite()) {
            return None;
        }
        let ray = match self.context.scene.has_passable_surfaces() {
            true => ctx.hit.spawn_ray_to(direction, distance, source.sphere_id()),
            false => ctx.hit.spawn_shadow_ray(direction, distance, source.sphere_id()),
        };
        ray.map(|ray| Candidate { ray, sample: *sample, weight })
    }
}
