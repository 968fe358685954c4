//! Light from infinitely far away: an environment map and a sun in front of it.

mod environment_map;
mod sky;
mod sun;

pub use environment_map::EnvironmentMap;
pub(super) use environment_map::MapSample;
pub use sky::Sky;
pub use sun::SunLight;

use crate::color::Rgb;
use crate::math::{DVec3, Frame, renormalize};
use crate::sampling::sin_cos;

use super::context::LightSampleContext;

/// Light that arrives from infinitely far away.
#[derive(Clone, Debug)]
pub struct Environment {
    map: EnvironmentMap,
    /// The environment's radiance if it is constant.
    constant: Option<Rgb>,
    orientation: Orientation,
    sun: Option<SunLight>,
}

/// Orientation of an environment map in the world.
#[derive(Clone, Copy, Debug)]
pub struct Orientation {
    /// The map's right (x), up (y) and back (z) axes.
    axes: Frame,
}

impl Orientation {
    /// Creates the shortest rotation that brings y to `up`, a unit vector, applied after a rotation
    /// about y by `angle` in radians, counterclockwise when seen from above.
    pub fn new(up: DVec3, angle: f64) -> Self {
        let rotate = |v: DVec3| {
            let axis = DVec3::Y.cross(up);
            if up.y <= -1.0 + 1e-12 {
                return DVec3::new(v.x, -v.y, -v.z);
            }
            // Rodrigues' formula, for an axis whose length is the angle's sine.
            v + axis.cross(v) + axis.cross(axis.cross(v)) / (1.0 + up.y)
        };
        let (sin, cos) = sin_cos(angle);
        let [x, z] = [DVec3::new(cos, 0.0, -sin), DVec3::new(sin, 0.0, cos)];
        Self { axes: Frame { x: rotate(x), y: rotate(DVec3::Y), z: rotate(z) } }
    }

    /// Returns the world direction at an elevation above the horizon and at an azimuth from the
    /// front (-z) to the right (+x), both in radians.
    pub fn direction(&self, elevation: f64, azimuth: f64) -> DVec3 {
        let (height, horizontal) = sin_cos(elevation);
        let (right, front) = sin_cos(azimuth);
        self.axes.to_world(DVec3::new(horizontal * right, height, -horizontal * front)).normalize()
    }

    /// Transforms a world direction to the map's frame.
    pub fn to_local(&self, direction: DVec3) -> DVec3 {
        self.axes.to_local(direction)
    }
}

impl Default for Environment {
    fn default() -> Self {
        Self::constant(Rgb::ZERO)
    }
}

impl Environment {
    /// Creates an environment of constant radiance.
    pub fn constant(radiance: Rgb) -> Self {
        Self::new(EnvironmentMap::constant(radiance), Orientation::new(DVec3::Y, 0.0), None)
    }

    /// Creates an environment from an oriented map, optionally with a sun in front of it.
    pub fn new(map: EnvironmentMap, orientation: Orientation, sun: Option<SunLight>) -> Self {
        let constant = map.is_constant().then(|| map.radiance(DVec3::Y));
        Self { map, constant, orientation, sun }
    }

    /// Returns the radiance that arrives from a unit direction.
    pub fn radiance(&self, direction: DVec3) -> Rgb {
        let map = self
            .constant
            .unwrap_or_else(|| self.map.radiance(self.orientation.to_local(direction)));
        self.sun.map_or(map, |sun| map + sun.radiance(direction))
    }

    /// Returns the radiance from a unit direction, and the pdf of [`Self::sample`] per solid angle.
    pub(crate) fn radiance_and_pdf(&self, direction: DVec3) -> (Rgb, f64) {
        let (map, pdf) = match self.constant {
            Some(radiance) => (radiance, 0.0),
            None => self.map.radiance_and_pdf(self.orientation.to_local(direction)),
        };
        (self.sun.map_or(map, |sun| map + sun.radiance(direction)), pdf)
    }

    /// Returns an upper bound on the radiance from any direction, in any channel.
    pub fn max_radiance(&self) -> f32 {
        self.map.max_radiance() + self.sun.map_or(0.0, |sun| sun.max_radiance())
    }

    /// Returns the sun, if any.
    pub(super) fn sun(&self) -> Option<&SunLight> {
        self.sun.as_ref()
    }

    /// Returns true if light sampling does not apply: BSDF sampling handles constant light best
    /// (`docs/lights.md` has the figures).
    pub fn is_constant(&self) -> bool {
        self.constant.is_some() && self.sun.is_none()
    }

    /// Returns the radiance if it is constant.
    pub fn constant_radiance(&self) -> Option<Rgb> {
        if self.sun.is_none() { self.constant } else { None }
    }

    /// Returns true if light sampling targets the sun or the environment map.
    pub(super) fn is_sampled(&self) -> bool {
        self.sun.is_some() || self.map.total_weight() > 0.0
    }

    /// Expected irradiance at a shading point from the sampled part of the environment map, in
    /// luminance.
    pub(super) fn importance(&self, ctx: &LightSampleContext) -> f64 {
        // Mean over all surface orientations.
        let mean_cosine = if ctx.is_two_sided { 0.5 } else { 0.25 };
        mean_cosine * self.map.total_weight()
    }

    /// Samples a direction of the environment map, with the radiance of all that is there and the
    /// pdf per solid angle; `None` if the map is constant.
    pub(super) fn sample(&self, u: [f64; 2]) -> Option<MapSample> {
        let MapSample { direction, radiance, pdf } = self.map.sample(u)?;
        let direction = renormalize(self.orientation.axes.to_world(direction));
        let radiance = self.sun.map_or(radiance, |sun| radiance + sun.radiance(direction));
        Some(MapSample { direction, radiance, pdf })
    }

    /// Returns the pdf of [`Self::sample`] per solid angle.
    pub(super) fn pdf(&self, direction: DVec3) -> f64 {
        self.map.pdf(self.orientation.to_local(direction))
    }
}
