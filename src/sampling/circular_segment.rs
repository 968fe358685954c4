//! Areas of circular segments, and their inverse: for sampling what the horizon cuts off a disc.
//!
//! A segment of the unit disc that spans the angle `2 psi` at the centre has the area `psi - sin
//! psi cos psi`. Both functions are polynomials without a branch on their precision.

use std::f64::consts::{FRAC_PI_2, PI};

use super::transcendental::cbrt;

/// Returns the area of the segment with the half-angle `psi` in `[0, pi / 2]`, given by its sine
/// and cosine. Relative error below 1e-12, also for the thinnest segments.
#[inline(always)]
pub fn segment_area(sin: f64, cos: f64) -> f64 {
    let tan_half = sin / (1.0 + cos);
    let squared = tan_half * tan_half;
    tan_half * squared * polynomial(squared, &AREA)
}

/// Returns `1 - cos psi` of the segment with this area, from 0 to that of the disc, pi; relative
/// error below 1e-9 up to half a disc.
#[inline(always)]
pub fn one_minus_cos_of_segment(area: f64) -> f64 {
    let is_large = area > FRAC_PI_2;
    let smaller = if is_large { PI - area } else { area };
    let root = cbrt(smaller.max(0.0));
    let squared = root * root;
    let one_minus_cos = squared * polynomial(squared, &ONE_MINUS_COS);
    if is_large { 2.0 - one_minus_cos } else { one_minus_cos }
}

/// Evaluates a polynomial, given from its lowest coefficient, as four interleaved polynomials in
/// `x^4`, which do not wait for one another.
#[inline(always)]
fn polynomial<const N: usize>(x: f64, coefficients: &[[f64; 4]; N]) -> f64 {
    let squared = x * x;
    let fourth = squared * squared;
    let mut sums = [0.0; 4];
    for row in coefficients.iter().rev() {
        for (sum, coefficient) in sums.iter_mut().zip(row) {
            *sum = *sum * fourth + coefficient;
        }
    }
    let [a, b, c, d] = sums;
    (a + x * b) + squared * (c + x * d)
}

/// `(2 atan t - 2 t (1 - t^2) / (1 + t^2)^2) / t^3` by powers of `t^2`, interpolated at Chebyshev
/// nodes of `[0, 1]`.
const AREA: [[f64; 4]; 5] = [
    [5.3333333333314465, -9.599999998775187, 13.714285581320544, -17.777772018210808],
    [21.818049265614682, -25.844281874634508, 29.848987658360823, -33.76421548835616],
    [37.31360218568838, -39.73773550689787, 39.643315732366325, -35.55512122527448],
    [27.314282021649515, -17.063494649763257, 8.179635412528036, -2.789928789102694],
    [0.5981240199037461, -0.060269332954539526, 0.0, 0.0],
];

/// `(1 - cos psi) / A^(2/3)` by powers of `A^(2/3)`, interpolated up to half a disc.
const ONE_MINUS_COS: [[f64; 4]; 3] = [
    [0.6551853484222523, 0.042926811741189105, 0.008838320375193462, 0.0024203070336406315],
    [0.0006591561663235861, 0.0006198114298507026, -0.0008354572259382538, 0.001538971011898982],
    [-0.001571875779560058, 0.0010524717017721713, -0.00039723158606610944, 6.91834625426232e-05],
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::sin_cos;
    use approx::assert_relative_eq;

    #[test]
    fn a_segment_has_the_area_of_its_sector_less_its_triangle() {
        for i in 1..=200 {
            let psi = f64::from(i) / 200.0 * FRAC_PI_2;
            let (sin, cos) = sin_cos(psi);
            let area = segment_area(sin, cos);
            assert!((area - (psi - sin * cos)).abs() < 2e-12, "{psi}");
            let one_minus_cos = 2.0 * sin_cos(0.5 * psi).0.powi(2);
            assert_relative_eq!(one_minus_cos_of_segment(area), one_minus_cos, max_relative = 1e-9);
            // What remains of the disc is a segment, too.
            let rest = one_minus_cos_of_segment(PI - area);
            assert_relative_eq!(rest, 2.0 - one_minus_cos, max_relative = 1e-9);
        }
    }

    #[test]
    fn a_thin_segment_keeps_its_digits() {
        for psi in [1e-12, 1e-6, 1e-3] {
            let (sin, cos) = sin_cos(psi);
            // 2/3 psi^3 - 2/15 psi^5
            let expected = psi * psi * psi * (2.0 / 3.0 - 2.0 / 15.0 * psi * psi);
            let area = segment_area(sin, cos);
            assert_relative_eq!(area, expected, max_relative = 1e-11);
            let one_minus_cos = one_minus_cos_of_segment(area);
            assert_relative_eq!(one_minus_cos, 0.5 * psi * psi, max_relative = 1e-6);
        }
    }
}
