//! Kind 3: across one boundary, from inside a ball to the outside or the other way.

use crate::geometry::Sphere;
use crate::math::DVec3;

use super::connection::Connection;
use super::deflection::{Angle, Deflection, Evaluation};
use super::phase::Phase;
use super::plane::{Plane, Target};
use super::reflection::outer_leg;
use super::spread::around_axis;

/// Finds all paths from a point inside a ball, whose index of refraction over that of its
/// surroundings is `ior`, to the outside, refracted once.
#[inline]
pub(super) fn connect_outward(
    ball: &Sphere,
    ior: f64,
    (x, y): (DVec3, Target),
    mut found: impl FnMut(Connection),
) {
    let plane = Plane::new(*ball, x, y);
    let Some([near, far]) = deflections(&plane, ior) else { return };
    let theta = Phase::half_of(plane.cos_theta, plane.sin_theta);
    let rest = Phase::half_of(-plane.cos_theta, plane.sin_theta);
    for branch in near.branches().iter().flatten() {
        if let Some(root) = near.root(branch, theta.negated()) {
            found(connection(&plane, &near, &root, [1.0, 1.0]));
        }
    }
    for branch in far.branches().iter().flatten() {
        for (half_target, side) in [(rest.negated(), 1.0), (rest, -1.0)] {
            if let Some(root) = far.root(branch, half_target.negated()) {
                found(connection(&plane, &far, &root, [-1.0, side]));
            }
        }
    }
}

/// Finds all paths from a point outside a ball to one inside, refracted once: those from inside,
/// reversed.
#[inline]
pub(super) fn connect_inward(
    ball: &Sphere,
    ior: f64,
    (x, y): (DVec3, DVec3),
    mut found: impl FnMut(Connection),
) {
    connect_outward(ball, ior, (y, Target::Point(x)), |outward| {
        found(outward.reversed(inward_spread(outward.spread, ior)));
    });
}

/// Returns the spread of a path from inside that leaves x at an angle of this cosine and sine from
/// the outward axis.
pub(super) fn outward_spread(plane: &Plane, ior: f64, [cos, sin]: [f64; 2]) -> Option<f64> {
    let [near, far] = deflections(plane, ior)?;
    let (deflection, sign) = if cos > 0.0 { (near, 1.0) } else { (far, -1.0) };
    let root = deflection.eval_at(Angle::AtX, sin);
    Some(connection(plane, &deflection, &root, [sign, 1.0]).spread)
}

/// The spread at the inner end of a path that has this spread at its outer end: the bundles of both
/// ways are equal, `n_x^2 dA_x dw_x = n_y^2 dA_y dw_y`.
#[inline(always)]
pub(super) fn inward_spread(outward_spread: f64, ior: f64) -> f64 {
    outward_spread / (ior * ior)
}

/// The angle `G = gamma - t + i - beta` where `gamma < pi / 2`, and `G - pi` where it is larger.
#[inline(always)]
fn deflections(plane: &Plane, ior: f64) -> Option<[Deflection; 2]> {
    let [d1, d2] = plane.distances;
    if !(d1 < 1.0 && d2 >= 1.0) {
        return None;
    }
    // The largest sine is that of i, or of gamma where no ray is reflected totally.
    let reach = ior * d1;
    let ratios = match reach < 1.0 {
        true => [reach, 1.0, reach / d2, d1],
        false => [1.0, 1.0 / reach, 1.0 / d2, 1.0 / ior],
    };
    Some([[1, 1, -1, -1], [1, -1, -1, -1]].map(|weights| Deflection::new(weights, ratios)))
}

/// The path of a root. `sign_gamma` is the sign of `cos gamma`; it goes around the centre on the
/// side of y (1) or on the other side (-1).
#[inline(always)]
fn connection(
    plane: &Plane,
    deflection: &Deflection,
    root: &Evaluation,
    [sign_gamma, side]: [f64; 2],
) -> Connection {
    let [d1, d2] = plane.distances;
    let radius = plane.ball.radius;
    let (cos_i, cos_t, sin_t) =
        (root.cos(Angle::Outside), root.cos(Angle::Inside), root.sin(Angle::Inside));
    let (cos_gamma, sin_gamma) = (sign_gamma * root.cos(Angle::AtX), root.sin(Angle::AtX));
    let (cos_beta, sin_beta) = (root.cos(Angle::AtY), root.sin(Angle::AtY));
    // The inner leg is cos t - d1 cos gamma.
    let inner = match cos_gamma > 0.0 {
        true => (1.0 - d1) * (1.0 + d1) / (cos_t + d1 * cos_gamma),
        false => cos_t - d1 * cos_gamma,
    };
    let mut connection = Connection {
        direction_at_x: plane.vector(cos_gamma, side * sin_gamma),
        direction_at_y: plane.direction_at_y(cos_beta, side * sin_beta),
        leg_at_x: inner * radius,
        leg_at_y: outer_leg(d2, cos_beta, cos_i) * radius,
        cos_outside: cos_i,
        cos_inside: cos_t,
        spread: around_axis(plane, deflection, root, sin_gamma),
        ..Connection::NONE
    };
    // The point is at the angle gamma - t from x.
    let point = (cos_gamma * cos_t + sin_gamma * sin_t, sin_gamma * cos_t - cos_gamma * sin_t);
    connection.push(plane.point(point.0, side * point.1));
    connection
}
