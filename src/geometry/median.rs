//! Median of very many numbers, computed in parallel without copying them.

use rayon::prelude::*;

/// Each of two passes distinguishes half of the bits of an f32.
const DIGITS: usize = 1 << 16;
/// Numbers counted per task; each task costs a table of [`DIGITS`] counts.
const CHUNK_SIZE: usize = 1 << 22;

/// Returns the lower median, by `f32::total_cmp`, of the values of `items` items, which are given
/// by index; 0 if there are none.
pub(super) fn lower_median(items: usize, value: impl Fn(usize) -> Option<f32> + Sync) -> f32 {
    let high = |key: u32| Some((key >> 16) as usize);
    let counts = count(items, &value, high);
    let total: u64 = counts.iter().sum();
    let Some(max_rank) = total.checked_sub(1) else { return 0.0 };
    let (first_half, rest) = locate(&counts, max_rank / 2);
    let low = |key: u32| (high(key) == Some(first_half)).then_some(key as usize % DIGITS);
    let (second_half, _) = locate(&count(items, &value, low), rest);
    from_key((first_half << 16 | second_half) as u32)
}

/// Counts the items with each digit.
fn count(
    items: usize,
    value: &(impl Fn(usize) -> Option<f32> + Sync),
    digit: impl Fn(u32) -> Option<usize> + Sync,
) -> Vec<u64> {
    let count_chunk = |chunk: usize| {
        let mut counts = vec![0u64; DIGITS];
        let items = chunk * CHUNK_SIZE..items.min((chunk + 1) * CHUNK_SIZE);
        let digits = items.filter_map(|item| digit(to_key(value(item)?)));
        digits.for_each(|digit| counts[digit] += 1);
        counts
    };
    let add_counts = |mut a: Vec<u64>, b: Vec<u64>| {
        a.iter_mut().zip(b).for_each(|(a, b)| *a += b);
        a
    };
    let chunks = (0..items.div_ceil(CHUNK_SIZE)).into_par_iter();
    chunks.map(count_chunk).reduce_with(add_counts).unwrap_or_else(|| vec![0; DIGITS])
}

/// Returns the digit of the item with this rank, and its rank among those of the same digit.
fn locate(counts: &[u64], mut rank: u64) -> (usize, u64) {
    for (digit, &count) in counts.iter().enumerate() {
        match rank.checked_sub(count) {
            None => return (digit, rank),
            Some(rest) => rank = rest,
        }
    }
    (0, 0)
}

/// Maps numbers to keys in the order of `f32::total_cmp`.
fn to_key(value: f32) -> u32 {
    let bits = value.to_bits();
    if bits >> 31 == 1 { !bits } else { bits | 1 << 31 }
}

fn from_key(key: u32) -> f32 {
    f32::from_bits(if key >> 31 == 1 { key ^ 1 << 31 } else { !key })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn of_none_it_is_0() {
        assert_eq!(lower_median(2, |_| None), 0.0);
    }

    #[test]
    fn more_numbers_than_are_counted_at_once_are_counted_together() {
        // A full table of one number and half a table of a smaller one.
        let value = |i: usize| Some(if i < CHUNK_SIZE { 5.0 } else { -7.0 });
        assert_eq!(lower_median(CHUNK_SIZE + CHUNK_SIZE / 2, value), 5.0);
    }

    proptest! {
        #[test]
        fn it_is_what_sorting_finds(
            mut values in proptest::collection::vec(prop_oneof![-1f32..1.0, any::<f32>(), Just(-0.0)], 1..300),
        ) {
            let found = lower_median(values.len(), |i| Some(values[i]));
            values.sort_unstable_by(f32::total_cmp);
            prop_assert_eq!(found.to_bits(), values[(values.len() - 1) / 2].to_bits());
        }
    }
}
