//! Intersection of a line with a sphere, in f64.

use crate::fault::fault;
use crate::math::DVec3;

/// A sphere in f64: four numbers in this order, also for C.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Sphere {
    /// Centre.
    pub center: DVec3,
    /// Radius, positive.
    pub radius: f64,
}

/// Intersections of a line with a sphere: `near <= far`, in units of the direction's length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Roots {
    /// The smaller root.
    pub near: f64,
    /// The larger root.
    pub far: f64,
}

impl Sphere {
    /// Returns the sphere with its centre relative to `origin`.
    #[inline(always)]
    pub fn relative_to(&self, origin: DVec3) -> Self {
        Self { center: self.center - origin, radius: self.radius }
    }

    /// Returns the two roots of the line `origin + t * direction`, or `None` if it misses.
    ///
    /// The discriminant comes from the centre's distance to the line and not from `b^2 - 4ac`,
    /// which cancels for small and for distant spheres (Haines et al. 2019, "Precision Improvements
    /// for Ray/Sphere Intersection", Ray Tracing Gems, ch. 7).
    pub fn roots(&self, origin: DVec3, direction: DVec3) -> Option<Roots> {
        let per_length_squared = 1.0 / direction.length_squared();
        let LineApproach { t, half_chord_squared } =
            self.closest_approach(origin, direction, per_length_squared);
        if half_chord_squared < 0.0 {
            return None;
        }
        let h = half_chord_squared.sqrt();
        Some(Roots { near: t - h, far: t + h })
    }

    /// Returns the first root in the open interval `(t_min, t_max)`.
    pub fn first_root(
        &self,
        origin: DVec3,
        direction: DVec3,
        t_min: f64,
        t_max: f64,
    ) -> Option<f64> {
        let per_length_squared = 1.0 / direction.length_squared();
        let t = self.closest_approach(origin, direction, per_length_squared).nearer_root(t_min);
        (t > t_min && t < t_max).then_some(t)
    }

    /// Returns the hit distance of a line that is known to hit: the first root beyond `t_min`; the
    /// tangent point if the line misses in f64; and never less than `t_min`.
    #[inline(always)]
    pub fn hit_distance(&self, origin: DVec3, direction: DVec3, t_min: f64) -> f64 {
        let per_length_squared = 1.0 / direction.length_squared();
        let LineApproach { t, half_chord_squared } =
            self.closest_approach(origin, direction, per_length_squared);
        let h = half_chord_squared.max(0.0).sqrt();
        let root = if t - h > t_min && !fault!(FarRootForNear) { t - h } else { t + h };
        root.max(t_min)
    }

    /// Returns the point on the sphere that a ray hits at distance `t`, and the outward normal
    /// there.
    #[inline(always)]
    pub fn reproject(&self, origin: DVec3, direction: DVec3, t: f64) -> (DVec3, DVec3) {
        // Computed from the centre: adding `origin + t * direction` first would round at the scale
        // of the coordinates, which may be far larger than that of the ray.
        let from_center = (origin - self.center) + direction * t;
        let per_length = 1.0 / from_center.length();
        let has_length = per_length > 0.0 && per_length < f64::INFINITY;
        let normal = if has_length { from_center * per_length } else { -direction };
        (self.center + normal * self.radius, normal)
    }

    /// Returns true if the point lies inside.
    #[inline(always)]
    pub fn contains(&self, point: DVec3) -> bool {
        point.distance_squared(self.center) < self.radius * self.radius
    }

    /// Returns a line's closest approach to the centre, given the reciprocal of the direction's
    /// squared length.
    #[inline(always)]
    pub fn closest_approach(
        &self,
        origin: DVec3,
        direction: DVec3,
        per_length_squared: f64,
    ) -> LineApproach {
        let to_center = self.center - origin;
        let t = to_center.dot(direction) * per_length_squared;
        let perpendicular = to_center - direction * t;
        let discriminant = self.radius * self.radius - perpendicular.length_squared();
        LineApproach { t, half_chord_squared: discriminant * per_length_squared }
    }
}

/// A line's closest approach to the centre of a sphere.
#[derive(Clone, Copy, Debug)]
pub struct LineApproach {
    /// Distance along the line, in units of the direction's length.
    pub t: f64,
    /// Square of half the chord, in the same units; negative if the line misses.
    pub half_chord_squared: f64,
}

