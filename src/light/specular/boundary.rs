//! Kind 3: across one boundary, from inside a ball to the outside or the other way.

use crate::geometry::Sphere;
use crate::math::DVec3;

use super::connection::{Connection, Connections};
use super::deflection::{Angle, Deflection, Evaluation};
use super::phase::Phase;
use super::plane::{Plane, Target};
use super::reflection::outer_leg;

/// Returns all paths from a point inside a ball, whose index of refraction over that of its
/// surroundings is `ior`, to the outside, refracted once.
pub fn outward(ball: &Sphere, ior: f64, x: DVec3, y: Target) -> Connections {
    let mut all = Connections::NONE;
    let plane = Plane::new(*ball, x, y);
    let [d1, d2] = plane.distances;
    if !(d1 < 1.0 && d2 >= 1.0) {
        return all;
    }
    // G = tau - t + i - beta, and near the far side of the axis, where tau > pi / 2, with pi - tau.
    // The largest sine is that of i, or of tau where there is no total reflection.
    let reach = ior * d1;
    let ratios = match reach < 1.0 {
        true => [reach, 1.0, reach / d2, d1],
        false => [1.0, 1.0 / reach, 1.0 / d2, 1.0 / ior],
    };
    let theta = Phase::half_of(plane.cos_theta, plane.sin_theta);
    let rest = Phase::half_of(-plane.cos_theta, plane.sin_theta);
    let near = Deflection::new([1, 1, -1, -1], ratios);
    for branch in near.branches().iter().flatten() {
        if let Some(root) = near.root(branch, theta.negated()) {
            all.push(connection(&plane, &near, &root, [1.0, 1.0]));
        }
    }
    let far = Deflection::new([1, -1, -1, -1], ratios);
    for branch in far.branches().iter().flatten() {
        for (half_target, side) in [(rest.negated(), 1.0), (rest, -1.0)] {
            if let Some(root) = far.root(branch, half_target.negated()) {
                all.push(connection(&plane, &far, &root, [-1.0, side]));
            }
        }
    }
    all
}

/// Returns all paths from a point outside a ball to one inside, refracted once: those of
/// [`outward`], reversed.
pub fn inward(ball: &Sphere, ior: f64, x: DVec3, y: DVec3) -> Connections {
    let mut all = Connections::NONE;
    // The bundles of both ways are the same: n_x^2 dA_x dw_x = n_y^2 dA_y dw_y.
    let per_square = 1.0 / (ior * ior);
    for connection in outward(ball, ior, y, Target::Point(x)).iter() {
        all.push(connection.reversed(connection.spread * per_square));
    }
    all
}

/// The path of a root. `sign_tau` is the sign of `cos tau`; it goes around the centre on the side
/// of y (1) or on the other side (-1).
#[inline(always)]
fn connection(
    plane: &Plane,
    deflection: &Deflection,
    root: &Evaluation,
    [sign_tau, side]: [f64; 2],
) -> Connection {
    let [d1, d2] = plane.distances;
    let radius = plane.ball.radius;
    let (cos_i, cos_t, sin_t) =
        (root.cos(Angle::Outside), root.cos(Angle::Inside), root.sin(Angle::Inside));
    let (cos_tau, sin_tau) = (sign_tau * root.cos(Angle::AtX), root.sin(Angle::AtX));
    let (cos_beta, sin_beta) = (root.cos(Angle::AtY), root.sin(Angle::AtY));
    // In the centre, v = tau at all distances.
    let ratio_x = deflection.ratio(Angle::AtX);
    let per_radian = root.slope.abs() * root.cos(Angle::AtX) / (ratio_x * root.cos_v);
    let ratio = if sin_tau > 0.0 { plane.sin_theta / sin_tau } else { per_radian };
    let (leg, area) = match d2 < f64::INFINITY {
        true => (outer_leg(d2, cos_beta, cos_i), d2 * d2 * radius * radius),
        false => (f64::INFINITY, 1.0),
    };
    // The inner leg is cos t - d1 cos tau.
    let inner = match cos_tau > 0.0 {
        true => (1.0 - d1) * (1.0 + d1) / (cos_t + d1 * cos_tau),
        false => cos_t - d1 * cos_tau,
    };
    let mut connection = Connection {
        direction_at_x: plane.vector(cos_tau, side * sin_tau),
        direction_at_y: plane.direction_at_y(cos_beta, side * sin_beta),
        leg_at_x: inner * radius,
        leg_at_y: leg * radius,
        cos_outside: cos_i,
        cos_inside: cos_t,
        spread: area * cos_beta * ratio * per_radian,
        ..Connection::NONE
    };
    // The point is at the angle tau - t from x.
    let point = (cos_tau * cos_t + sin_tau * sin_t, sin_tau * cos_t - cos_tau * sin_t);
    connection.push(plane.point(point.0, side * point.1));
    connection
}
