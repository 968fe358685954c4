//! The digits of many numbers at once, with or without a point, aligned to the right in words of
//! eight bytes.

use super::decimal::ZEROS;

/// Rows at once.
pub(super) const LANES: usize = 16;

/// A byte in each place of a word.
const ONES: u64 = 0x0101_0101_0101_0101;

/// A value for each lane.
pub(super) type Lanes<T> = [T; LANES];

/// The digits of numbers.
pub(super) struct Digits {
    pub(super) mantissa: Lanes<u64>,
    /// How many digits follow the point.
    pub(super) decimals: Lanes<u64>,
}

/// The digits at the end of words; `None` if there is anything else, or not one point in each
/// number if they should have one.
#[inline(always)]
pub(super) fn digits<const WORDS: usize>(
    words: &[Lanes<u64>; WORDS],
    lengths: &Lanes<u64>,
    has_points: bool,
) -> Option<Digits> {
    let mut to = Digits { mantissa: [0; LANES], decimals: [0; LANES] };
    let mut any_wrong = 0;
    for lane in 0..LANES {
        let mut text = [0; WORDS];
        let mut points = [0; WORDS];
        for at in 0..WORDS {
            let others = 8 * (WORDS - 1 - at) as u64;
            let inside = last_bytes(lengths[lane].saturating_sub(others).min(8));
            points[at] = points_of(words[at][lane]) & inside;
            text[at] = (words[at][lane] ^ ZEROS) & inside;
        }
        let mut wrong = u64::from(lengths[lane] <= u64::from(has_points));
        if has_points {
            let (decimals, is_wrong) = remove_point(&mut text, points);
            to.decimals[lane] = decimals;
            wrong |= is_wrong;
        }
        let mut mantissa = 0u64;
        for word in text {
            wrong |= (word.wrapping_add(0x76 * ONES) | word) & (0x80 * ONES);
            mantissa = mantissa.wrapping_mul(100_000_000).wrapping_add(eight_digits(word));
        }
        to.mantissa[lane] = mantissa;
        any_wrong |= wrong;
    }
    (any_wrong == 0).then_some(to)
}

/// Moves the digits before the point towards those after it. Returns how many are after it, and
/// something else than 0 if there is not one point.
#[inline(always)]
fn remove_point<const WORDS: usize>(text: &mut [u64; WORDS], points: [u64; WORDS]) -> (u64, u64) {
    let (mut earlier, mut decimals, mut wrong) = (0, 0, 0);
    // All bits, once the point has been seen.
    let mut is_after = 0u64;
    for at in 0..WORDS {
        let word = text[at];
        let point = points[at] >> 7;
        let before = point.wrapping_sub(1);
        let after = !(point << 8).wrapping_sub(1);
        let moved = (word & before) << 8 | word & after | earlier >> 56;
        text[at] = word & is_after | moved & !is_after;
        decimals += ((after | is_after) & ONES).wrapping_mul(ONES) >> 56;
        wrong |= point & before | point & is_after;
        is_after |= if point == 0 { 0 } else { u64::MAX };
        earlier = word;
    }
    (decimals, wrong | !is_after)
}

/// The last bytes of a word, which are the highest.
#[inline(always)]
fn last_bytes(count: u64) -> u64 {
    // Twice, because a shift by 64 bits is none.
    !(u64::MAX >> (4 * count) >> (4 * count))
}

/// The highest bit of each byte that is a point.
#[inline(always)]
fn points_of(word: u64) -> u64 {
    let other = word ^ (u64::from(b'.') * ONES);
    let is_other = ((other & (0x7f * ONES)) + 0x7f * ONES) | other;
    !is_other & (0x80 * ONES)
}

/// The number with eight digits, the first one in the lowest byte, by steps that every vector
/// instruction set has.
#[inline(always)]
fn eight_digits(digits: u64) -> u64 {
    const QUARTERS: u64 = 0x00ff_00ff_00ff_00ff;
    const HALVES: u64 = 0x0000_ffff_0000_ffff;
    // Bytes that are no digits may overflow; they are refused elsewhere.
    let tens = (digits << 3).wrapping_add(digits << 1);
    let pairs = tens.wrapping_add(digits >> 8) & QUARTERS;
    let high = pairs & HALVES;
    let fours = (high << 6) + (high << 5) + (high << 2) + (pairs >> 16 & HALVES);
    (fours & 0xffff) * 10_000 + (fours >> 32)
}
