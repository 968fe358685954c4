//! Glass balls around the camera, in which totally reflected light may be trapped.
//!
//! A chord of a sphere is reflected into chords of equal length in one plane, all at the distance
//! `R sin t` from the centre, where `t` is the angle to the normal. If reflection is total and no
//! other surface reaches the ring between that distance and `R`, the path never leaves the ball and
//! finds no light.
//!
//! Only the camera can start such a path: a surface that sends light along a chord reaches the ring
//! itself, and light that enters a ball can leave it at the same angle.

use rayon::prelude::*;

use crate::fault::fault;
use crate::geometry::{Sphere, SphereSet};
use crate::math::DVec3;

/// Balls in which more spheres reach total reflection are not examined. In most planes they are
/// close to each other, so that light soon finds one.
const MAX_CONTENTS: usize = 1 << 16;

/// So many contents are tested at each reflection; more only at each [`PERIOD`]th in succession, as
/// the test may then take as long as a few edges of a path.
const FEW_CONTENTS: usize = 64;

/// Number of reflections in succession from one test of many contents to the next.
const PERIOD: u16 = 64;

/// Distance, in radii, at which a surface counts as reaching the ring: far more than rounding.
const SLACK: f64 = 1e-6;

/// A smooth dielectric ball that emits no light.
#[derive(Debug)]
pub(super) struct LightTrap {
    id: u32,
    ball: Sphere,
    /// The other spheres whose surfaces reach into the ball as far out as total reflection does.
    contents: Vec<Sphere>,
}

impl LightTrap {
    /// `None` if the ball has too many contents. Light is totally reflected only at sines of at
    /// least `critical_sine`.
    pub(super) fn new(spheres: &SphereSet, id: u32, critical_sine: f64) -> Option<Self> {
        let ball = spheres.sphere(id);
        let critical_radius = ball.radius * (critical_sine - SLACK);
        let reaches_in = |sphere: &Sphere| {
            let distance = sphere.center.distance(ball.center);
            (distance - sphere.radius).abs() <= ball.radius * (1.0 + SLACK)
                && distance + sphere.radius >= critical_radius
        };
        let others = (0..spheres.len() as u32).into_par_iter().filter(|&other| other != id);
        let contents = others.map(|other| spheres.sphere(other)).filter(reaches_in);
        let contents: Vec<Sphere> = contents.take_any(MAX_CONTENTS + 1).collect();
        (contents.len() <= MAX_CONTENTS).then_some(Self { id, ball, contents })
    }

    /// Returns true if light that is totally reflected at a point of this sphere, into a unit
    /// direction, is known to hit nothing but this sphere ever after. `count` is the number of
    /// total reflections in succession, with this one.
    pub(super) fn holds(&self, id: u32, point: DVec3, direction: DVec3, count: u16) -> bool {
        // What one reflection finds, the next ones find again: plane and ring stay.
        let is_due = self.contents.len() <= FEW_CONTENTS || count % PERIOD == 0;
        if id != self.id || !is_due {
            return false;
        }
        let normal = (point - self.ball.center).cross(direction);
        let inner_radius = normal.length();
        let plane = normal / inner_radius;
        let reaches = |sphere: &Sphere| self.reaches_ring(sphere, plane, inner_radius);
        fault!(TrapEverywhere) || !self.contents.iter().any(reaches)
    }

