//! Angles as complex numbers: sums of angles without transcendental functions.

use std::ops::Mul;

/// An angle in `(-pi, pi)` as the argument of a complex number of any modulus but 0.
///
/// A small angle keeps its relative precision: only imaginary parts of the same order are added.
#[derive(Clone, Copy, Debug)]
pub(super) struct Phase {
    pub(super) re: f64,
    pub(super) im: f64,
}

impl Phase {
    /// The angle with this cosine and sine.
    #[inline(always)]
    pub(super) fn of(cos: f64, sin: f64) -> Self {
        Self { re: cos, im: sin }
    }

    /// Half of the angle, which is in `(-pi, pi)`, with this cosine and sine.
    #[inline(always)]
    pub(super) fn half_of(cos: f64, sin: f64) -> Self {
        // tan(a / 2) = sin a / (1 + cos a) = (1 - cos a) / sin a: neither cancels on its side.
        if cos >= 0.0 {
            Self { re: 1.0 + cos, im: sin }
        } else {
            Self { re: sin.abs(), im: (1.0 - cos).copysign(sin) }
        }
    }

    /// The negative angle.
    #[inline(always)]
    pub(super) fn negated(self) -> Self {
        Self { re: self.re, im: -self.im }
    }

    /// The angle plus pi.
    #[inline(always)]
    pub(super) fn turned(self) -> Self {
        Self { re: -self.re, im: -self.im }
    }

    /// The angle in radians, within 0.005: relative to it, the error vanishes with its square.
    #[inline(always)]
    pub(super) fn approximate_angle(self) -> f64 {
        // atan x = x / (1 + 0.28 x^2) within 0.005 for |x| <= 1.
        let atan = |x: f64| x / (1.0 + 0.28 * x * x);
        let Self { re, im } = self;
        let is_steep = im.abs() > re.abs();
        let slope = if is_steep { re / im } else { im / re };
        let flat = if re < 0.0 { std::f64::consts::PI.copysign(im) } else { 0.0 };
        let steep = std::f64::consts::FRAC_PI_2.copysign(im);
        if is_steep { steep - atan(slope) } else { flat + atan(slope) }
    }
}

impl Mul for Phase {
    type Output = Self;

    /// Adds the angles.
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self {
            re: self.re * other.re - self.im * other.im,
            im: self.re * other.im + self.im * other.re,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::{atan2, sin_cos};

    #[test]
    fn angles_are_approximated_within_five_thousandths_and_small_ones_exactly() {
        for i in -3140..=3140 {
            let angle = f64::from(i) * 1e-3;
            let (sin, cos) = sin_cos(angle);
            let found = Phase::of(0.3 * cos, 0.3 * sin).approximate_angle();
            assert!((found - angle).abs() < 0.005, "{angle} {found}");
        }
        for angle in [1e-4, -1e-9, 1e-200] {
            let found = Phase::of(1.0, angle).approximate_angle();
            assert!((found / angle - 1.0).abs() < 1e-8);
        }
    }

    #[test]
    fn halves_and_sums_have_the_right_argument() {
        for i in -310..=310 {
            let angle = f64::from(i) * 1e-2;
            let (sin, cos) = sin_cos(angle);
            let half = Phase::half_of(cos, sin);
            assert!((atan2(half.im, half.re) - 0.5 * angle).abs() < 1e-14, "{angle}");
            let third = Phase::of(sin_cos(0.3).1, sin_cos(0.3).0);
            let sum = half * third.negated();
            assert!((atan2(sum.im, sum.re) - (0.5 * angle - 0.3)).abs() < 1e-14, "{angle}");
        }
    }
}
