//! The exposed cap of a sphere that another sphere cuts, and sampling of its area from a point.
//!
//! Two spheres that cut each other meet in a circle, whose plane divides each of them into two
//! caps. Where the other sphere is opaque, points outside it see the cap outside it, points inside
//! it the cap inside it.

use std::f64::consts::TAU;

use crate::fault::fault;
use crate::math::{DVec3, Frame};
use crate::sampling::{DiskPoint, sample_disk};

use super::cone::{Cone, ConeSample};
use super::{Side, Sphere};

/// A cap is sampled if the pdf of its cone is at most this many times the least pdf of the cap.
/// The mean pdf over a cap is about twice the least one.
const CAP_ADVANTAGE: f64 = 2.0;

/// Where an opaque sphere cuts another one.
#[derive(Clone, Copy, Debug)]
pub struct SphereCut {
    /// Unit vector from the centre of the sphere that is cut to that of the opaque one.
    axis: DVec3,
    /// Heights of the caps outside and inside the opaque sphere, in radii of the sphere that is
    /// cut; together 2.
    heights: [f64; 2],
}

/// A cap of a sphere.
#[derive(Clone, Copy, Debug)]
pub struct Cap {
    /// Unit vector from the centre of the sphere through the middle of the cap.
    axis: DVec3,
    /// Height in radii: `1 - cos` of the rim's angle from the axis.
    height: f64,
}

/// A cap of a sphere, seen from a point outside the sphere.
#[derive(Clone, Copy, Debug)]
pub struct VisibleCap {
    cap: Cap,
    radius: f64,
    to_center: DVec3,
}

impl SphereCut {
    /// Returns where `opaque` cuts `sphere`; `None` if their surfaces have no circle in common.
    pub fn new(sphere: &Sphere, opaque: &Sphere) -> Option<Self> {
        let to_opaque = opaque.center - sphere.center;
        let (d, r, big_r) = (to_opaque.length(), sphere.radius, opaque.radius);
        // The plane of the circle lies at (d^2 + r^2 - R^2) / 2d from the centre. Factorised, the
        // heights do not cancel, however large R is.
        let per_diameters = 0.5 / (d * r);
        let outside = (d + r - big_r) * (d + r + big_r) * per_diameters;
        let inside = (big_r - d + r) * (big_r + d - r) * per_diameters;
        let is_cut = outside > 0.0 && inside > 0.0 && outside < f64::INFINITY;
        is_cut.then(|| Self { axis: to_opaque / d, heights: [outside, inside] })
    }

    /// Returns the height of the cap on one side of the opaque sphere, in radii of the sphere that
    /// is cut. The sphere's area is 2 in that unit.
    #[inline(always)]
    pub fn height(&self, side: Side) -> f64 {
        self.heights[side as usize]
    }

    /// Returns the cap that is seen from one side of the opaque sphere.
    pub fn exposed_cap(&self, side: Side) -> Cap {
        let axis = if side == Side::Outside { -self.axis } else { self.axis };
        Cap { axis, height: self.height(side) }
    }
}

impl Cap {
    /// The whole sphere.
    pub const WHOLE: Self = Self { axis: DVec3::Z, height: 2.0 };

    /// Returns the height in radii: 2 for the whole sphere.
    #[inline(always)]
    pub fn height(&self) -> f64 {
        self.height
    }

    /// Returns a sphere around this cap of a sphere, no larger than the sphere itself: around the
    /// rim if the cap is less than half of it.
    pub fn bounds(&self, sphere: &Sphere) -> Sphere {
        if self.height >= 1.0 {
            return *sphere;
        }
        let sin_rim = (self.height * (2.0 - self.height)).sqrt();
        let center = sphere.center + self.axis * ((1.0 - self.height) * sphere.radius);
        Sphere { center, radius: sin_rim * sphere.radius }
    }

    /// Returns this cap of a sphere as seen from a point outside that sphere.
    #[inline(always)]
    pub fn seen_from(&self, point: DVec3, sphere: &Sphere) -> VisibleCap {
        VisibleCap { cap: *self, radius: sphere.radius, to_center: sphere.center - point }
    }
}

impl VisibleCap {
    /// Area of the cap, `2 pi r^2 h` with the height h in radii.
    #[inline(always)]
    fn area(&self) -> f64 {
        TAU * self.radius * self.radius * self.cap.height
    }

    /// Returns true if a sample of the cap's area is expected to have less variance than one of the
    /// cone that the whole sphere subtends.
    ///
    /// Both pdfs are compared at the point of the cap that is nearest to the shading point, where
    /// that of the cap is least.
    #[inline(always)]
    pub fn is_narrower_than(&self, cone: &Cone) -> bool {
        let is_part = self.cap.height < Cap::WHOLE.height;
        let of_cone = CAP_ADVANTAGE * cone.solid_angle();
        // No point of the sphere is nearer, and no cosine is larger than 1.
        let bound = cone.nearest_distance();
        is_part && (self.area() < of_cone * bound * bound || self.is_narrower_by_nearest(of_cone))
    }

