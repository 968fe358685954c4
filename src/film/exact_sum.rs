//! Exact sums: rounding-free, so that order and grouping of the addends cannot matter.
//!
//! A number is rounded once, to a whole number of steps of `2^step`, and integers are added. The
//! largest allowed addend leaves room for the blocks of 2^32 samples, so no sum of them can
//! overflow: a value that does not fit is rejected before it is added.

/// A pixel has at most `2^MAX_BLOCKS_LOG2` blocks: the blocks of 2^32 samples.
const MAX_BLOCKS_LOG2: i32 = 28;

/// Bits of an f64 mantissa.
const MANTISSA_BITS: i32 = 53;

/// A signed exact sum.
pub(super) trait ExactSum: Copy + Default {
    /// Addends are smaller than `2^BITS` steps.
    const BITS: i32;

    /// Rounds to the nearest whole number of steps; ties away from 0. `x` must be finite and below
    /// [`limit`].
    fn quantize(x: f64, step: i32) -> Self;

    /// Returns the sum and true if it overflows.
    fn add_overflowing(self, other: Self) -> (Self, bool);

    /// Returns the value, rounded to f64.
    fn to_f64(self, step: i32) -> f64;
}

/// Returns the exclusive upper bound on the magnitude of an addend.
pub(super) fn limit<S: ExactSum>(step: i32) -> f64 {
    power_of_two(step + S::BITS)
}

/// Returns the step with which addends below `2^exponent` can be summed.
pub(super) fn step_for_exponent<S: ExactSum>(exponent: i32) -> i32 {
    exponent - S::BITS
}

impl ExactSum for i128 {
    const BITS: i32 = 126 - MAX_BLOCKS_LOG2;

    fn quantize(x: f64, step: i32) -> Self {
        let [low, high] = ScaledMantissa::of(x, step).words();
        let magnitude = i128::from(high) << 64 | i128::from(low);
        // Negated if the sign bit is set: called for every block, so it must not branch.
        let sign = i128::from(x.to_bits() as i64 >> 63);
        (magnitude ^ sign) - sign
    }

    fn add_overflowing(self, other: Self) -> (Self, bool) {
        self.overflowing_add(other)
    }

    fn to_f64(self, step: i32) -> f64 {
        self as f64 * power_of_two(step)
    }
}

/// A sum of non-negative numbers, in 192 bits, lowest word first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct U192(pub(super) [u64; 3]);

impl ExactSum for U192 {
    const BITS: i32 = 191 - MAX_BLOCKS_LOG2;

    fn quantize(x: f64, step: i32) -> Self {
        let scaled = ScaledMantissa::of(x, step);
        let [low, high] = scaled.words();
        Self(match scaled.shift / 64 {
            0 => [low, high, 0],
            1 => [0, low, high],
            _ => [0, 0, low],
        })
    }

    fn add_overflowing(self, other: Self) -> (Self, bool) {
        let low = |Self([low, middle, _]): Self| u128::from(middle) << 64 | u128::from(low);
        let (sum, carry) = low(self).overflowing_add(low(other));
        let (high, overflows) = self.0[2].overflowing_add(other.0[2]);
        let (high, carry_overflows) = high.overflowing_add(u64::from(carry));
        (Self([sum as u64, (sum >> 64) as u64, high]), overflows || carry_overflows)
    }

    fn to_f64(self, step: i32) -> f64 {
        let [low, middle, high] = self.0;
        let low = u128::from(middle) << 64 | u128::from(low);
        (high as f64 * power_of_two(128) + low as f64) * power_of_two(step)
    }
}

/// A number of steps as `mantissa << shift`.
struct ScaledMantissa {
    mantissa: u64,
    shift: u32,
}

