//! Kind 2: through a ball, with or without a reflection on its inner side.

use crate::geometry::Sphere;
use crate::math::DVec3;

use super::connection::Connection;
use super::deflection::{Angle, Deflection, Evaluation, ON_AXIS};
use super::phase::Phase;
use super::plane::{Plane, Target};
use super::reflection::outer_leg;

/// Finds all paths between two points outside of a ball, whose index of refraction over that of its
/// surroundings is `ior`, that enter it, are reflected `inner` times on its inner side, 0 or 1
/// times, and leave it.
#[inline]
pub(super) fn connect(
    ball: &Sphere,
    ior: f64,
    inner: u32,
    (x, y): (DVec3, Target),
    mut found: impl FnMut(Connection),
) {
    let plane = Plane::new(*ball, x, y);
    let Some(deflection) = deflection(&plane, ior, inner) else { return };
    let (cos, sin) = (plane.cos_theta, plane.sin_theta);
    let branches = deflection.branches();
    let mut connect = |half_target: Phase, side: f64| {
        for branch in branches.iter().flatten() {
            if let Some(root) = deflection.root(branch, half_target.negated()) {
                found(connection(&plane, inner, &deflection, &root, side));
            }
        }
    };
    if inner == 0 {
        // psi = -(pi - theta), around the centre on the side of y, or psi = pi - theta.
        let rest = Phase::half_of(-cos, sin);
        connect(rest.negated(), 1.0);
        connect(rest, -1.0);
    } else {
        // psi = -theta, theta, or theta - 2 pi; the last two only if psi reaches them.
        let theta = Phase::half_of(cos, sin);
        let lowest = branches[1].as_ref().or(branches[0].as_ref()).map(|branch| branch.halves());
        connect(theta.negated(), -1.0);
        if let Some([first, last]) = lowest {
            let lowest = if branches[1].is_some() { first } else { last };
            if last.im > 0.0 {
                connect(theta, 1.0);
            }
            if lowest.re < 0.0 {
                connect(theta.turned(), 1.0);
            }
        }
    }
}

/// Returns the spread of a path that leaves x at an angle of this sine from the axis.
pub(super) fn spread(plane: &Plane, ior: f64, inner: u32, sin_at_x: f64) -> Option<f64> {
    let deflection = deflection(plane, ior, inner)?;
    let root = deflection.eval_at(Angle::AtX, sin_at_x);
    Some(connection(plane, inner, &deflection, &root, 1.0).spread)
}

/// The angle `2 i - alpha - beta - 2 (k + 1) t`: that at the centre minus `(k + 1) pi`.
#[inline(always)]
fn deflection(plane: &Plane, ior: f64, inner: u32) -> Option<Deflection> {
    let [d1, d2] = plane.distances;
    if !(d1 >= 1.0 && d2 >= 1.0) {
        return None;
    }
    // The largest sine is that of i in dense balls and of t in others.
    let scale = f64::min(1.0, ior);
    let weights = [2, -1, -1, if inner == 0 { -2 } else { -4 }];
    let inside = if ior < 1.0 { 1.0 } else { 1.0 / ior };
    Some(Deflection::new(weights, [scale, scale / d1, scale / d2, inside]))
}

/// The path of a root that goes around the centre on the side of y (1) or on the other side (-1).
#[inline(always)]
fn connection(
    plane: &Plane,
    inner: u32,
    deflection: &Deflection,
    root: &Evaluation,
    side: f64,
) -> Connection {
    let [d1, d2] = plane.distances;
    let radius = plane.ball.radius;
    let (cos_i, sin_i) = (root.cos(Angle::Outside), root.sin(Angle::Outside));
    let (cos_t, sin_t) = (root.cos(Angle::Inside), root.sin(Angle::Inside));
    let (cos_alpha, sin_alpha) = (root.cos(Angle::AtX), root.sin(Angle::AtX));
    let (cos_beta, sin_beta) = (root.cos(Angle::AtY), root.sin(Angle::AtY));
    let per_radian = deflection.slope_at_x(root);
    let ratio = match root.sin_v > ON_AXIS {
        true => plane.sin_theta / sin_alpha,
        false => per_radian,
    };
    let (leg, area) = match d2 < f64::INFINITY {
        true => (outer_leg(d2, cos_beta, cos_i), d2 * d2 * radius * radius),
        false => (f64::INFINITY, 1.0),
    };
    let mut connection = Connection {
        direction_at_x: plane.vector(-cos_alpha, side * sin_alpha),
        direction_at_y: plane.direction_at_y(cos_beta, side * sin_beta),
        leg_at_x: outer_leg(d1, cos_alpha, cos_i) * radius,
        chord: 2.0 * cos_t * radius,
        leg_at_y: leg * radius,
        cos_outside: cos_i,
        cos_inside: cos_t,
        spread: area * cos_beta * ratio * per_radian,
        ..Connection::NONE
    };
    // The first point is at the angle i - alpha from x; each chord goes on by pi - 2 t.
    let mut point =
        Phase::of(cos_i * cos_alpha + sin_i * sin_alpha, sin_i * cos_alpha - cos_i * sin_alpha);
    let half_turn = Phase::of(sin_t, cos_t);
    connection.push(plane.point(point.re, side * point.im));
    for _ in 0..=inner {
        point = point * half_turn * half_turn;
        connection.push(plane.point(point.re, side * point.im));
    }
    connection
}
