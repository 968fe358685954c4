//! The sun: a disc of constant radiance, infinitely far away.

use std::f64::consts::{PI, TAU};

use crate::color::{Rgb, luminance};
use crate::math::{DVec3, Frame};
use crate::sampling::{hemisphere, sin_cos};

use super::super::context::LightSampleContext;
use super::super::light_bounds::clipped_cosine;

/// A sun.
#[derive(Clone, Copy, Debug)]
pub struct SunLight {
    frame: Frame,
    radiance: Rgb,
    /// Irradiance on a surface facing it, in luminance.
    irradiance: f64,
    sin_max: f64,
    one_minus_cos_max: f64,
}

impl SunLight {
    /// Creates a sun in a unit direction (the same from everywhere), with an angular diameter in
    /// radians up to pi and an irradiance (W/m^2 per channel) on a surface that faces it.
    pub fn new(direction: DVec3, angular_diameter: f64, irradiance: Rgb) -> Self {
        let (sin_rim, _) = sin_cos(0.5 * angular_diameter);
        let (sin_half, _) = sin_cos(0.25 * angular_diameter);
        // A disc of radiance L and half angle a gives the irradiance pi L sin^2 a.
        let radiance = irradiance.as_dvec3() / (PI * sin_rim * sin_rim);
        Self {
            frame: Frame::from_z(direction),
            radiance: radiance.as_vec3(),
            irradiance: f64::from(luminance(irradiance)),
            sin_max: sin_rim,
            one_minus_cos_max: 2.0 * sin_half * sin_half,
        }
    }

    /// Returns the maximum radiance in any channel.
    pub(super) fn max_radiance(&self) -> f32 {
        self.radiance.max_element()
    }

    /// Returns the radiance from a unit direction: 0 outside the disc.
    pub fn radiance(&self, direction: DVec3) -> Rgb {
        if self.contains(direction) { self.radiance } else { Rgb::ZERO }
    }

    /// Samples a direction uniformly over the disc.
    pub fn sample(&self, u: [f64; 2]) -> DVec3 {
        let local = hemisphere::sample_uniform_cone(self.one_minus_cos_max, u);
        self.frame.to_world(local).normalize()
    }

    /// Returns the pdf of [`Self::sample`] per solid angle.
    pub fn pdf(&self, direction: DVec3) -> f64 {
        if self.contains(direction) { 1.0 / (TAU * self.one_minus_cos_max) } else { 0.0 }
    }

    /// Expected irradiance at a shading point, in luminance.
    pub(in crate::light) fn importance(&self, ctx: &LightSampleContext) -> f64 {
        let cos = self.frame.z.dot(ctx.hit.facing_normal());
        let cos = if ctx.is_two_sided { cos.abs() } else { cos };
        self.irradiance * clipped_cosine(cos, self.sin_max)
    }

    /// Returns the unit direction to the centre of the disc, the irradiance on a surface that faces
    /// it, in luminance, and the solid angle.
    pub(in crate::light) fn beam(&self) -> (DVec3, f64, f64) {
        (self.frame.z, self.irradiance, TAU * self.one_minus_cos_max)
    }

    /// Returns true if a direction is within the disc. Compares squared chords, which resolve small
    /// angles where cosines do not.
    fn contains(&self, direction: DVec3) -> bool {
        direction.distance_squared(self.frame.z) <= 2.0 * self.one_minus_cos_max
    }
}
