//! The cone of directions that a sphere subtends from outside, and its pdf.
//!
//! Everything is written with the chord `1 - cos`, so that an emitter of any angular size, down to
//! the smallest that f64 can represent, keeps full relative precision.

use crate::fault::fault;
use crate::math::{DVec3, Frame, renormalize};
use crate::sampling::{DiskPoint, sample_disk};

use super::Sphere;

/// The cone of directions in which a sphere is seen from a point.
#[derive(Clone, Copy, Debug)]
pub struct Cone {
    /// Unit direction to the centre of the sphere.
    axis: DVec3,
    distance: f64,
    radius: f64,
    /// `1 - cos(theta_max)`.
    one_minus_cos_max: f64,
}

/// A sampled direction towards a sphere.
#[derive(Clone, Copy, Debug)]
pub struct ConeSample {
    /// Unit direction from the point.
    pub direction: DVec3,
    /// Distance to the visible side of the sphere in that direction.
    pub distance: f64,
    /// Pdf per solid angle.
    pub pdf: f64,
}

impl Cone {
    /// Returns the cone that `sphere` subtends from `point`; `None` from inside or on it.
    #[inline(always)]
    pub fn subtending(point: DVec3, sphere: &Sphere) -> Option<Self> {
        let to_center = sphere.center - point;
        let distance = to_center.length();
        let cone = Self::from_axis(to_center, distance, sphere.radius);
        (sphere.radius < distance).then_some(cone)
    }

    /// Returns the cone of a sphere whose centre is at `to_center`, at a distance larger than its
    /// radius.
    #[inline(always)]
    pub fn from_axis(to_center: DVec3, distance: f64, radius: f64) -> Self {
        let per_distance = 1.0 / distance;
        let sin_max = radius * per_distance;
        // 1 - cos = sin^2 / (1 + cos), which does not cancel for a small angle; and
        // 1 - sin^2 = (d - R)(d + R) / d^2, which does not cancel near the surface.
        let cos_max = ((distance - radius) * (distance + radius)).sqrt() * per_distance;
        let cos_max = if fault!(ConeSmallAngle) { 1.0 } else { cos_max };
        Self {
            axis: to_center * per_distance,
            distance,
            radius,
            one_minus_cos_max: sin_max * sin_max / (1.0 + cos_max),
        }
    }

    /// Returns the unit direction to the centre of the sphere.
    #[inline(always)]
    pub fn axis(&self) -> DVec3 {
        self.axis
    }

    /// Returns the distance from the point to the nearest point of the sphere.
    #[inline(always)]
    pub fn nearest_distance(&self) -> f64 {
        self.distance - self.radius
    }

    /// Returns the sine and cosine of the angle between axis and rim.
    #[inline(always)]
    pub fn sin_cos_max(&self) -> [f64; 2] {
        [self.radius / self.distance, 1.0 - self.one_minus_cos_max]
    }

    /// Returns the distance to the visible side of the sphere in a direction within the cone.
    #[inline(always)]
    pub fn distance_along(&self, direction: DVec3) -> f64 {
        let cos = direction.dot(self.axis);
        let across = direction - self.axis * cos;
        self.distance_to_sphere(across.length_squared(), cos)
    }

    /// Returns the solid angle in steradians, `2 pi (1 - cos)`.
    #[inline(always)]
    pub fn solid_angle(&self) -> f64 {
        std::f64::consts::TAU * self.one_minus_cos_max
    }

    /// Returns the pdf of [`Self::sample`] for a direction inside the cone.
    #[inline(always)]
    pub fn pdf(&self) -> f64 {
        1.0 / self.solid_angle()
    }

    /// Samples a direction uniformly over the cone's solid angle, from `u` in `[0, 1)^2`.
    #[inline(always)]
    pub fn sample(&self, u: [f64; 2]) -> ConeSample {
        let DiskPoint { point, squared, .. } = sample_disk(u);
        // The sine is the distance from the middle of the disk times `stretch`.
        let share = if fault!(ConeUniformInAngle) { squared } else { 1.0 };
        let one_minus_cos = squared * share * self.one_minus_cos_max;
        let sin_squared = one_minus_cos * (2.0 - one_minus_cos);
        let stretch = (share * self.one_minus_cos_max * (2.0 - one_minus_cos)).max(0.0).sqrt();
        let cos = 1.0 - one_minus_cos;
        let local = DVec3::new(stretch * point[0], stretch * point[1], cos);
        ConeSample {
            direction: renormalize(Frame::from_z(self.axis).to_world(local)),
            distance: self.distance_to_sphere(sin_squared, cos),
            pdf: self.pdf(),
        }
    }

