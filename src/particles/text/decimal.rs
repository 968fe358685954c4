//! Decimal numbers without an exponent, eight digits at a time.
//!
//! Up to 19 digits fit into 64 bits. A number is then mantissa / 10^k, and its nearest f64 follows
//! from one division if the mantissa is exact in f64, and else from a product with the reciprocal
//! of 5^k in 128 bits (Lemire, "Number parsing at a gigabyte per second", 2021, and Mushtak and
//! Lemire, "Fast number parsing without fallback", 2023, who show that this precision suffices).

/// Most digits whose number fits into 64 bits.
const MAX_DIGITS: usize = 19;

/// Eight times the digit 0.
pub(super) const ZEROS: u64 = 0x3030_3030_3030_3030;

/// Powers of ten that are f64 without rounding, as far as they are needed.
pub(super) const POWERS: [f64; MAX_DIGITS + 1] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16,
    1e17, 1e18, 1e19,
];

/// Powers of ten that fit into 64 bits.
pub(super) const POWERS_OF_TEN: [u64; MAX_DIGITS + 1] = powers_of_ten();

const fn powers_of_ten() -> [u64; MAX_DIGITS + 1] {
    let mut all = [1; MAX_DIGITS + 1];
    let mut k = 1;
    while k <= MAX_DIGITS {
        all[k] = 10 * all[k - 1];
        k += 1;
    }
    all
}

/// Bytes in which a common number ends: a sign, seven digits, a point, and two words.
const COMMON_BYTES: usize = 25;

/// 2^b / 5^k, rounded up, with the b for which it has 128 bits.
const RECIPROCALS: [u128; MAX_DIGITS + 1] = reciprocals();

const fn reciprocals() -> [u128; MAX_DIGITS + 1] {
    let mut all = [1 << 127; MAX_DIGITS + 1];
    let (mut k, mut divisor) = (1, 5u128);
    while k <= MAX_DIGITS {
        // Long division, bit by bit, until the quotient has 128 bits.
        let (mut quotient, mut rest) = (0u128, 1u128);
        while quotient >> 127 == 0 {
            rest <<= 1;
            quotient <<= 1;
            if rest >= divisor {
                rest -= divisor;
                quotient |= 1;
            }
        }
        all[k] = quotient + 1;
        divisor *= 5;
        k += 1;
    }
    all
}

/// How many bits 5^k has.
const POWER_BITS: [i32; MAX_DIGITS + 1] = power_bits();

const fn power_bits() -> [i32; MAX_DIGITS + 1] {
    let mut all = [0; MAX_DIGITS + 1];
    let mut k = 0;
    while k <= MAX_DIGITS {
        all[k] = 128 - 5u128.pow(k as u32).leading_zeros() as i32;
        k += 1;
    }
    all
}

/// The digits at the beginning of a text: their number as an integer, and how many there are. More
/// than [`MAX_DIGITS`] may overflow.
#[inline(always)]
pub(super) fn leading_digits(text: &[u8], mut number: u64) -> (u64, usize) {
    let mut at = 0;
    while let Some(word) = text[at..].first_chunk().map(|bytes| u64::from_le_bytes(*bytes)) {
        let count = digit_count(word);
        if count < 8 {
            let earlier = number.wrapping_mul(POWERS_OF_TEN[count]);
            return (earlier.wrapping_add(first_digits(word, count)), at + count);
        }
        number = number.wrapping_mul(100_000_000).wrapping_add(eight_digits(word - ZEROS));
        at += 8;
    }
    while let Some(digit) = text.get(at).map(|byte| byte.wrapping_sub(b'0')).filter(|d| *d < 10) {
        number = number.wrapping_mul(10).wrapping_add(u64::from(digit));
        at += 1;
    }
    (number, at)
}

/// How many of eight bytes, from the lowest one on, are digits.
#[inline(always)]
fn digit_count(word: u64) -> usize {
    let above_nine = word.wrapping_add(0x4646_4646_4646_4646);
    let below_zero = word.wrapping_sub(ZEROS);
    let others = (above_nine | below_zero) & 0x8080_8080_8080_8080;
    others.trailing_zeros() as usize / 8
}