impl LineApproach {
    /// Returns the nearer root if it lies beyond `t_min`, else the farther one, which may lie
    /// anywhere; NaN if the line misses.
    #[inline(always)]
    pub fn nearer_root(&self, t_min: f64) -> f64 {
        let h = self.half_chord_squared.sqrt();
        if self.t - h > t_min || fault!(NearRootForFar) { self.t - h } else { self.t + h }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    const UNIT: Sphere = Sphere { center: DVec3::ZERO, radius: 1.0 };

    #[test]
    fn a_ray_through_the_centre_has_both_roots() {
        let Roots { near, far } = UNIT.roots(DVec3::new(0.0, 0.0, -3.0), DVec3::Z).expect("hits");
        assert_relative_eq!(near, 2.0);
        assert_relative_eq!(far, 4.0);
    }

    #[test]
    fn from_inside_the_far_root_is_first() {
        assert_eq!(UNIT.first_root(DVec3::ZERO, DVec3::X, 0.0, f64::INFINITY), Some(1.0));
        assert_eq!(UNIT.first_root(DVec3::ZERO, DVec3::X, 0.0, 1.0), None);
    }

    #[test]
    fn the_direction_need_not_be_a_unit_vector() {
        let t = UNIT.first_root(DVec3::new(0.0, 0.0, -3.0), DVec3::Z * 4.0, 0.0, f64::INFINITY);
        assert_eq!(t, Some(0.5));
    }

    #[test]
    fn a_ghost_resolves_to_the_tangent_point() {
        let origin = DVec3::new(1.0 + 1e-9, 0.0, -3.0);
        assert_eq!(UNIT.roots(origin, DVec3::Z), None);
        assert_eq!(UNIT.hit_distance(origin, DVec3::Z, 0.0), 3.0);
        assert_eq!(UNIT.hit_distance(DVec3::new(0.0, 0.0, 2.0), DVec3::Z, 0.0), 0.0);
    }

    #[test]
    fn roots_are_in_units_of_the_direction() {
        let origin = DVec3::new(0.5, 0.0, -3.0);
        let one = UNIT.roots(origin, DVec3::Z).expect("hits");
        let four = UNIT.roots(origin, DVec3::Z * 4.0).expect("hits");
        assert_eq!([four.near * 4.0, four.far * 4.0], [one.near, one.far]);
        assert_relative_eq!(one.far - one.near, 3f64.sqrt(), max_relative = 1e-15);
        assert_eq!(UNIT.hit_distance(origin, DVec3::Z * 4.0, 0.0), four.near);
    }

    #[test]
    fn a_tangent_touches_in_one_point() {
        let roots = UNIT.roots(DVec3::new(1.0, 0.0, -3.0), DVec3::Z);
        assert_eq!(roots, Some(Roots { near: 3.0, far: 3.0 }));
    }

    #[test]
    fn a_root_at_an_end_of_the_interval_does_not_count() {
        let origin = DVec3::new(0.0, 0.0, -3.0);
        let first = |t_min, t_max| UNIT.first_root(origin, DVec3::Z, t_min, t_max);
        assert_eq!(first(0.0, 2.0), None);
        assert_eq!(first(2.0, 5.0), Some(4.0));
        assert_eq!(first(2.0, 4.0), None);
        assert_eq!(first(4.0, 5.0), None);
        assert_eq!(
            [1.9, 2.0, 4.5].map(|t| UNIT.hit_distance(origin, DVec3::Z, t)),
            [2.0, 4.0, 4.5]
        );
        assert_eq!(UNIT.hit_distance(DVec3::Z * 0.5, DVec3::Z, 0.0), 0.5, "from inside");
    }

    #[test]
    fn what_is_touched_lies_on_the_sphere_and_has_a_normal_even_where_it_has_no_direction() {
        let sphere = Sphere { center: DVec3::new(10.0, -4.0, 7.0), radius: 3.0 };
        let (point, normal) = sphere.reproject(DVec3::new(10.0, -4.0, 0.0), DVec3::Z, 4.0);
        assert_eq!((point, normal), (DVec3::new(10.0, -4.0, 4.0), -DVec3::Z));
        let (point, normal) = sphere.reproject(sphere.center, DVec3::X, 0.0);
        assert_eq!((point, normal), (DVec3::new(7.0, -4.0, 7.0), -DVec3::X));
        let beyond_f64 = sphere.reproject(DVec3::ZERO, DVec3::ONE, f64::INFINITY);
        assert_eq!(beyond_f64.1, -DVec3::ONE);
    }

    #[test]
    fn its_surface_is_not_inside() {
        let sphere = Sphere { center: DVec3::new(5.0, 0.0, 0.0), radius: 3.0 };
        let inside = [2.0, 2.1, 5.0, 7.9, 8.1].map(|x| sphere.contains(DVec3::X * x));
        assert_eq!(inside, [false, true, true, true, false]);
    }
}