impl ScaledMantissa {
    fn of(x: f64, step: i32) -> Self {
        let bits = x.to_bits();
        let exponent = (bits >> 52 & 0x7ff) as i32;
        if exponent == 0 {
            // Zero, or far below any step.
            return Self { mantissa: 0, shift: 0 };
        }
        let mantissa = bits & ((1 << 52) - 1) | 1 << 52;
        let shift = exponent - 1023 - 52 - step;
        match shift {
            0.. => Self { mantissa, shift: shift as u32 },
            _ if shift < -MANTISSA_BITS => Self { mantissa: 0, shift: 0 },
            _ => Self { mantissa: (mantissa + (1 << (-shift - 1))) >> -shift, shift: 0 },
        }
    }

    /// Returns the number's 128 bits, without the shift's whole words; lower word first.
    fn words(&self) -> [u64; 2] {
        let bit = self.shift % 64;
        [self.mantissa << bit, (self.mantissa >> 1) >> (63 - bit)]
    }
}

/// Returns `2^exponent`, for a normal number.
fn power_of_two(exponent: i32) -> f64 {
    debug_assert!((-1022..=1023).contains(&exponent));
    f64::from_bits(((1023 + exponent) as u64) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Rounding by definition: scaled exactly, then to the nearest integer.
    fn by_definition(x: f64, step: i32) -> f64 {
        (x * power_of_two(-step)).round()
    }

    #[test]
    fn numbers_are_rounded_to_the_nearest_step_ties_away_from_zero() {
        for (x, expected) in [
            (0.0, 0),
            (0.25, 0),
            (0.5, 1),
            (-0.5, -1),
            (0.49999999999999994, 0),
            (2.5, 3),
            (-2.4, -2),
            (1e15, 1_000_000_000_000_000),
            (2f64.powi(97), 1 << 97),
            (f64::MIN_POSITIVE / 2.0, 0),
        ] {
            assert_eq!(i128::quantize(x, 0), expected, "{x}");
        }
        assert_eq!(U192::quantize(2f64.powi(162), 0).0, [0, 0, 1 << 34]);
        assert_eq!(U192::quantize(0.5, 0).0, [1, 0, 0]);
    }

    #[test]
    fn as_many_blocks_as_there_can_be_do_not_overflow() {
        let max_addend = f64::from_bits(limit::<i128>(-10).to_bits() - 1);
        let addend = i128::quantize(max_addend, -10);
        assert!(addend.checked_mul(1 << MAX_BLOCKS_LOG2).is_some());
        assert!(addend.checked_mul(1 << (MAX_BLOCKS_LOG2 + 2)).is_none());
        // Doubling 28 times adds 2^28 of them.
        let mut sum = U192::quantize(f64::from_bits(limit::<U192>(7).to_bits() - 1), 7);
        for _ in 0..MAX_BLOCKS_LOG2 {
            let (double, overflows) = sum.add_overflowing(sum);
            assert!(!overflows);
            sum = double;
        }
        let (double, overflows) = sum.add_overflowing(sum);
        assert!(!overflows && double.add_overflowing(double).1);
        assert!(i128::MAX.add_overflowing(1).1 && i128::MIN.add_overflowing(-1).1);
    }

    proptest! {
        #[test]
        fn rounding_and_reading_agree_with_the_definition(
            x in -1e25f64..1e25,
            step in -40i32..40,
        ) {
            prop_assume!(x.abs() < limit::<i128>(step));
            prop_assert_eq!(i128::quantize(x, step) as f64, by_definition(x, step));
            let wide = U192::quantize(x.abs(), step);
            prop_assert_eq!(wide.to_f64(0), by_definition(x.abs(), step));
        }

        #[test]
        fn wide_sums_carry(a in any::<[u64; 3]>(), b in any::<[u64; 3]>()) {
            let low = |words: [u64; 3]| u128::from(words[1]) << 64 | u128::from(words[0]);
            let (sum, carry) = low(a).overflowing_add(low(b));
            let high = u128::from(a[2]) + u128::from(b[2]) + u128::from(carry);
            let expected = U192([sum as u64, (sum >> 64) as u64, high as u64]);
            prop_assert_eq!(U192(a).add_overflowing(U192(b)), (expected, high >> 64 > 0));
        }
    }
}
