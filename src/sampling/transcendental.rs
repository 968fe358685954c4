//! The single source of transcendental functions, so that pictures are bit-identical on every
//! machine: the `libm` crate, compiled in, instead of the system's; and functions of our own
//! without branches, for loops over lanes: cube roots, and the sine and cosine of random azimuths,
//! which are given in turns and need no general range reduction.

/// Returns the sine and cosine of an angle in radians.
pub fn sin_cos(angle: f64) -> (f64, f64) {
    libm::sincos(angle)
}

/// Returns the sine and cosine of an angle in turns, `sin 2 pi t` and `cos 2 pi t`, for `|t|` up to
/// 2^49. Each is off by at most 2 ulp.
///
/// Subtracting the nearest quarter turn is exact, also near the zeros of both. On the remaining
/// eighth of a turn to either side, polynomials that interpolate at Chebyshev nodes (relative
/// errors 1.3e-17 and 1.8e-18) are evaluated without a branch.
#[inline(always)]
pub fn sin_cos_2pi(turns: f64) -> (f64, f64) {
    /// Adding and subtracting it rounds to integers, which then occupy the lowest bits.
    const WHOLE: f64 = 1.5 * (1u64 << 52) as f64;
    let shifted = 4.0 * turns + WHOLE;
    let quarter = shifted.to_bits();
    let rest = turns - 0.25 * (shifted - WHOLE);
    let z = rest * rest;
    let sin = rest * (std::f64::consts::TAU + z * polynomial(z, SIN));
    let cos = 1.0 + z * (-19.739208802178716 + z * polynomial(z, COS));
    let (sin, cos) = if quarter & 1 == 0 { (sin, cos) } else { (cos, sin) };
    // The sine is negative in quarters 2 and 3, the cosine in 1 and 2.
    let negate = |x: f64, quarter: u64| f64::from_bits(x.to_bits() ^ (quarter & 2) << 62);
    (negate(sin, quarter), negate(cos, quarter.wrapping_add(1)))
}

/// Coefficients of `(sin(2 pi r) / r - 2 pi) / r^2` by powers of `r^2`.
const SIN: [f64; 6] = [
    -41.341702240399755,
    81.6052492760517,
    -76.70585973562093,
    42.05868918088512,
    -15.094054182079999,
    3.78643334956545,
];

/// Coefficients of `(cos(2 pi r) - 1 + (2 pi r)^2 / 2) / r^4` by powers of `r^2`.
const COS: [f64; 6] = [
    64.9393940226683,
    -85.45681720668455,
    60.24464136502278,
    -26.426254911246687,
    7.903305164742355,
    -1.7012215232036352,
];

/// Evaluates a polynomial, given from its lowest coefficient, by Horner's rule.
#[inline(always)]
fn polynomial(x: f64, [a, b, c, d, e, f]: [f64; 6]) -> f64 {
    a + x * (b + x * (c + x * (d + x * (e + x * f))))
}

/// Returns the tangent of an angle in radians.
pub fn tan(angle: f64) -> f64 {
    libm::tan(angle)
}

/// Returns the cosine of an angle in radians.
pub fn cos(angle: f64) -> f64 {
    libm::cos(angle)
}

/// Returns the angle in `[0, pi]` whose cosine is `x`, which is clamped to `[-1, 1]`.
pub fn safe_acos(x: f64) -> f64 {
    libm::acos(x.clamp(-1.0, 1.0))
}

/// Returns the angle of the point `(x, y)` in `(-pi, pi]`.
pub fn atan2(y: f64, x: f64) -> f64 {
    libm::atan2(y, x)
}

/// Returns `e^x`.
pub fn exp(x: f64) -> f64 {
    libm::exp(x)
}

/// Returns the cube root of `x >= 0`, for loops over lanes: without a branch, and correctly rounded
/// but for one argument in some ten million. Subnormal numbers count as 0.
#[inline(always)]
pub(super) fn cbrt(x: f64) -> f64 {
    // A third of the exponent, and two steps of Halley's method: within 1e-11.
    let third = ((x.to_bits() >> 32) * 0xaaaa_aaab) >> 33;
    let halley = |t: f64| t * (t * t * t + 2.0 * x) / (2.0 * t * t * t + x);
    let t = halley(halley(f64::from_bits((third + (682 << 20)) << 32)));
    // To 23 bits, whose square is exact, and so are its products by halves of that square.
    let upper = |t: f64| f64::from_bits((t.to_bits() + (1 << 29)) & !((1 << 30) - 1));
    let t = upper(t);
    let squared = t * t;
    let high = upper(squared);
    let d = ((x - high * t) - (squared - high) * t) / (squared * t);
    let root = t + t * (d * (1.0 / 3.0 + d * (-1.0 / 9.0 + d * (5.0 / 81.0))));
    if x < f64::MIN_POSITIVE { 0.0 } else { root }
}

