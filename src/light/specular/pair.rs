//! Pairs of a ball and a light.

use crate::geometry::Sphere;
use crate::math::DVec3;

/// A light that connections go to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ConnectedLight {
    /// An emitter, by its index.
    Emitter(u32),
    /// The sun.
    Sun,
}

/// A chosen pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CasterPair {
    /// Number among the pairs that are all tried; 0 for a choice of many.
    pub n: u32,
    /// Index of the ball.
    pub caster: u32,
    /// The light.
    pub light: ConnectedLight,
    /// Probability of the choice.
    pub pmf: f64,
}

/// An emitter and its power over its solid angle.
#[derive(Clone, Copy, Debug)]
pub(super) struct ConnectedEmitter {
    pub(super) id: u32,
    pub(super) sphere: Sphere,
    /// `pi R^2` times its luminance.
    pub(super) power: f64,
}

/// Where an emitter is, seen from a ball.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum EmitterPlace {
    /// Outside of the ball, and not around it.
    Apart,
    /// Inside the ball.
    Inside,
    /// Touching the surface of the ball, around it, or the ball itself.
    Elsewhere,
}

impl ConnectedEmitter {
    /// Returns where the emitter is, seen from the ball with this id.
    #[inline]
    pub(super) fn place(&self, id: u32, ball: &Sphere) -> EmitterPlace {
        let distance = self.sphere.center.distance(ball.center);
        if self.id == id {
            EmitterPlace::Elsewhere
        } else if distance >= self.sphere.radius + ball.radius {
            EmitterPlace::Apart
        } else if distance + self.sphere.radius < ball.radius {
            EmitterPlace::Inside
        } else {
            EmitterPlace::Elsewhere
        }
    }

    /// Irradiance at a point of a surface that faces the emitter, and the unit direction to it.
    pub(super) fn irradiance(&self, point: DVec3) -> (f64, DVec3) {
        let to_light = self.sphere.center - point;
        let distance_squared =
            to_light.length_squared().max(self.sphere.radius * self.sphere.radius);
        (self.power / distance_squared, to_light.normalize_or(DVec3::Z))
    }
}
