//! Kind 1: reflection off the outside of a ball.

use super::connection::Connection;
use super::deflection::{Angle, Deflection, Evaluation};
use super::equation::{Equation, MAX_TARGETS};
use super::phase::Phase;
use super::plane::{Plane, are_outside};
use super::root::Branch;

/// Reflection off the outside of a ball: one path, or none if the straight line between the points
/// meets the ball.
pub(super) struct Reflection;

impl Equation for Reflection {
    #[inline(always)]
    fn ratios([d1, d2]: [f64; 2], _: f64) -> [f64; 2] {
        [1.0 / d1, 1.0 / d2]
    }

    /// The angle `2 i - alpha - beta` at the centre.
    #[inline(always)]
    fn deflection([at_x, at_y]: [f64; 2], _: f64) -> Deflection {
        Deflection::new([2, -1, -1, 0], [1.0, at_x, at_y, 0.0])
    }

    #[inline(always)]
    fn half_angle(cos_theta: f64, sin_theta: f64) -> Phase {
        Phase::half_of(cos_theta, sin_theta)
    }

    /// psi = theta.
    #[inline(always)]
    fn targets(half_theta: Phase, _: &[Option<Branch>; 2]) -> [Option<Phase>; MAX_TARGETS] {
        [Some(half_theta.negated()), None, None]
    }

    #[inline(always)]
    fn connection(plane: &Plane, _: &Deflection, root: &Evaluation, _: usize) -> Connection {
        connection(plane, root)
    }
}

/// Returns the spread of a reflection that leaves x at an angle of this sine from the axis.
pub(super) fn spread(plane: &Plane, sin_at_x: f64) -> Option<f64> {
    if !are_outside(plane.distances) {
        return None;
    }
    let deflection = Reflection::deflection(Reflection::ratios(plane.distances, 1.0), 1.0);
    Some(connection(plane, &deflection.eval_at(Angle::AtX, sin_at_x)).spread)
}

#[inline(always)]
fn connection(plane: &Plane, root: &Evaluation) -> Connection {
    let ([d1, d2], radius) = (plane.distances, plane.ball.radius);
    let (cos, sin) = (root.cos(Angle::Outside), root.sin(Angle::Outside));
    let (cos_alpha, sin_alpha) = (root.cos(Angle::AtX), root.sin(Angle::AtX));
    let (cos_beta, sin_beta) = (root.cos(Angle::AtY), root.sin(Angle::AtY));
    let a = outer_leg(d1, cos_alpha, cos);
    let b = outer_leg(d2, cos_beta, cos);
    let mut connection = Connection {
        direction_at_x: plane.vector(-cos_alpha, sin_alpha),
        direction_at_y: plane.direction_at_y(cos_beta, sin_beta),
        leg_at_x: a * radius,
        leg_at_y: b * radius,
        cos_outside: cos,
        // Per b^2 for a direction, which does not overflow.
        spread: if d2 < f64::INFINITY {
            radius * radius * (a + b + 2.0 * a * b / cos) * (a + b + 2.0 * a * b * cos)
        } else {
            (1.0 + 2.0 * a / cos) * (1.0 + 2.0 * a * cos)
        },
        ..Connection::NONE
    };
    // The point is at the angle i - alpha from x.
    let point = (cos * cos_alpha + sin * sin_alpha, sin * cos_alpha - cos * sin_alpha);
    connection.push(plane.point(point.0, point.1));
    connection
}

/// Length of the leg from a point at distance `d >= 1` to the ball, `d cos alpha - cos i`, written
/// without cancellation.
#[inline(always)]
pub(super) fn outer_leg(d: f64, cos_at_point: f64, cos_outside: f64) -> f64 {
    if d == f64::INFINITY {
        return f64::INFINITY;
    }
    (d - 1.0) * (d + 1.0) / (d * cos_at_point + cos_outside)
}