    #[inline(always)]
    fn is_narrower_by_nearest(&self, of_cone: f64) -> bool {
        let Cap { axis, height } = self.cap;
        let towards = self.to_center * (-1.0 / self.to_center.length());
        // In the plane of the axis and the shading point.
        let along = towards.dot(axis);
        let across = towards - axis * along;
        let cos_rim = 1.0 - height;
        let sin_rim = (height * (2.0 - height)).max(0.0).sqrt();
        let rim = axis * cos_rim + across * (sin_rim / across.length().max(f64::MIN_POSITIVE));
        let nearest = if along >= cos_rim { towards } else { rim };
        let to_nearest = self.to_center + nearest * self.radius;
        let squared = to_nearest.length_squared();
        let cos = (-to_nearest.dot(nearest)).max(0.0) / squared.sqrt();
        self.area() * cos < of_cone * squared
    }

    /// Samples a point uniformly over the cap's area, from `u` in `[0, 1)^2`, and returns its
    /// direction; the pdf is 0 if the point faces away.
    #[inline(always)]
    pub fn sample(&self, u: [f64; 2]) -> ConeSample {
        let Cap { axis, height } = self.cap;
        let axis = if fault!(CapComplement) { -axis } else { axis };
        let height = if fault!(CapComplement) { 2.0 - height } else { height };
        let DiskPoint { point, squared, .. } = sample_disk(u);
        let one_minus_cos = squared * height;
        let stretch = (height * (2.0 - one_minus_cos)).max(0.0).sqrt();
        let local = DVec3::new(stretch * point[0], stretch * point[1], 1.0 - one_minus_cos);
        let normal = Frame::from_z(axis).to_world(local);
        let to_point = self.to_center + normal * self.radius;
        let distance = to_point.length();
        let direction = to_point * (1.0 / distance);
        ConeSample { direction, distance, pdf: self.area_pdf(distance, -normal.dot(direction)) }
    }

    /// Returns the pdf of [`Self::sample`] for a direction that hits the sphere.
    pub fn pdf(&self, direction: DVec3) -> f64 {
        let Cap { axis, height } = self.cap;
        let sphere = Sphere { center: self.to_center, radius: self.radius };
        let Some(roots) = sphere.roots(DVec3::ZERO, direction) else { return 0.0 };
        let normal = (direction * roots.near - self.to_center) / self.radius;
        // The squared chord from the middle of the cap is twice the height.
        let is_in_cap = normal.distance_squared(axis) <= 2.0 * height;
        if is_in_cap { self.area_pdf(roots.near, -normal.dot(direction)) } else { 0.0 }
    }

