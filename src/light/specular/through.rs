//! Kind 2: through a ball, with or without a reflection on its inner side.

use super::connection::Connection;
use super::deflection::{Angle, Deflection, Evaluation};
use super::equation::{Equation, MAX_TARGETS};
use super::phase::Phase;
use super::plane::{Plane, are_outside};
use super::reflection::outer_leg;
use super::root::Branch;
use super::spread::around_axis;

/// Paths that enter a ball, are reflected `INNER` times on its inner side, 0 or 1 times, and leave
/// it.
pub(super) struct Through<const INNER: u32>;

impl<const INNER: u32> Equation for Through<INNER> {
    #[inline(always)]
    fn ratios([d1, d2]: [f64; 2], ior: f64) -> [f64; 2] {
        let scale = scale(ior);
        [scale / d1, scale / d2]
    }

    /// The angle `2 i - alpha - beta - 2 (k + 1) t`: that at the centre minus `(k + 1) pi`.
    #[inline(always)]
    fn deflection([at_x, at_y]: [f64; 2], ior: f64) -> Deflection {
        let weights = [2, -1, -1, if INNER == 0 { -2 } else { -4 }];
        let inside = if ior < 1.0 { 1.0 } else { 1.0 / ior };
        Deflection::new(weights, [scale(ior), at_x, at_y, inside])
    }

    /// Half of `pi - theta`, or of `theta`.
    #[inline(always)]
    fn half_angle(cos_theta: f64, sin_theta: f64) -> Phase {
        Phase::half_of(if INNER == 0 { -cos_theta } else { cos_theta }, sin_theta)
    }

    #[inline(always)]
    fn targets(half: Phase, branches: &[Option<Branch>; 2]) -> [Option<Phase>; MAX_TARGETS] {
        if INNER == 0 {
            // psi = -(pi - theta), around the centre on the side of y, or psi = pi - theta.
            return [Some(half), Some(half.negated()), None];
        }
        // psi = -theta, theta, or theta - 2 pi; the last two only if psi reaches them.
        let reached = branches[1].as_ref().or(branches[0].as_ref()).map(|branch| {
            let [first, last] = branch.halves;
            let lowest = if branches[1].is_some() { first } else { last };
            [last.im > 0.0, lowest.re < 0.0]
        });
        let [is_high, is_low] = reached.unwrap_or_default();
        let turned = half.turned().negated();
        [Some(half), is_high.then_some(half.negated()), is_low.then_some(turned)]
    }

    #[inline(always)]
    fn connection(
        plane: &Plane,
        deflection: &Deflection,
        root: &Evaluation,
        target: usize,
    ) -> Connection {
        // On the side of y, or on the other side of the centre.
        let is_on_side = (target == 0) == (INNER == 0);
        connection(plane, INNER, deflection, root, if is_on_side { 1.0 } else { -1.0 })
    }
}

/// Returns the spread of a path that leaves x at an angle of this sine from the axis.
pub(super) fn spread<const INNER: u32>(plane: &Plane, ior: f64, sin_at_x: f64) -> Option<f64> {
    if !are_outside(plane.distances) {
        return None;
    }
    let ratios = Through::<INNER>::ratios(plane.distances, ior);
    let deflection = Through::<INNER>::deflection(ratios, ior);
    let root = deflection.eval_at(Angle::AtX, sin_at_x);
    Some(connection(plane, INNER, &deflection, &root, 1.0).spread)
}

/// The largest sine is that of `i` in dense balls and of `t` in others.
#[inline(always)]
fn scale(ior: f64) -> f64 {
    f64::min(1.0, ior)
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
    let mut connection = Connection {
        direction_at_x: plane.vector(-cos_alpha, side * sin_alpha),
        direction_at_y: plane.direction_at_y(cos_beta, side * sin_beta),
        leg_at_x: outer_leg(d1, cos_alpha, cos_i) * radius,
        chord: 2.0 * cos_t * radius,
        leg_at_y: outer_leg(d2, cos_beta, cos_i) * radius,
        cos_outside: cos_i,
        cos_inside: cos_t,
        spread: around_axis(plane, deflection, root, sin_alpha),
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
