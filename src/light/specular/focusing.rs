//! How much a glass ball concentrates light, roughly, for choosing among balls.

use crate::math::DVec3;

/// The narrowest beam that is told apart, in radii: bounds the importance.
const NARROWEST: f64 = 0.15;
/// What a ball scatters beside its beam, relative to a mirror ball.
const SCATTERED: f64 = 0.3;

/// Returns the irradiance that a dielectric ball of unit radius at the origin sends to a point,
/// relative to that of a mirror ball. `towards` is the unit direction to the light.
///
/// Behind the ball, the beam converges to its focus at `n / (2 (n - 1))` from the centre (by the
/// paraxial formula) and diverges beyond.
pub(super) fn focusing(point: DVec3, towards: DVec3, ior: f64) -> f64 {
    let depth = -point.dot(towards);
    if depth <= 0.0 {
        return SCATTERED;
    }
    let focus = ior / (2.0 * (ior - 1.0));
    let width = (1.0 - depth / focus).abs().max(NARROWEST);
    let width_squared = width * width;
    let distance_squared = point.length_squared();
    let off_axis = (distance_squared - depth * depth).max(0.0) / width_squared;
    let in_beam = 4.0 * distance_squared / (width_squared * (1.0 + off_axis * off_axis));
    SCATTERED + in_beam
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_is_concentrated_behind_the_ball_and_nowhere_else() {
        let at = |x: f64, z: f64| focusing(DVec3::new(x, 0.0, z), -DVec3::Z, 1.5);
        assert!(at(0.0, 1.5) > 100.0 && at(0.0, 1.5) < 500.0);
        assert!(at(0.0, 1.2) < at(0.0, 1.5) && at(0.0, 3.0) < at(0.0, 1.5));
        assert!(at(1.5, 1.5) < 1.0);
        assert_eq!(at(0.0, -2.0), SCATTERED);
    }

    #[test]
    fn a_bubble_spreads_light() {
        let far = DVec3::new(0.0, 0.0, 5.0);
        assert!(focusing(far, -DVec3::Z, 0.7) < focusing(far, -DVec3::Z, 1.0001));
    }
}