    /// Returns the pdf per solid angle of a point of the cap: `t^2 / (A cos)`, 0 if it faces away.
    #[inline(always)]
    fn area_pdf(&self, distance: f64, cos: f64) -> f64 {
        let projected = self.area() * if fault!(CapPdfWithoutCosine) { 1.0 } else { cos };
        let pdf = distance * distance / projected;
        if cos > 0.0 { pdf } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    fn ball(x: f64, radius: f64) -> Sphere {
        Sphere { center: DVec3::new(x, 0.0, 0.0), radius }
    }

    #[test]
    fn two_spheres_cut_each_other_if_their_surfaces_do() {
        let height = |x, radius, side| {
            let cut = SphereCut::new(&ball(0.0, 2.0), &ball(x, radius))?;
            Some(cut.height(side) * 2.0)
        };
        // In halves, by a plane at x = 1, and by one at x = 1.5.
        assert_relative_eq!(height(2.0, 8f64.sqrt(), Side::Inside).expect("a cut"), 2.0);
        assert_relative_eq!(height(2.0, 2.0, Side::Inside).expect("a cut"), 1.0);
        assert_relative_eq!(height(2.0, 2.0, Side::Outside).expect("a cut"), 3.0);
        assert_relative_eq!(
            height(3.0, 2f64.sqrt() * 2.0 - 1.0, Side::Inside).expect("a cut"),
            2.0 - (13.0 - (2f64.sqrt() * 2.0 - 1.0).powi(2)) / 6.0
        );
        // Apart, touching, and one in the other, both ways.
        for (x, radius) in [(5.0, 2.0), (4.0, 2.0), (0.5, 1.0), (1.0, 1.0), (0.5, 9.0), (0.0, 2.0)]
        {
            assert!(height(x, radius, Side::Inside).is_none(), "{x} {radius}");
        }
    }

    #[test]
    fn the_cap_below_a_huge_wall_keeps_its_digits() {
        let wall = Sphere { center: DVec3::new(50.0, -99918.4, 81.6), radius: 1e5 };
        let emitter = Sphere { center: DVec3::new(50.0, 681.33, 81.6), radius: 600.0 };
        let cut = SphereCut::new(&emitter, &wall).expect("a cut");
        // Sagitta of the emitter and of the wall over the rim: 0.27 together.
        let in_radii = 600.0 * cut.height(Side::Inside);
        let rim_squared = in_radii * (1200.0 - in_radii);
        let of_wall = rim_squared / (1e5 + (1e10 - rim_squared).sqrt());
        assert_relative_eq!(in_radii + of_wall, 0.27, max_relative = 1e-9);
        assert_relative_eq!(cut.height(Side::Inside) + cut.height(Side::Outside), 2.0);
    }

    /// From points on all sides of a cap, also 1e-3 from its rim.
    #[test]
    fn a_sample_lies_on_the_cap_and_has_the_pdf_of_its_direction() {
        let sphere = Sphere { center: DVec3::new(3.0, -2.0, 5.0), radius: 2.0 };
        let opaque = Sphere { center: DVec3::new(4.0, -1.0, 8.0), radius: 3.0 };
        let cut = SphereCut::new(&sphere, &opaque).expect("a cut");
        for side in [Side::Outside, Side::Inside] {
            let cap = cut.exposed_cap(side);
            let across = cap.axis.any_orthonormal_vector();
            let rim =
                cap.axis * (1.0 - cap.height) + across * (cap.height * (2.0 - cap.height)).sqrt();
            let outwards = [cap.axis, across, rim, -rim].map(|normal| normal * 7.0);
            let near_rim = rim * (2.0 + 1e-3);
            for offset in outwards.into_iter().chain([near_rim]) {
                let seen = cap.seen_from(sphere.center + offset, &sphere);
                let mut visible = 0;
                for i in 0..20_000 {
                    let i = f64::from(i);
                    let u = [(i + 0.5) / 20_000.0, (i * 0.618_033_988_749_895).fract()];
                    let ConeSample { direction, distance, pdf } = seen.sample(u);
                    let point = sphere.center + offset + direction * distance;
                    assert_relative_eq!(point.distance(sphere.center), 2.0, max_relative = 1e-12);
                    let is_inside = opaque.contains(point);
                    // An edge of the square becomes the rim.
                    let is_rim = u[1] == 0.0;
                    assert!(is_rim || is_inside == (side == Side::Inside), "{side:?} {u:?}");
                    if pdf > 0.0 && !is_rim {
                        // The square of a grazing cosine comes from a difference.
                        let cos = (sphere.center - point).dot(direction) / 2.0;
                        let error = 1e-9 + 1e-13 / (cos * cos);
                        assert!((pdf / seen.pdf(direction) - 1.0).abs() < error, "{cos}");
                        visible += 1;
                    }
                }
                assert!(visible > 0 || offset.dot(rim) < 0.0);
            }
        }
    }

    #[test]
    fn the_bounds_of_a_cap_contain_it_and_are_no_larger_than_the_sphere() {
        let sphere = Sphere { center: DVec3::new(3.0, -2.0, 5.0), radius: 2.0 };
        for height in [1e-6, 0.1, 0.9, 1.0, 1.1, 2.0] {
            let cap = Cap { axis: DVec3::new(0.6, 0.0, -0.8), height };
            let bounds = cap.bounds(&sphere);
            assert!(bounds.radius <= sphere.radius);
            let across = cap.axis.any_orthonormal_vector();
            let farthest = (0..=1000)
                .map(|i| {
                    let below = height * f64::from(i) / 1000.0;
                    let sin = (below * (2.0 - below)).sqrt();
                    let normal = cap.axis * (1.0 - below) + across * sin;
                    (sphere.center + normal * sphere.radius).distance(bounds.center)
                })
                .fold(0.0, f64::max);
            assert_relative_eq!(farthest, bounds.radius, max_relative = 1e-9);
        }
    }

    #[test]
    fn a_direction_to_the_hidden_part_has_no_pdf() {
        let sphere = ball(0.0, 2.0);
        let cut = SphereCut::new(&sphere, &ball(3.0, 2.0)).expect("a cut");
        let seen = |side| cut.exposed_cap(side).seen_from(DVec3::new(1.3, 9.0, 0.0), &sphere);
        let straight = -DVec3::Y;
        assert!(seen(Side::Outside).pdf(straight) > 0.0);
        assert_eq!(seen(Side::Inside).pdf(straight), 0.0);
    }
}
