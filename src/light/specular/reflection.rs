//! Kind 1: reflection off the outside of a ball.

use crate::geometry::Sphere;
use crate::math::DVec3;

use super::connection::Connection;
use super::deflection::{Angle, Deflection};
use super::phase::Phase;
use super::plane::{Plane, Target};

/// Returns the reflection off the outside of a ball that connects two points outside of it; `None`
/// if the straight line between them meets the ball.
pub fn reflection(ball: &Sphere, x: DVec3, y: Target) -> Option<Connection> {
    let plane = Plane::new(*ball, x, y);
    let [d1, d2] = plane.distances;
    if !(d1 >= 1.0 && d2 >= 1.0) {
        return None;
    }
    // theta = 2 i - alpha - beta.
    let deflection = Deflection::new([2, -1, -1, 0], [1.0, 1.0 / d1, 1.0 / d2, 0.0]);
    let theta = Phase::half_of(plane.cos_theta, plane.sin_theta);
    let branch = deflection.branches()[0]?;
    let root = deflection.root(&branch, theta.negated())?;
    let (cos, sin) = (root.cos(Angle::Outside), root.sin(Angle::Outside));
    let (cos_alpha, sin_alpha) = (root.cos(Angle::AtX), root.sin(Angle::AtX));
    let (cos_beta, sin_beta) = (root.cos(Angle::AtY), root.sin(Angle::AtY));
    let a = outer_leg(d1, cos_alpha, cos);
    let b = outer_leg(d2, cos_beta, cos);
    let radius = ball.radius;
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
    Some(connection)
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
