//! Nested uniform scrambling (Owen 1995, "Randomly permuted (t,m,s)-nets and (t,s)-sequences") by a
//! hash.
//!
//! The unit interval is halved and the halves are swapped at random; then each half is treated
//! likewise, and so on for 32 levels. Each swap depends on the position of the two halves, that is,
//! on the preceding digits. In a bit-reversed number, the flip of a bit depends only on the bits
//! below it. Addition, multiplication by an odd number, and `x ^= x * even` all have this property
//! (Laine and Karras 2011, "Stratified Sampling for Stochastic Transparency", section 3.1), and a
//! few of them make a good hash. The fixed multipliers are those of Vegdahl 2021, "Building a
//! Better LK Hash"; the use with the Sobol sequence is Burley's (2020, "Practical Hash-based Owen
//! Scrambling", JCGT 9(4)).
//!
//! Both have one addition and one multiplication that depend on the key. Modulo 8 these produce 32
//! of the 128 ways to swap the upper three levels; with one more exclusive or and one more
//! `x ^= x * even` all 128 occur, equally often.

/// Scrambles a bit-reversed number.
#[inline(always)]
pub(super) fn owen_scramble_reversed(mut x: u32, key: u64) -> u32 {
    let [added, factor, flipped, even] = [0, 16, 32, 48].map(|bits| key.rotate_right(bits) as u32);
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(added);
    x = x.wrapping_mul(factor | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^= flipped;
    x ^= x.wrapping_mul(even << 1);
    x ^ x.wrapping_mul(0x53a2_2864)
}

/// Number of binary digits of a coordinate that are shifted: those that 16 points stratify.
const SHIFTED_DIGITS: u32 = 4;

/// Scrambles a bit-reversed coordinate of a point. Of the binary digits, the first two are added to
/// the next two, and all four shifted by the same number in all points. Lower digits are scrambled
/// as by [`owen_scramble_reversed`].
///
/// Nested scrambling makes all perfect pairs alike: it fixes the distribution of any two of their
/// points. A shift keeps the pattern of the first 16 points, which can then be chosen. Linear
/// scrambles of the four digits (Matousek 1998, "On the L2-Discrepancy for Anchored Boxes"), 64 in
/// each dimension, have in the mean the variance of nested scrambling. That of this one is among
/// the least for edges that lie anywhere, in two dimensions and in four, and is less by a sixth.
#[inline(always)]
pub(super) fn scramble_reversed(point: u32, key: u64) -> u32 {
    const SHIFTED: u32 = (1 << SHIFTED_DIGITS) - 1;
    // The hash lets these bits of the key act on digits below the 13th alone.
    let shift = (key >> (64 - SHIFTED_DIGITS)) as u32;
    let upper = point ^ point << 2 ^ shift;
    owen_scramble_reversed(point, key) & !SHIFTED | upper & SHIFTED
}

/// Shuffles a bit-reversed index within every aligned block of 2^k that begins at 0.
///
/// Scrambling alone would move the index to another aligned block. Mapping 0 back to 0 adds a
/// constant to the index, without carry, and so one to every coordinate, which scrambling the
/// coordinates undoes: the points have the same distribution, and a small index stays small.
#[inline(always)]
pub(super) fn shuffle_reversed(index: u32, key: u64) -> u32 {
    owen_scramble_reversed(index, key) ^ owen_scramble_reversed(0, key)
}

#[cfg(test)]
mod tests {
    use super::super::split_mix;
    use super::*;

    /// Scrambles the fraction of 2^32 that a number represents.
    fn scrambled(x: u32, key: u64) -> u32 {
        owen_scramble_reversed(x.reverse_bits(), key).reverse_bits()
    }

    /// Scrambles the fraction of 2^32 that a coordinate represents.
    fn scrambled_coordinate(x: u32, key: u64) -> u32 {
        scramble_reversed(x.reverse_bits(), key).reverse_bits()
    }

    #[test]
    fn digits_depend_on_the_digits_before_only() {
        for i in 0..1000 {
            let (x, key) = (split_mix(1, i) as u32, split_mix(2, i));
            for digit in 0..32 {
                let other = x ^ (1 << (31 - digit));
                for scramble in [scrambled, scrambled_coordinate] {
                    let differ = scramble(x, key) ^ scramble(other, key);
                    assert_eq!(differ.leading_zeros(), digit);
                }
            }
        }
    }

    #[test]
    fn upper_digits_of_coordinates_are_shifted_and_lower_ones_nested() {
        // All 16 shifts are equally likely: chi-square with 15 degrees of freedom over 2^14 keys;
        // 60 is exceeded with a probability of 2e-7.
        let mut counts = [0u32; 16];
        for i in 0..1 << 14 {
            let key = split_mix(7, i);
            let upper = |x: u32| scrambled_coordinate(x << 28, key) >> 28;
            let shift = upper(0);
            // The first two digits, which are the higher bits, are added to the next two.
            assert!((0..16).all(|x| upper(x) == x ^ x >> 2 ^ shift));
            counts[shift as usize] += 1;
            let x = split_mix(8, i) as u32;
            let lower = |x: u32| x & (u32::MAX >> 4);
            assert_eq!(lower(scrambled_coordinate(x, key)), lower(scrambled(x, key)));
        }
        let chi2: f64 = counts.iter().map(|&c| (f64::from(c) - 1024.0).powi(2) / 1024.0).sum();
        assert!(chi2 < 60.0, "{chi2}: {counts:?}");
    }

    #[test]
    fn shifts_are_independent_of_the_swaps_below() {
        // Each digit of the shift with the swap at each lower level: 3 degrees of freedom; 45 is
        // exceeded with a probability of 1e-9 (112 tables).
        let keys = 1 << 14;
        let x = split_mix(9, 0) as u32;
        for level in 4..32 {
            for digit in 0..4 {
                let mut counts = [0u32; 4];
                for i in 0..keys {
                    let changed = scrambled_coordinate(x, split_mix(10, i)) ^ x;
                    let [shift, swap] = [digit, level].map(|place| changed >> (31 - place) & 1);
                    counts[(2 * shift + swap) as usize] += 1;
                }
                let expected = f64::from(keys) / 4.0;
                let chi2: f64 =
                    counts.iter().map(|&c| (f64::from(c) - expected).powi(2) / expected).sum();
                assert!(chi2 < 45.0, "digit {digit}, level {level}: {counts:?}");
            }
        }
    }

    /// Returns the swaps in the upper three levels of the tree: 7 bits.
    fn swaps(key: u64) -> usize {
        let nodes = [(0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2), (2, 3)];
        let swap = |(level, node): (u32, u32)| {
            let x = if level == 0 { 0 } else { node << (32 - level) };
            ((scrambled(x, key) ^ x) >> (31 - level) & 1) as usize
        };
        nodes.into_iter().enumerate().map(|(bit, node)| swap(node) << bit).sum()
    }

    #[test]
    fn all_ways_to_swap_the_upper_halves_are_equally_likely() {
        // Chi-square with 127 degrees of freedom over 2^17 keys: 210 is exceeded with a probability
        // of 5e-6.
        let mut counts = [0u32; 128];
        (0..1 << 17).for_each(|i| counts[swaps(split_mix(3, i))] += 1);
        let chi2: f64 = counts.iter().map(|&c| (f64::from(c) - 1024.0).powi(2) / 1024.0).sum();
        assert!(chi2 < 210.0, "{chi2}: {counts:?}");
    }

    #[test]
    fn deep_swaps_are_fair_and_independent_of_each_other() {
        // Two nodes of one level and a node with its parent, at all levels: each joint table has
        // 3 degrees of freedom; 45 is exceeded with a probability of 1e-9 (about 300 tables).
        let keys = 1 << 14;
        let swap = |x: u32, level: u32, key| (scrambled(x, key) ^ x) >> (31 - level) & 1;
        for level in 1..32 {
            for pair in 0..5 {
                let (x, y) = (
                    split_mix(4, level * 10 + pair) as u32,
                    split_mix(5, level * 10 + pair) as u32,
                );
                for (y, other) in [(y, level), (x, level - 1)] {
                    let mut counts = [0u32; 4];
                    for i in 0..keys {
                        let key = split_mix(6, i);
                        counts[(2 * swap(x, level, key) + swap(y, other, key)) as usize] += 1;
                    }
                    let expected = f64::from(keys) / 4.0;
                    let chi2: f64 =
                        counts.iter().map(|&c| (f64::from(c) - expected).powi(2) / expected).sum();
                    let same_node = other == level && (x ^ y).leading_zeros() >= level;
                    assert!(same_node || chi2 < 45.0, "level {level}, {x:#x} {y:#x}: {counts:?}");
                }
            }
        }
    }
}