/// The number with the first digits of a word, at most seven.
#[inline(always)]
fn first_digits(word: u64, count: usize) -> u64 {
    // Digits that are 0 come first. A shift by 64 bits is none.
    eight_digits((word.wrapping_sub(ZEROS) << 8) << (56 - 8 * count))
}

/// The number with eight digits, each in a byte, the first one in the lowest.
#[inline(always)]
fn eight_digits(digits: u64) -> u64 {
    const MASK: u64 = 0x0000_00ff_0000_00ff;
    let pairs = digits.wrapping_mul(10).wrapping_add(digits >> 8);
    let outer = (pairs & MASK).wrapping_mul(100 + (1_000_000 << 32));
    let inner = ((pairs >> 16) & MASK).wrapping_mul(1 + (10_000 << 32));
    outer.wrapping_add(inner) >> 32
}

/// The number at the beginning of a text, and its length, if it has at most 19 digits and no
/// exponent. What follows it may be anything.
#[inline(always)]
pub(in crate::particles) fn short_float(text: &[u8]) -> Option<(f64, usize)> {
    match text.first_chunk().and_then(common_float) {
        Some(common) => Some(common),
        None => any_short_float(text),
    }
}

/// [`short_float`] of a number with fewer than 8 digits before its point and fewer than 16 after
/// it, as most are. Branches depend on how many digits there are, but not on which.
#[inline(always)]
fn common_float(text: &[u8; COMMON_BYTES]) -> Option<(f64, usize)> {
    let word_at = |at: usize| {
        let mut word = [0; 8];
        word.copy_from_slice(&text[at..at + 8]);
        u64::from_le_bytes(word)
    };
    let is_negative = text[0] == b'-';
    let start = usize::from(is_negative);
    let before = word_at(start);
    let whole = digit_count(before);
    let point = start + whole;
    if whole == 8 {
        return None;
    }
    let sign = u64::from(is_negative) << 63;
    let signed = |value: f64| f64::from_bits(value.to_bits() | sign);
    if text[point] != b'.' {
        return (whole > 0).then(|| (signed(first_digits(before, whole) as f64), point));
    }
    let after = word_at(point + 1);
    let mut decimals = digit_count(after);
    let mut mantissa = first_digits(before, whole);
    if decimals < 8 {
        mantissa = mantissa * POWERS_OF_TEN[decimals] + first_digits(after, decimals);
    } else {
        let last = word_at(point + 9);
        let more = digit_count(last);
        if more == 8 {
            return None;
        }
        mantissa = mantissa * 100_000_000 + eight_digits(after - ZEROS);
        mantissa =
            mantissa.wrapping_mul(POWERS_OF_TEN[more]).wrapping_add(first_digits(last, more));
        decimals += more;
    }
    let value = quotient(mantissa, decimals, whole + decimals)?;
    Some((signed(value), point + 1 + decimals))
}

/// [`short_float`] of any number.
#[inline(never)]
fn any_short_float(text: &[u8]) -> Option<(f64, usize)> {
    let is_negative = text.first() == Some(&b'-');
    let text = &text[usize::from(is_negative)..];
    let (mut mantissa, whole) = leading_digits(text, 0);
    let (mut end, mut decimals) = (whole, 0);
    if text.get(end) == Some(&b'.') {
        (mantissa, decimals) = leading_digits(&text[whole + 1..], mantissa);
        end += 1 + decimals;
    }
    let value = quotient(mantissa, decimals, whole + decimals)?;
    Some((if is_negative { -value } else { value }, end + usize::from(is_negative)))
}

/// The f64 nearest to mantissa / 10^decimals; `None` without digits, or with too many.
#[inline(always)]
fn quotient(mantissa: u64, decimals: usize, digits: usize) -> Option<f64> {
    if digits == 0 || digits > MAX_DIGITS {
        return None;
    }
    Some(match mantissa <= 1 << 53 || decimals == 0 {
        true => mantissa as i64 as f64 / POWERS[decimals],
        false => nearest_quotient(mantissa, decimals),
    })
}

