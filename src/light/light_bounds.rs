//! Bounds of one or more emitters: the expected irradiance at a shading point.
//!
//! Importance after Conty Estevez and Kulla 2018, "Importance Sampling of Many Lights with Adaptive
//! Tree Splitting", and Pharr, Jakob and Humphreys 2023, "Physically Based Rendering", section
//! 12.6.3: power over squared distance, where the distance is at least the radius of the bounding
//! sphere, times a cosine at the shading point. Emissive spheres emit equally in all directions, so
//! there are no emission cones to bound.
//!
//! For a single emitter above the horizon, importance is the irradiance itself.

use crate::geometry::Sphere;
use crate::math::DVec3;

use super::context::LightSampleContext;

/// Compensates for rounding a radius to f32.
const ROUND_OUTWARD: f64 = 1.0 + 1e-6;

/// A bounding sphere of emitters, and their power. 20 bytes.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LightBounds {
    center: [f32; 3],
    radius: f32,
    power: f32,
}

/// An emitter to be clustered.
#[derive(Clone, Copy, Debug)]
pub(super) struct LightItem {
    /// The emitter, or a sphere around the part of it that can be seen.
    pub(super) sphere: Sphere,
    /// `pi r^2` of that sphere times its luminance, as a fraction of the total over all emitters.
    pub(super) power: f64,
    /// Index in the list of emitters.
    pub(super) emitter_index: u32,
}

impl LightBounds {
    /// Bounds all `items` with a sphere around `center_f64`.
    pub(super) fn enclosing(center_f64: DVec3, items: &[LightItem]) -> Self {
        let center = center_f64.as_vec3();
        let extent =
            |item: &LightItem| item.sphere.center.distance(center.as_dvec3()) + item.sphere.radius;
        let radius = items.iter().map(extent).fold(0.0, f64::max);
        let power: f64 = items.iter().map(|item| item.power).sum();
        Self {
            center: center.to_array(),
            radius: (radius * ROUND_OUTWARD) as f32,
            // An emitter must not vanish because it is faint relative to the others.
            power: (power as f32).max(f32::MIN_POSITIVE),
        }
    }

    /// Expected irradiance, in units of the power. 0 only if the whole cluster is below the shading
    /// point's horizon.
    pub(super) fn importance(&self, ctx: &LightSampleContext) -> f64 {
        let center = DVec3::from_array(self.center.map(f64::from));
        let (radius, power) = (f64::from(self.radius), f64::from(self.power));
        let to_center = center - ctx.hit.point;
        let distance_squared = to_center.length_squared();
        if distance_squared <= radius * radius {
            return power / (radius * radius);
        }
        let distance = distance_squared.sqrt();
        let cos = to_center.dot(ctx.hit.facing_normal()) / distance;
        let cos = if ctx.is_two_sided { cos.abs() } else { cos };
        power / distance_squared * clipped_cosine(cos, radius / distance)
    }
}

impl LightBounds {
    /// Irradiance at a point of a surface that faces the cluster, in units of the power over pi.
    pub(super) fn importance_facing(&self, point: DVec3) -> f64 {
        let [distance_squared, radius] = self.distance_squared(point);
        f64::from(self.power) / distance_squared.max(radius * radius)
    }

    /// Returns true if the cluster subtends a small angle from a point.
    pub(super) fn is_small_from(&self, point: DVec3) -> bool {
        let [distance_squared, radius] = self.distance_squared(point);
        radius * radius < 0.1 * distance_squared
    }

    fn distance_squared(&self, point: DVec3) -> [f64; 2] {
        let center = DVec3::from_array(self.center.map(f64::from));
        [center.distance_squared(point), f64::from(self.radius)]
    }
}

/// Mean clamped cosine over a sphere that subtends a cone with axis cosine `cos` and half-angle
/// sine `sin_rim`: `cos` if the cone is above the horizon, falling smoothly to 0 where it is below.
pub(super) fn clipped_cosine(cos: f64, sin_rim: f64) -> f64 {
    if cos >= sin_rim {
        return cos;
    }
    let above_horizon = (cos + sin_rim).max(0.0);
    above_horizon * above_horizon / (4.0 * sin_rim)
}