    /// Returns true if a sphere cuts the plane through the ball's centre in a circle that reaches
    /// the ring from `inner_radius` to the ball's surface.
    fn reaches_ring(&self, sphere: &Sphere, plane: DVec3, inner_radius: f64) -> bool {
        let slack = SLACK * self.ball.radius;
        let offset = sphere.center - self.ball.center;
        let height = offset.dot(plane);
        let radius_squared = (sphere.radius + height) * (sphere.radius - height);
        if radius_squared < -slack * (sphere.radius + slack) {
            return false;
        }
        let radius = radius_squared.max(0.0).sqrt();
        let distance = (offset - plane * height).length();
        (distance - radius).abs() <= self.ball.radius + slack
            && distance + radius >= inner_radius - slack
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::SphereRows;

    fn ball(center: [f64; 3], radius: f64) -> Sphere {
        Sphere { center: center.into(), radius }
    }

    /// A ball of radius 2 around the origin, in row 0, with other spheres.
    fn trap(others: &[Sphere]) -> LightTrap {
        let exact = [&[ball([0.0; 3], 2.0)], others].concat();
        let set = SphereSet::new(SphereRows { exact, table: vec![] }).expect("few spheres");
        let id = (0..set.len() as u32).find(|&id| set.row(id) == 0).expect("row 0");
        LightTrap::new(&set, id, 2.0 / 3.0).expect("few contents")
    }

    /// A chord in the plane z = 0 whose distance from the centre is 1.6.
    fn holds(others: &[Sphere]) -> bool {
        let trap = trap(others);
        let (point, along) = (DVec3::new(2.0, 0.0, 0.0), DVec3::new(-0.6, 0.8, 0.0));
        trap.holds(trap.id, point + trap.ball.center, along, 1)
    }

    #[test]
    fn what_reaches_the_ring_in_its_plane_frees_light() {
        assert!(holds(&[]));
        for (name, other, expected) in [
            ("around it", ball([1.0, 0.0, 0.0], 3.1), true),
            ("around it and touching it", ball([1.0, 0.0, 0.0], 3.0), false),
            ("beside it", ball([5.0, 0.0, 0.0], 2.9), true),
            ("touching it", ball([5.0, 0.0, 0.0], 3.0), false),
            ("across its surface", ball([2.0, 0.0, 0.0], 0.1), false),
            ("in the ring", ball([-1.8, 0.0, 0.0], 0.1), false),
            ("in the middle", ball([1.0, 0.0, 0.0], 0.59), true),
            ("from the middle to the ring", ball([1.0, 0.0, 0.0], 0.61), false),
            ("around the ring's hole", ball([0.0; 3], 1.5), true),
            ("in the ring, concentric", ball([0.0; 3], 1.7), false),
            ("above the plane", ball([1.8, 0.0, 0.3], 0.29), true),
            ("into the plane", ball([1.8, 0.0, 0.3], 0.31), false),
            ("across the surface above the plane", ball([1.5, 0.0, 1.5], 0.5), true),
        ] {
            assert_eq!(holds(&[other]), expected, "{name}");
        }
    }

    #[test]
    fn another_sphere_holds_nothing() {
        let alone = trap(&[]);
        let along = DVec3::new(-0.6, 0.8, 0.0);
        assert!(!alone.holds(alone.id + 1, DVec3::X * 2.0, along, 1));
    }

    /// Up to 1.2 from the centre none is in the way of total reflection, at sines of at least 2/3.
    #[test]
    fn of_many_contents_those_count_that_total_reflection_may_reach() {
        let grain = |i: u32| ball([0.01 * f64::from(i), 0.0, 0.0], 1e-3);
        let within: Vec<Sphere> = (0..120).map(grain).collect();
        assert!(trap(&within).contents.is_empty());
        assert!(holds(&within));
        // Across the ring, but above the plane: tested where enough reflections went before.
        let above = |i: u32| ball([1.4, 0.0, 0.1 + 1e-3 * f64::from(i)], 1e-4);
        let trap = trap(&(0..65).map(above).collect::<Vec<_>>());
        assert_eq!(trap.contents.len(), 65);
        let (point, along) = (DVec3::new(2.0, 0.0, 0.0), DVec3::new(-0.6, 0.8, 0.0));
        let holds = |count| trap.holds(trap.id, point + trap.ball.center, along, count);
        assert_eq!([1, 63, 64, 65, 128].map(holds), [false, false, true, false, true]);
    }
}