    /// Returns the distance to the nearer intersection with the sphere, at an angle from the axis:
    /// `d cos - sqrt(R^2 - d^2 sin^2)`, written as `(d^2 - R^2) / (d cos + sqrt(..))` to avoid
    /// cancellation.
    #[inline(always)]
    fn distance_to_sphere(&self, sin_squared: f64, cos: f64) -> f64 {
        let (d, r) = (self.distance, self.radius);
        let half_chord = (r * r - d * d * sin_squared).max(0.0).sqrt();
        (d - r) * (d + r) / (d * cos + half_chord)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn the_solid_angle_is_right_for_tiny_and_for_wide_cones() {
        let solid_angle_at = |d: f64| {
            let sphere = Sphere { center: DVec3::new(0.0, 0.0, d), radius: 1.0 };
            Cone::subtending(DVec3::ZERO, &sphere).expect("outside").solid_angle()
        };
        // Far away: pi R^2 / d^2. On the surface: a half space.
        assert_relative_eq!(
            solid_angle_at(1e8),
            std::f64::consts::PI * 1e-16,
            max_relative = 1e-14
        );
        assert_relative_eq!(
            solid_angle_at(1.0 + 1e-14),
            std::f64::consts::TAU,
            max_relative = 1e-6
        );
        assert_relative_eq!(
            solid_angle_at(2.0),
            std::f64::consts::TAU * (1.0 - 0.75f64.sqrt()),
            max_relative = 1e-14
        );
    }

    #[test]
    fn samples_lie_on_the_visible_side() {
        let sphere = Sphere { center: DVec3::new(3.0, -2.0, 5.0), radius: 2.0 };
        let cone = Cone::subtending(DVec3::ZERO, &sphere).expect("outside");
        for i in 0..100 {
            let u = [f64::from(i) / 100.0, f64::from(i * 37 % 100) / 100.0];
            let ConeSample { direction, distance, .. } = cone.sample(u);
            let point = direction * distance;
            assert_relative_eq!(point.distance(sphere.center), 2.0, max_relative = 1e-9);
            assert!((point - sphere.center).dot(direction) <= 1e-6);
        }
    }

    #[test]
    fn a_cone_is_that_of_its_sphere_wherever_it_is_seen_from() {
        let sphere = Sphere { center: DVec3::new(3.0, -2.0, 5.0), radius: 3.0 };
        let point = DVec3::new(-1.0, 4.0, 2.0);
        let cone = Cone::subtending(point, &sphere).expect("outside");
        let distance = sphere.center.distance(point);
        let cos_max = (1.0 - 9.0 / (distance * distance)).sqrt();
        assert_relative_eq!(
            cone.solid_angle(),
            std::f64::consts::TAU * (1.0 - cos_max),
            max_relative = 1e-14
        );
        assert_eq!(cone.pdf(), 1.0 / cone.solid_angle());
        let axis = (sphere.center - point) / distance;
        for i in 0..100 {
            let u = [i, i * 37 % 100].map(|i| (f64::from(i) + 0.5) / 100.0);
            let sample = cone.sample(u);
            // Uniform in the chord from the axis to the rim.
            let chord = 1.0 - sample.direction.dot(axis);
            let share = sample_disk(u).squared;
            assert!((chord - share * (1.0 - cos_max)).abs() < 1e-14);
            let roots = sphere.roots(point, sample.direction).expect("inside the cone");
            assert_relative_eq!(sample.distance, roots.near, max_relative = 1e-12);
            assert_eq!(sample.pdf, cone.pdf());
        }
    }

    #[test]
    fn there_is_no_cone_from_inside() {
        let sphere = Sphere { center: DVec3::new(1.0, 0.0, 0.0), radius: 2.0 };
        for x in [1.0, 2.0, 3.0] {
            assert!(Cone::subtending(DVec3::new(x, 0.0, 0.0), &sphere).is_none(), "{x}");
        }
        assert!(Cone::subtending(DVec3::NAN, &sphere).is_none());
    }
}
