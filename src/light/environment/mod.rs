//! What a ray sees that meets nothing: a dome of light, and a sun before it.

mod environment_map;
mod sky;
mod sun;

pub use environment_map::EnvironmentMap;
pub use sky::Sky;
pub use sun::SunLight;

use crate::color::Rgb;
use crate::math::{DVec3, Frame};
use crate::sampling::sin_cos;

use super::receiver::LightSampleContext;

/// The light that comes from infinitely far away.
#[derive(Clone, Debug)]
pub struct Environment {
    map: EnvironmentMap,
    /// The dome's radiance where it is the same from everywhere.
    constant: Option<Rgb>,
    orientation: Orientation,
    sun: Option<SunLight>,
}

/// How a dome stands in the world.
#[derive(Clone, Copy, Debug)]
pub struct Orientation {
    /// Its right (x), upper (y) and back (z) side.
    axes: Frame,
}

impl Orientation {
    /// The shortest turn that brings y to `up`, a unit vector, after a turn about y: by an angle in
    /// radians, counterclockwise when seen from above.
    pub fn new(up: DVec3, angle: f64) -> Self {
        let lift = |v: DVec3| {
            let axis = DVec3::Y.cross(up);
            if up.y <= -1.0 + 1e-12 {
                return DVec3::new(v.x, -v.y, -v.z);
            }
            // Rodrigues' formula, for an axis as long as the angle's sine.
            v + axis.cross(v) + axis.cross(axis.cross(v)) / (1.0 + up.y)
        };
        let (sin, cos) = sin_cos(angle);
        let [x, z] = [DVec3::new(cos, 0.0, -sin), DVec3::new(sin, 0.0, cos)];
        Self { axes: Frame { x: lift(x), y: lift(DVec3::Y), z: lift(z) } }
    }

    /// The direction at an elevation above the horizon, and at an azimuth from the front (-z) to the
    /// right (+x); in radians.
    pub fn direction(&self, elevation: f64, azimuth: f64) -> DVec3 {
        let (height, flat) = sin_cos(elevation);
        let (right, front) = sin_cos(azimuth);
        self.axes.to_world(DVec3::new(flat * right, height, -flat * front)).normalize()
    }

    /// A direction of the world as one of the dome.
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
    /// The same radiance from everywhere.
    pub fn constant(radiance: Rgb) -> Self {
        Self::new(EnvironmentMap::constant(radiance), Orientation::new(DVec3::Y, 0.0), None)
    }

    /// A dome as it stands in the world, with or without a sun before it.
    pub fn new(dome: EnvironmentMap, orientation: Orientation, sun: Option<SunLight>) -> Self {
        let constant = dome.is_constant().then(|| dome.radiance(DVec3::Y));
        Self { map: dome, constant, orientation, sun }
    }

    /// The radiance that arrives against a unit direction.
    pub fn radiance(&self, direction: DVec3) -> Rgb {
        let dome = self
            .constant
            .unwrap_or_else(|| self.map.radiance(self.orientation.to_local(direction)));
        self.sun.map_or(dome, |sun| dome + sun.radiance(direction))
    }

    /// The largest radiance that arrives from anywhere, in any channel; no less than that.
    pub fn max_radiance(&self) -> f32 {
        self.map.max_radiance() + self.sun.map_or(0.0, |sun| sun.max_radiance())
    }

    /// The sun.
    pub(super) fn sun(&self) -> Option<&SunLight> {
        self.sun.as_ref()
    }

    /// Whether there is nothing to aim at: light that is even is best found by chance, that is by
    /// the BSDF's own samples (`docs/lights.md` has the figures).
    pub fn is_constant(&self) -> bool {
        self.constant.is_some() && self.sun.is_none()
    }

    /// The radiance, where it is the same from everywhere.
    pub fn constant_radiance(&self) -> Option<Rgb> {
        if self.sun.is_none() { self.constant } else { None }
    }

    /// Whether there is anything to aim at, sun or dome.
    pub(super) fn is_sampled(&self) -> bool {
        self.sun.is_some() || self.map.total_weight() > 0.0
    }

    /// The irradiance at a receiver from what is aimed at of the dome, in luminance.
    pub(super) fn importance(&self, from: &LightSampleContext) -> f64 {
        // The mean over all ways that a surface may face.
        let share = if from.is_two_sided { 0.5 } else { 0.25 };
        share * self.map.total_weight()
    }

    /// A direction to the dome; `None` where it is the same from everywhere.
    pub(super) fn sample(&self, u: [f64; 2]) -> Option<DVec3> {
        Some(self.orientation.axes.to_world(self.map.sample(u)?).normalize())
    }

    /// The density of [`Self::sample`] per solid angle.
    pub(super) fn pdf(&self, direction: DVec3) -> f64 {
        self.map.pdf(self.orientation.to_local(direction))
    }
}