/// The f64 nearest to mantissa / 10^k, of which ties go to even. Neither may be 0.
#[inline(always)]
pub(super) fn nearest_quotient(mantissa: u64, k: usize) -> f64 {
    /// A quotient by a higher power of 5 is no tie: the mantissa would have more than 64 bits. That
    /// of a tie has more than 53.
    const MAX_TIE_POWER: usize = 4;
    let shift = mantissa.leading_zeros();
    let normal = mantissa << shift;
    let [low, high] = [RECIPROCALS[k] as u64, (RECIPROCALS[k] >> 64) as u64];
    let wide = |a: u64, b: u64| u128::from(a) * u128::from(b);
    let mut product = wide(normal, high);
    // Elsewhere, what the lower half adds changes no bit that counts.
    if matches!((product >> 64) as u64 & 0x1ff, 0 | 0x1ff) {
        product += wide(normal, low) >> 64;
    }
    let (upper, lower) = ((product >> 64) as u64, product as u64);
    // 54 bits: those of an f64, and one that decides the rounding.
    let drop = (upper >> 63) + 9;
    let mut bits = upper >> drop;
    let has_nothing_below = lower <= 1 && bits << drop == upper;
    if k <= MAX_TIE_POWER && has_nothing_below && bits & 3 == 1 {
        bits &= !1;
    }
    let rounded = (bits + (bits & 1)) >> 1;
    let exponent = 2 + drop as i32 - shift as i32 - k as i32 - POWER_BITS[k];
    // Exact, because the exponent is far from the ends of the range.
    rounded as f64 * f64::from_bits(((1023 + exponent) as u64) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn must_be_nearest(text: &str) {
        let (value, length) = short_float(text.as_bytes()).expect("a number");
        let expected: f64 = text[..length].parse().expect("a number");
        assert_eq!(value.to_bits(), expected.to_bits(), "{text}");
        assert_eq!(length, text.trim_end_matches([' ', ',', '/', ':', 'x']).len(), "{text}");
    }

    #[test]
    fn numbers_are_the_nearest_ones_whatever_follows() {
        for text in [
            "0",
            "-0.0",
            "12.5 ",
            "-3.",
            ".25,",
            "9007199254740992",
            "9007199254740993",
            "0.000000000000000001",
            "1234567890123456789",
            ".1234567890123456789",
            "7.x",
            "99999999999999999.99",
            "12345678/",
            "12345678.12345678:",
            "123456789.0 xxxxxxxxx",
        ] {
            must_be_nearest(text);
        }
        for text in ["", "-", ".", "-.", "x", "+1", "12345678901234567890", "0.1234567890123456789"]
        {
            assert_eq!(short_float(text.as_bytes()), None, "{text}");
        }
        assert_eq!(short_float(b"1e5"), Some((1.0, 1)));
        assert_eq!(short_float(b"12.5\xb01\xff. 3.5 4.5 5.5"), Some((12.5, 4)));
        assert_eq!(short_float(b". 12345678901234567"), None);
        assert_eq!(short_float(b"7/1.5 2.5 3.5 4.5 5.5"), Some((7.0, 1)));
    }

    #[test]
    fn random_numbers_and_ties_are_rounded_like_those_of_the_standard_library() {
        let mut state = 1u64;
        let mut random = move || {
            state = state.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(0x1405_7b7e_f767_814f);
            (state ^ (state >> 29)).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 1
        };
        for _ in 0..200_000 {
            let digits = (random() % 10u64.pow(1 + (random() % 19) as u32)).to_string();
            let point = random() as usize % (digits.len() + 1);
            let number = format!("{}.{}", &digits[..point], &digits[point..]);
            must_be_nearest(&number);
            // Numbers within a text are read 16 bytes at a time.
            must_be_nearest(&format!("-{number} xxxxxxxxxxxxxxxx"));
            must_be_nearest(&format!("{number}::::xxxxxxxxxxxxxxxx"));
        }
        for k in 1..=4 {
            let power = 10f64.powi(k as i32) as u64;
            for _ in 0..20_000 {
                // An odd number of half units in the last place, and its neighbours.
                let half = (random() >> 10) | (1 << 53) | 1;
                let Some(tie) = half.checked_mul(5u64.pow(k)) else { continue };
                for mantissa in [tie - 1, tie, tie + 1] {
                    let (whole, rest) = (mantissa / power, mantissa % power);
                    let text = format!("{whole}.{rest:0width$}", width = k as usize);
                    if text.len() <= MAX_DIGITS + 1 {
                        must_be_nearest(&text);
                    }
                }
            }
        }
    }
}
