//! The spread of a bundle that is turned around the axis through x.

use super::deflection::{Angle, Deflection, Evaluation};
use super::plane::Plane;

/// `sin v` up to which a ray is on the axis: there, `theta` and the angle at x are proportional up
/// to the square of this, and both are too small for a direction to tell.
const ON_AXIS: f64 = 1e-7;

/// Returns `d2^2 cos(beta) |sin(theta) / sin(alpha)| |d theta / d alpha|`, without `d2^2` for a
/// direction, given the sine of the angle at x.
#[inline(always)]
pub(super) fn around_axis(
    plane: &Plane,
    deflection: &Deflection,
    root: &Evaluation,
    sin_at_x: f64,
) -> f64 {
    let per_radian = deflection.slope_at_x(root);
    let is_off_axis = root.sin_v > ON_AXIS;
    let ratio = if is_off_axis { plane.sin_theta / sin_at_x } else { per_radian };
    let (d2, radius) = (plane.distances[1], plane.ball.radius);
    let area = if d2 < f64::INFINITY { d2 * d2 * radius * radius } else { 1.0 };
    area * root.cos(Angle::AtY) * ratio * per_radian
}
