//! The aperture of a lens: a disk, or the polygon formed by its blades.
//!
//! Points are sampled uniformly over the area; sampling, pdf and inversion are implemented
//! together.

use std::f64::consts::{PI, TAU};

use crate::sampling::{atan2, invert_disk, sample_disk, sin_cos};

/// The aperture of a lens, in its own plane: x to the right of the picture, y up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aperture {
    /// Radius of the disk, or of the circle through the polygon's corners.
    pub radius: f64,
    /// Number of corners of a regular polygon, at least 3; 0 for a disk.
    pub blades: u32,
    /// Angle from x to the first corner, counterclockwise, in radians.
    pub rotation: f64,
}

impl Aperture {
    /// Samples a point of the aperture, from `u` in `[0, 1)^2`.
    pub fn sample(&self, u: [f64; 2]) -> [f64; 2] {
        let unit = if self.blades == 0 { sample_disk(u).point } else { self.sample_polygon(u) };
        unit.map(|x| x * self.radius)
    }

    /// Returns the pdf of [`Self::sample`] per area: 0 outside of the aperture.
    pub fn pdf(&self, point: [f64; 2]) -> f64 {
        let [_, r] = self.sector_coordinates(point);
        let is_outside = if self.blades == 0 { length(point) > self.radius } else { r > 1.0 };
        if is_outside { 0.0 } else { 1.0 / self.area() }
    }

    /// Returns the `u` that maps to a point.
    pub fn invert(&self, point: [f64; 2]) -> [f64; 2] {
        if self.blades == 0 {
            return invert_disk(point.map(|x| x / self.radius));
        }
        let [sector, r] = self.sector_coordinates(point);
        [sector / f64::from(self.blades), r * r]
    }

    /// Returns the area of the aperture.
    pub fn area(&self) -> f64 {
        let square = self.radius * self.radius;
        if self.blades == 0 {
            return PI * square;
        }
        let n = f64::from(self.blades);
        0.5 * n * sin_cos(TAU / n).0 * square
    }

    /// Samples a triangle from the centre to an edge. The length of its sections parallel to the
    /// edge grows linearly with their distance, so the distance is the square root of a uniform
    /// number.
    fn sample_polygon(&self, u: [f64; 2]) -> [f64; 2] {
        let position = u[0] * f64::from(self.blades);
        let sector = position.floor().min(f64::from(self.blades - 1));
        let (along, r) = (position - sector, u[1].sqrt());
        let (a, b) = (self.corner(sector), self.corner(sector + 1.0));
        [0, 1].map(|axis| r * ((1.0 - along) * a[axis] + along * b[axis]))
    }

    /// Returns the sector number plus the position along its edge, and the distance from the centre
    /// as a fraction of the edge's.
    fn sector_coordinates(&self, point: [f64; 2]) -> [f64; 2] {
        let n = f64::from(self.blades.max(3));
        let angle = atan2(point[1], point[0]) - self.rotation;
        let turns = angle / TAU - (angle / TAU).floor();
        let sector = (turns * n).floor().min(n - 1.0);
        let (a, b) = (self.corner_of(sector, n), self.corner_of(sector + 1.0, n));
        // The point is p = x a + y b.
        let determinant = a[0] * b[1] - a[1] * b[0];
        let [px, py] = point.map(|x| x / self.radius);
        let x = (px * b[1] - py * b[0]) / determinant;
        let y = (a[0] * py - a[1] * px) / determinant;
        let r = x + y;
        [sector + if r > 0.0 { y / r } else { 0.0 }, r]
    }

    fn corner(&self, number: f64) -> [f64; 2] {
        self.corner_of(number, f64::from(self.blades))
    }

    fn corner_of(&self, number: f64, n: f64) -> [f64; 2] {
        let (sin, cos) = sin_cos(self.rotation + TAU * number / n);
        [cos, sin]
    }
}

fn length([x, y]: [f64; 2]) -> f64 {
    (x * x + y * y).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_4;

    const APERTURES: [Aperture; 4] = [
        Aperture { radius: 2.0, blades: 0, rotation: 0.0 },
        Aperture { radius: 2.0, blades: 3, rotation: 0.3 },
        Aperture { radius: 0.5, blades: 6, rotation: -7.0 },
        Aperture { radius: 1e-3, blades: 17, rotation: 2.0 },
    ];

    #[test]
    fn inverting_a_sample_gives_its_numbers_back_and_its_density_is_the_areas() {
        for aperture in APERTURES {
            for i in 0..200 {
                let u = [(f64::from(i) + 0.5) / 200.0, (f64::from(i * 71 % 200) + 0.5) / 200.0];
                let point = aperture.sample(u);
                let back = aperture.invert(point);
                assert!((back[0] - u[0]).abs() < 1e-9 && (back[1] - u[1]).abs() < 1e-9, "{u:?}");
                assert_eq!(aperture.pdf(point), 1.0 / aperture.area());
                let r = length(point);
                assert!(r <= aperture.radius * (1.0 + 1e-12));
                // Just outside of the circle, the pdf is 0.
                assert_eq!(aperture.pdf(point.map(|x| x * 1.01 * aperture.radius / r)), 0.0);
            }
        }
    }

    #[test]
    fn corners_are_where_the_rotation_puts_them() {
        let square = Aperture { radius: 1.0, blades: 4, rotation: FRAC_PI_4 };
        let corner = square.sample([0.0, 1.0]);
        assert!((corner[0] - 0.5f64.sqrt()).abs() < 1e-15);
        assert!((corner[1] - 0.5f64.sqrt()).abs() < 1e-15);
        assert!((square.area() - 2.0).abs() < 1e-15);
        // The middle of an edge lies inside of the circle.
        assert!(square.pdf([0.71, 0.0]) == 0.0 && square.pdf([0.70, 0.0]) == 0.5);
    }
}
