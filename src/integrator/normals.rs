//! `integrator = "normals"`: the unit normal `n` of the first sphere, away from its centre, as the
//! colour `0.5 + 0.5 n`; black where there is none. Nothing is random but the place in the pixel.

use crate::color::{Radiance, Rgb};
use crate::math::DVec3;

use super::camera_rays::Strata;
use super::estimate::Integrator;
use super::first_hits::{first_hits, strata_without_noise};
use super::sample::{SampleAddress, Tally};
use super::workspace::Workspace;
use super::world::World;

/// Normals as colours.
pub(super) struct Normals {
    strata: Strata,
}

impl Normals {
    /// With one sample a pixel, the ray goes through the pixel's centre.
    pub(super) fn new(samples_per_pixel: u32) -> Self {
        Self { strata: strata_without_noise(samples_per_pixel) }
    }
}

impl Integrator for Normals {
    fn estimate(
        &self,
        world: World<'_>,
        samples: &[SampleAddress],
        radiance: &mut [Radiance],
        workspace: &mut Workspace,
    ) -> Tally {
        let mut tally = Tally::default();
        let found = first_hits(world, self.strata, samples, workspace, &mut tally);
        for (radiance, first) in radiance.iter_mut().zip(found) {
            let direct = first.surface.map_or(Rgb::ZERO, |surface| color(surface.normal));
            let alpha = f32::from(u8::from(first.surface.is_some()));
            *radiance = Radiance { direct, indirect: Rgb::ZERO, alpha };
        }
        tally
    }
}

fn color(normal: DVec3) -> Rgb {
    (0.5 + 0.5 * normal).as_vec3()
}
