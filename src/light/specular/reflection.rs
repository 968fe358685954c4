//! Kind 1: reflection off the outside of a ball.

use crate::geometry::Sphere;
use crate::math::DVec3;

use super::connection::Connection;
use super::deflection::{Angle, Deflection, Evaluation};
use super::phase::Phase;
use super::plane::{Plane, Target};

/// Returns the reflection off the outside of a ball that connects two points outside of it; `None`
/// if the straight line between them meets the ball.
pub(super) fn connect(ball: &Sphere, x: DVec3, y: Target) -> Option<Connection> {
    let plane = Plane::new(*ball, x, y);
    let deflection = deflection(&plane)?;
    let theta = Phase::half_of(plane.cos_theta, plane.sin_theta);
    let branch = deflection.branches()[0]?;
    let root = deflection.root(&branch, theta.negated())?;
    Some(connection(&plane, &root))
}

/// Returns the spread of a reflection that leaves x at an angle of this sine from the axis.
pub(super) fn spread(plane: &Plane, sin_at_x: f64) -> Option<f64> {
    let root = deflection(plane)?.eval_at(Angle::AtX, sin_at_x);
    Some(connection(plane, &root).spread)
}

/// The angle `2 i - alpha - beta` at the centre.
#[inline(always)]
fn deflection(plane: &Plane) -> Option<Deflection> {
    let [d1, d2] = plane.distances;
    let is_outside = d1 >= 1.0 && d2 >= 1.0;
    is_outside.then(|| Deflection::new([2, -1, -1, 0], [1.0, 1.0 / d1, 1.0 / d2, 0.0]))
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
