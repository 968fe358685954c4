//! `integrator = "normals"`: the outward unit normal `n` at the first hit, shown as the colour
//! `0.5 + 0.5 n`; black on a miss. Only the pixel position is random.

use crate::color::{PathRadiance, Rgb};
use crate::math::DVec3;

use super::camera_rays::Strata;
use super::context::RenderContext;
use super::estimate::Integrator;
use super::primary_hits::{noise_free_strata, trace_primary_rays};
use super::sample::{RenderStats, SampleAddress};
use super::workspace::Workspace;

/// The normals integrator.
pub(super) struct Normals {
    strata: Strata,
}

impl Normals {
    /// With one sample per pixel, the ray goes through the pixel's centre.
    pub(super) fn new(samples_per_pixel: u32) -> Self {
        Self { strata: noise_free_strata(samples_per_pixel) }
    }
}

impl Integrator for Normals {
    fn estimate(
        &self,
        context: RenderContext<'_>,
        samples: &[SampleAddress],
        radiance: &mut [PathRadiance],
        workspace: &mut Workspace,
    ) -> RenderStats {
        let mut stats = RenderStats::default();
        let primary_hits = trace_primary_rays(context, self.strata, samples, workspace, &mut stats);
        for (radiance, primary) in radiance.iter_mut().zip(primary_hits) {
            let direct = primary.hit.map_or(Rgb::ZERO, |surface| color(surface.normal));
            let alpha = f32::from(u8::from(primary.hit.is_some()));
            *radiance = PathRadiance { direct, indirect: Rgb::ZERO, alpha };
        }
        stats
    }
}

fn color(normal: DVec3) -> Rgb {
    (0.5 + 0.5 * normal).as_vec3()
}
