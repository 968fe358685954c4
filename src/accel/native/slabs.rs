//! A ray as the nodes' boxes see it: in f32, and such that no box is missed.
//!
//! Along each axis a ray enters a box at `(p - o) / u`, with `p` the plane it meets first, and
//! leaves it at the other plane. Distances here are lengths, `u` is the unit direction. Three
//! things keep the answer conservative:
//!
//! * The origin is moved away from the box by `F32_SLACK |o|`, which covers its own rounding to f32,
//!   plus the part `F64_SLACK |o|` that [`super::node::Node::set`] leaves to the ray; upwards for
//!   entering and downwards for leaving, if `u > 0`. So `p - o` is too small, or too large.
//! * `1 / u` is taken in f64 and made smaller for entering, larger for leaving, by `F32_SLACK`:
//!   four times the roundings of `1 / u`, of the difference and of the product. An entry before
//!   the origin may come out too late, but never after the origin.
//! * Components of `u` below 2^-60 are raised to that. It moves a point at distance `t` by `2^-60
//!   t`, which is far less than `F64_SLACK (|o| + |p|)`. There is no division by zero and no NaN:
//!   differences stay below 2^53 in a scene (`MAX_COORDINATE`), products below 2^113. Even the
//!   infinite planes of unused lanes only give infinities.

use crate::math::DVec3;

use super::bounds::{larger, smaller};
use super::node::{F32_SLACK, F64_SLACK, Node, TINY, WIDTH, lanes_where};

/// One ray against boxes.
pub(super) struct Slabs {
    axes: [Axis; 3],
    /// Distances are not before this.
    t_min: f32,
    /// The length of the ray's own direction.
    length: f64,
}

/// What the ray does along one axis.
#[derive(Clone, Copy)]
struct Axis {
    /// Which of a node's planes it enters by.
    enter: usize,
    /// Which of a node's planes it leaves by.
    leave: usize,
    enter_origin: f32,
    leave_origin: f32,
    enter_inverse: f32,
    leave_inverse: f32,
}

/// The boxes that a ray meets.
pub(super) struct Met {
    /// Where each box is entered; not negative for those that are met.
    pub(super) t: [f32; WIDTH],
    /// The lanes of those that are met, as bits.
    pub(super) lanes: u32,
}

impl Slabs {
    /// `unit` times `length` is the ray's direction, in whose units `t_min` is.
    pub(super) fn new(origin: DVec3, unit: DVec3, length: f64, t_min: f64) -> Self {
        let everywhere = F64_SLACK * origin.abs().max_element() + TINY;
        let axis = |axis: usize| {
            let (o, u) = (origin[axis], unit[axis]);
            let slack = (F32_SLACK * o.abs() + everywhere).copysign(u);
            let inverse = 1.0 / u.abs().max(SMALLEST).copysign(u);
            let (low, high) = (axis, axis + 3);
            let (enter, leave) = if u.is_sign_negative() { (high, low) } else { (low, high) };
            Axis {
                enter,
                leave,
                enter_origin: (o + slack) as f32,
                leave_origin: (o - slack) as f32,
                enter_inverse: (inverse * (1.0 - F32_SLACK)) as f32,
                leave_inverse: (inverse * (1.0 + F32_SLACK)) as f32,
            }
        };
        let t_min = (t_min * length * (1.0 - F32_SLACK) - TINY).max(0.0) as f32;
        Self { axes: [axis(0), axis(1), axis(2)], t_min, length }
    }

    /// The distance up to which boxes matter when hits matter up to `t`.
    pub(super) fn limit(&self, t: f64) -> f32 {
        (t * self.length * (1.0 + F32_SLACK) + TINY) as f32
    }

    /// The boxes of a node that are met before `limit`.
    #[inline(always)]
    pub(super) fn meet(&self, node: &Node, limit: f32) -> Met {
        let mut t = [self.t_min; WIDTH];
        let mut end = [limit; WIDTH];
        for axis in &self.axes {
            let (enter, leave) = (&node.planes[axis.enter], &node.planes[axis.leave]);
            for lane in 0..WIDTH {
                let entry = (enter[lane] - axis.enter_origin) * axis.enter_inverse;
                let exit = (leave[lane] - axis.leave_origin) * axis.leave_inverse;
                t[lane] = larger(entry, t[lane]);
                end[lane] = smaller(exit, end[lane]);
            }
        }
        Met { t, lanes: lanes_where::<WIDTH>(|lane| t[lane] <= end[lane]) }
    }
}

/// The smallest component of a direction that is told from zero, 2^-60.
const SMALLEST: f64 = 1.0 / (1u64 << 60) as f64;

#[cfg(test)]
mod tests {
    use super::super::bounds::Bounds;
    use super::super::node::Child;
    use super::*;

    fn cube() -> Node {
        let mut node = Node::EMPTY;
        let bounds = Bounds { low: [1.0, 2.0, 3.0, 0.0], high: [2.0, 3.0, 4.0, 0.0] };
        node.set(0, &bounds, Child::node(0));
        node
    }

    fn lanes(origin: [f64; 3], direction: [f64; 3], limit: f32) -> u32 {
        let slabs = Slabs::new(origin.into(), direction.into(), 1.0, 0.0);
        slabs.meet(&cube(), limit).lanes
    }

    #[test]
    fn rays_along_an_axis_meet_the_box_between_and_on_its_planes() {
        for zero in [0.0, -0.0, 1e-300, -1e-300] {
            for y in [2.0, 2.5, 3.0] {
                assert_eq!(lanes([-5.0, y, 3.0], [1.0, zero, zero], f32::INFINITY), 1);
                assert_eq!(lanes([5.0, y, 4.0], [-1.0, zero, zero], f32::INFINITY), 1);
            }
            assert_eq!(lanes([-5.0, 1.99, 3.0], [1.0, zero, zero], f32::INFINITY), 0);
            assert_eq!(lanes([5.0, 2.5, 3.5], [1.0, zero, zero], f32::INFINITY), 0);
        }
    }

    #[test]
    fn boxes_beyond_the_limit_are_not_met() {
        assert_eq!(lanes([-5.0, 2.5, 3.5], [1.0, 0.0, 0.0], 5.9), 0);
        assert_eq!(lanes([-5.0, 2.5, 3.5], [1.0, 0.0, 0.0], 6.0), 1);
    }

    #[test]
    fn an_origin_inside_or_on_the_box_meets_it_at_once() {
        for origin in [[1.5, 2.5, 3.5], [1.0, 2.0, 3.0], [2.0, 3.0, 4.0]] {
            for direction in [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.6, 0.0, -0.8]] {
                assert_eq!(lanes(origin, direction, 0.0), 1);
            }
        }
    }
}
