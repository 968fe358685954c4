//! Intersects one sphere and a line in double-double arithmetic: about 104 bits, twice those of
//! f64.
//!
//! Nothing here is shared with [`crate::geometry`], so an error in one does not hide the same error
//! in the other. The numbers are wider, and the formula is different: the cross product gives the
//! distance between line and centre.
//!
//! Dekker 1971, "A floating-point technique for extending the available precision"; Joldes, Muller
//! and Popescu 2017, "Tight and rigorous error bounds for basic building blocks of double-word
//! arithmetic", ACM TOMS 44(2).

use twofloat::TwoFloat;

use crate::geometry::Sphere;
use crate::math::DVec3;

/// Closest approach of a line `origin + t * direction` to a sphere's centre.
#[derive(Clone, Copy, Debug)]
pub(super) struct ClosestApproach {
    /// Parameter t of the closest approach.
    pub(super) t: TwoFloat,
    /// Squared distance at the closest approach.
    pub(super) distance_squared: TwoFloat,
    /// Squared length of the direction.
    pub(super) length_squared: TwoFloat,
}

impl ClosestApproach {
    pub(super) fn new(origin: DVec3, direction: DVec3, sphere: &Sphere) -> Self {
        let [x, y, z] = difference(origin, sphere.center);
        let [dx, dy, dz] = direction.to_array();
        let length_squared =
            TwoFloat::new_mul(dx, dx) + TwoFloat::new_mul(dy, dy) + TwoFloat::new_mul(dz, dz);
        let cross = [y * dz - z * dy, z * dx - x * dz, x * dy - y * dx];
        let cross_squared = cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2];
        Self {
            t: quotient(-(x * dx + y * dy + z * dz), length_squared),
            distance_squared: quotient(cross_squared, length_squared),
            length_squared,
        }
    }

    /// Half the chord cut by a sphere of this radius, in units of t; `None` if the line misses.
    pub(super) fn half_chord(&self, radius: TwoFloat) -> Option<TwoFloat> {
        let half_squared = quotient(radius * radius - self.distance_squared, self.length_squared);
        (half_squared >= 0.0).then(|| half_squared.sqrt())
    }
}

/// Exact difference of two points.
fn difference(a: DVec3, b: DVec3) -> [TwoFloat; 3] {
    [TwoFloat::new_sub(a.x, b.x), TwoFloat::new_sub(a.y, b.y), TwoFloat::new_sub(a.z, b.z)]
}

/// `a / b` by long division with three digits of 53 bits. Does not use twofloat's quotient of two
/// double-doubles, which leaves a product unfused and is accurate to f64 precision only.
fn quotient(a: TwoFloat, b: TwoFloat) -> TwoFloat {
    let first = a.hi() / b.hi();
    let rest = a - b * first;
    let second = rest.hi() / b.hi();
    let rest = rest - b * second;
    TwoFloat::new_add(first, second) + rest.hi() / b.hi()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng, rngs::StdRng};

    /// Relative precision of double-double, with a margin for a few operations in a row.
    const RELATIVE: f64 = 1.0 / (1u128 << 98) as f64;

    #[test]
    fn quotients_and_roots_are_right_to_98_bits() {
        let mut rng = StdRng::seed_from_u64(1);
        for _ in 0..100_000 {
            let mut number = || {
                let scale = 2f64.powi(rng.random_range(-60..60));
                TwoFloat::new_add(
                    scale * rng.random_range(1.0..2.0),
                    scale * rng.random::<f64>() * 1e-17,
                )
            };
            let (a, b) = (number(), number());
            assert!((quotient(a, b) * b - a).abs() <= RELATIVE * a.hi());
            assert!((a.sqrt() * a.sqrt() - a).abs() <= RELATIVE * a.hi());
        }
    }

    /// Uses integers only: a Pythagorean triple gives a rational chord, an integer matrix `M` with
    /// `M M^T = 9` rotates it without rounding, and every input is an exact f64.
    #[test]
    fn rational_chords_come_out_exactly() {
        let mut rng = StdRng::seed_from_u64(2);
        for _ in 0..20_000 {
            let (m, n) = (rng.random_range(2..2000i64), rng.random_range(1..2000i64));
            let triple = [(m * m - n * n).abs(), 2 * m * n, m * m + n * n].map(|v| v as f64);
            let [miss, half_chord, radius] = triple;
            let t = rng.random_range(-(1i64 << 44)..1 << 44) as f64;
            let origin = DVec3::new(rng.random_range(-1000..1000) as f64, 7.0, -5.0);
            let center = origin + turned(DVec3::new(t, miss, 0.0));
            let sphere = Sphere { center, radius: 3.0 * radius };
            let approach = ClosestApproach::new(origin, turned(DVec3::X), &sphere);
            let found = approach.half_chord(TwoFloat::from(sphere.radius)).expect("hits");
            assert_eq!(approach.length_squared, 9.0);
            assert!((approach.t - t).abs() <= RELATIVE * t.abs());
            // The discriminant is a difference of squares, so its error is that of the squares.
            let error = RELATIVE * radius * radius / half_chord;
            assert!((found - half_chord).abs() <= error, "{found:?} for {half_chord}");
        }
    }

    fn turned(v: DVec3) -> DVec3 {
        DVec3::new(
            2.0 * v.x - 2.0 * v.y + v.z,
            v.x + 2.0 * v.y + 2.0 * v.z,
            2.0 * v.x + v.y - 2.0 * v.z,
        )
    }

    #[test]
    fn a_line_passes_by_or_touches_by_one_part_in_2_to_the_90() {
        // Radius 5 and a line at distance 5, to the last bit; then a radius smaller by one part in
        // 2^90.
        let sphere = Sphere { center: DVec3::new(3.0, 4.0, 1e6), radius: 5.0 };
        let approach = ClosestApproach::new(DVec3::ZERO, DVec3::Z, &sphere);
        assert_eq!(approach.half_chord(TwoFloat::from(5.0)), Some(TwoFloat::from(0.0)));
        let smaller = TwoFloat::new_add(5.0, -5.0 * 2f64.powi(-90));
        assert_eq!(approach.half_chord(smaller), None);
        assert_eq!(approach.t, 1e6);
    }

    /// A tiny sphere far away, where `b^2 - 4ac` in f64 has lost all its digits.
    #[test]
    fn a_distant_tiny_sphere_keeps_its_chord() {
        let unit = 2f64.powi(-20);
        let sphere =
            Sphere { center: DVec3::new(3.0 * unit, 0.0, 2f64.powi(27)), radius: 5.0 * unit };
        let approach = ClosestApproach::new(DVec3::ZERO, DVec3::Z, &sphere);
        assert_eq!(
            approach.half_chord(TwoFloat::from(sphere.radius)),
            Some(TwoFloat::from(4.0 * unit))
        );
    }
}