/// Returns the natural logarithm of `x > 0`.
pub fn ln(x: f64) -> f64 {
    libm::log(x)
}

/// Returns `base^exponent`.
pub fn powf(base: f64, exponent: f64) -> f64 {
    libm::pow(base, exponent)
}

#[cfg(test)]
mod tests {
    use super::*;
    use twofloat::TwoFloat;

    /// Sine and cosine by their series, in twice the precision; `turns` within an eighth of 0.
    fn series(turns: f64) -> (TwoFloat, TwoFloat) {
        let angle = TwoFloat::from(turns) * twofloat::consts::TAU;
        let (mut sin, mut cos) = (TwoFloat::from(0.0), TwoFloat::from(0.0));
        let mut term = TwoFloat::from(1.0);
        for n in 0..30u32 {
            let sum = if n % 2 == 0 { &mut cos } else { &mut sin };
            *sum += if n % 4 < 2 { term } else { -term };
            term = term * angle / f64::from(n + 1);
        }
        (sin, cos)
    }

    fn units_off(found: f64, exact: TwoFloat) -> f64 {
        let unit = f64::EPSILON * 2f64.powi(libm::ilogb(f64::from(exact)));
        f64::from((exact - found) / unit).abs()
    }

    #[test]
    fn sines_and_cosines_of_turns_are_within_two_units_in_the_last_place() {
        let mut worst = 0.0f64;
        for i in -100_000..=100_000 {
            let rest = f64::from(i) / 800_000.0 * (1.0 - 1e-9 * f64::from(i % 7));
            let (sin, cos) = series(rest);
            let quarters = [(sin, cos), (cos, -sin), (-sin, -cos), (-cos, sin)];
            for (quarter, (sin, cos)) in quarters.into_iter().enumerate() {
                // Subtracting the quarter must give `rest` again.
                let turns = rest + 0.25 * quarter as f64;
                if turns - 0.25 * quarter as f64 != rest || rest == 0.0 {
                    continue;
                }
                let (found_sin, found_cos) = sin_cos_2pi(turns);
                worst = worst.max(units_off(found_sin, sin)).max(units_off(found_cos, cos));
            }
        }
        assert!(worst <= 2.0, "{worst} units");
        assert_eq!(
            [0.0, 0.25, 0.5, 0.75, 1.0].map(sin_cos_2pi),
            [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0), (0.0, 1.0)]
        );
    }

    #[test]
    fn cube_roots_are_correctly_rounded() {
        // Over many binades; the other library is correctly rounded.
        for i in 0..300_000u32 {
            let x = f64::from(i) * 1e-3 * f64::from(i % 97).exp2();
            for x in [x, 1.0 / (x + 1.0)] {
                assert_eq!(cbrt(x), libm::cbrt(x), "{x}");
            }
        }
        assert_eq!(cbrt(1e-310), 0.0);
    }

    #[test]
    fn functions_have_their_known_values() {
        use std::f64::consts::{E, FRAC_PI_3, FRAC_PI_4, LN_2, PI, SQRT_2};
        let pairs = [
            (tan(FRAC_PI_3), 3f64.sqrt()),
            (tan(-FRAC_PI_4), -1.0),
            (cos(FRAC_PI_3), 0.5),
            (cos(PI), -1.0),
            (sin_cos(FRAC_PI_4).0, SQRT_2 / 2.0),
            (sin_cos(2.0 * FRAC_PI_3).1, -0.5),
            (safe_acos(0.5), FRAC_PI_3),
            (safe_acos(-1.5), PI),
            (safe_acos(1.5), 0.0),
            (atan2(1.0, -1.0), 3.0 * FRAC_PI_4),
            (atan2(-1.0, 1.0), -FRAC_PI_4),
            (exp(1.0), E),
            (exp(-LN_2), 0.5),
            (ln(2.0), LN_2),
            (ln(1.0 / E), -1.0),
            (powf(2.0, 0.5), SQRT_2),
            (powf(4.0, -1.5), 0.125),
        ];
        for (index, (found, expected)) in pairs.into_iter().enumerate() {
            assert!((found - expected).abs() < 1e-15, "{index}: {found} {expected}");
        }
    }
}
