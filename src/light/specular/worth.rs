//! With which probability a pair is connected at a point: always where chance would be very noisy,
//! seldom where a connection costs more than it saves.
//!
//! Paths find a source of radiance L that brings the irradiance `E_c` over a ball with the
//! probability `E_c / (pi L)`, so that the variance of chance is about `E_c pi L`. The worth of a
//! connection is that variance over the square of the irradiance `E = L pi R^2 / d^2` that the same
//! source, a sphere of radius R at the distance d, brings directly if nothing hides it. A ball of
//! radius r at the distance a from the point and b from the source sends on
//! `E_c = s E_b (r / 2a)^2`, with the share s of what an even mirror ball would. So the saving is
//! `s (r / 2a)^2 d^4 / (b^2 R^2)`.

use std::f64::consts::PI;

use crate::math::DVec3;

use super::casters::{Caster, CasterSurface};
use super::focusing::focusing;
use super::pair::ConnectedEmitter;

/// The saving from which a pair is always connected.
const CERTAIN: f64 = 10.0;
/// Pairs of less worth are connected so often: a pair that never is would leave bright pixels.
const LEAST: f64 = 0.002;

/// Offset between the numbers of two pairs: the golden ratio spreads them evenly.
const OFFSET: f64 = 0.618_033_988_749_894_9;

/// Returns true if the n-th pair of a vertex, with this worth, is connected, by the `u` in `[0, 1)`
/// that all pairs of the vertex share.
#[inline(always)]
pub fn is_accepted(u: f64, n: u32, worth: f64) -> bool {
    let shifted = u + (f64::from(n) * OFFSET).fract();
    let shifted = if shifted >= 1.0 { shifted - 1.0 } else { shifted };
    shifted < worth
}

/// What the worth of a pair is computed from.
#[derive(Clone, Copy, Debug)]
pub struct PairWorth {
    center: DVec3,
    per_radius: f64,
    /// `(r / 2)^2`.
    quarter_square: f64,
    /// `s` of an opaque ball.
    share: f64,
    /// Index of refraction of a dielectric; 0 for an opaque ball.
    ior: f64,
    /// Unit direction from the ball to the light.
    towards: DVec3,
    /// Centre of the emitter.
    light: DVec3,
    /// `R^2`; 0 for the sun.
    light_square: f64,
    /// `1 / (b^2 R^2)` over [`CERTAIN`]; for the sun, `pi L / E` over it.
    gain: f64,
}

impl PairWorth {
    pub(super) fn new(caster: &Caster, emitter: &ConnectedEmitter) -> Self {
        let sphere = emitter.sphere;
        let square = sphere.radius * sphere.radius;
        let to_light = sphere.center - caster.ball.center;
        let b_square = to_light.length_squared().max(square);
        Self {
            towards: to_light.normalize_or(DVec3::Z),
            light: sphere.center,
            light_square: square,
            gain: 1.0 / (b_square * square * CERTAIN),
            ..Self::of_ball(caster)
        }
    }

    /// Of a pair with the sun, in a direction with a solid angle.
    pub(super) fn of_sun(caster: &Caster, towards: DVec3, solid_angle: f64) -> Self {
        Self { towards, gain: PI / (solid_angle * CERTAIN), ..Self::of_ball(caster) }
    }

    /// Returns this pair as one that is always connected.
    pub(super) fn certain(self) -> Self {
        Self { gain: f64::INFINITY, ..self }
    }

    fn of_ball(caster: &Caster) -> Self {
        let (share, ior) = match caster.surface {
            CasterSurface::Opaque(reflectance) => (reflectance, 0.0),
            CasterSurface::Dielectric(ior) => (1.0, ior),
        };
        let radius = caster.ball.radius;
        Self {
            center: caster.ball.center,
            per_radius: 1.0 / radius,
            quarter_square: 0.25 * radius * radius,
            share,
            ior,
            towards: DVec3::Z,
            light: DVec3::ZERO,
            light_square: 0.0,
            gain: 0.0,
        }
    }

    /// Returns true if the ball is a dielectric.
    #[inline(always)]
    pub fn is_dielectric(&self) -> bool {
        self.ior > 0.0
    }

    /// Returns the probability at a point outside of the ball; `IS_DIELECTRIC` must be right.
    #[inline(always)]
    pub fn at<const IS_DIELECTRIC: bool>(&self, x: DVec3) -> f64 {
        let from_ball = x - self.center;
        let spread = f64::min(self.quarter_square / from_ball.length_squared(), 1.0);
        let share = match IS_DIELECTRIC {
            true => focusing(from_ball * self.per_radius, self.towards, self.ior),
            false => self.share,
        };
        (share * spread * self.light_gain(x)).clamp(LEAST, 1.0)
    }

    /// Returns the probability at a point inside of the ball, where no other light may arrive.
    pub fn inside(&self, x: DVec3) -> f64 {
        self.light_gain(x).clamp(LEAST, 1.0)
    }

    /// `d^4 / (b^2 R^2)`.
    #[inline(always)]
    fn light_gain(&self, x: DVec3) -> f64 {
        let square = x.distance_squared(self.light).max(self.light_square);
        if self.light_square > 0.0 { square * square * self.gain } else { self.gain }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Sphere;

    fn mirror() -> Caster {
        let ball = Sphere { center: DVec3::ZERO, radius: 1.0 };
        Caster { id: 0, ball, surface: CasterSurface::Opaque(0.5) }
    }

    fn lamp(radius: f64) -> ConnectedEmitter {
        let sphere = Sphere { center: DVec3::new(0.0, 20.0, 0.0), radius };
        ConnectedEmitter { id: 1, sphere, power: 1.0 }
    }

    #[test]
    fn a_small_lamp_is_always_connected_and_a_wide_one_seldom() {
        let worth = |radius, a| PairWorth::new(&mirror(), &lamp(radius)).at::<false>(a * DVec3::X);
        assert_eq!(worth(0.1, 3.0), 1.0);
        // s (r / 2a)^2 d^4 / (b^2 R^2), over 10.
        let expected = 0.5 / 36.0 * 409.0 * 409.0 / (400.0 * 25.0) / 10.0;
        approx::assert_relative_eq!(worth(5.0, 3.0), expected, max_relative = 1e-12);
    }

    #[test]
    fn the_sun_is_a_lamp_far_away() {
        let (x, far, radius) = (DVec3::new(2.0, -1.0, 0.0), 1e5, 1e4);
        let sphere = Sphere { center: DVec3::Y * far, radius };
        let lamp = ConnectedEmitter { id: 1, sphere, power: 1.0 };
        let solid_angle = PI * radius * radius / (far * far);
        let sun = PairWorth::of_sun(&mirror(), DVec3::Y, solid_angle).at::<false>(x);
        let lamp = PairWorth::new(&mirror(), &lamp).at::<false>(x);
        approx::assert_relative_eq!(sun, lamp, max_relative = 1e-4);
    }
}
