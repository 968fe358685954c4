//! Multi-jittered random numbers: one sample in each of as many cells as the pixel has samples.
//!
//! The square of two dimensions is divided into columns and rows, as the paper divides a pixel, and
//! every cell holds one sample at a random position. Within a row of cells the samples are spread
//! over finer columns, and within a column over finer rows, so that each dimension by itself is
//! stratified too (Chiu, Shirley and Wang 1994, "Multi-jittered Sampling"; Kensler 2013,
//! "Correlated Multi-Jittered Sampling", whose table-free permutation is used). Every column and
//! every row of cells has its own permutation, as in Chiu et al.: with a single permutation, as in
//! Kensler, the error of a smooth integral falls more slowly than that of plain jitter. The
//! assignment of samples to cells is permuted for every pair of dimensions, so that pairs are
//! independent of one another.

use super::independent::{GAMMA, pixel_key, split_mix};

/// Maximum number of cells of a pair; further samples start another round.
const MAX_CELLS: u32 = 1 << 30;

/// The random numbers of one sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Stratified {
    key: u64,
    /// Index of the cell before permutation.
    cell: u32,
    columns: u32,
    rows: u32,
}

impl Stratified {
    /// `samples` is the pixel's total sample count. If they do not fill a rectangle, some cells
    /// stay empty, chosen at random.
    pub(super) fn new(seed: u64, pixel: u64, sample: u32, samples: u32) -> Self {
        let samples = samples.clamp(1, MAX_CELLS);
        let columns = samples.isqrt();
        let rows = samples.div_ceil(columns);
        let cells = columns * rows;
        let (round, cell) = (sample / cells, sample % cells);
        Self { key: split_mix(pixel_key(seed, pixel), round), cell, columns, rows }
    }

    /// Returns the numbers of dimensions `2 pair` and `2 pair + 1`, in `[0, 1]`.
    pub(super) fn pair(self, pair: u32) -> [f64; 2] {
        let Self { columns, rows, .. } = self;
        let key = split_mix(self.key, pair);
        let cell = permute(self.cell, columns * rows, key);
        let (column, row) = (cell % columns, cell / columns);
        // Each column of cells, and each row, is permuted on its own.
        let [column_key, row_key] = [(0, column), (1, row)]
            .map(|(axis, cell)| split_mix(split_mix(key, MAX_CELLS + axis), cell));
        let substratum = [permute(row, rows, column_key), permute(column, columns, row_key)];
        let jitter = split_mix(key, self.cell);
        let [x, y] = [jitter as u32, (jitter >> 32) as u32].map(to_unit_interval);
        [
            (f64::from(column) + (f64::from(substratum[0]) + x) / f64::from(rows))
                / f64::from(columns),
            (f64::from(row) + (f64::from(substratum[1]) + y) / f64::from(columns))
                / f64::from(rows),
        ]
    }
}

fn to_unit_interval(bits: u32) -> f64 {
    (f64::from(bits) + 0.5) * (1.0 / (1u64 << 32) as f64)
}

/// Returns the image of `index` under a random permutation of `0..length` selected by `key`: a
/// keyed bijection of the next power of two, repeated until the result is below `length`, then a
/// rotation by a random offset. Only the rotation makes all positions equally likely for each
/// index: if `length` is not a power of two, the bijection alone is biased.
fn permute(index: u32, length: u32, key: u64) -> u32 {
    let mask = length.next_power_of_two() - 1;
    let half = mask.count_ones().div_ceil(2);
    let rotation = ((key.wrapping_mul(GAMMA) >> 32) * u64::from(length)) >> 32;
    let mut x = index;
    loop {
        for round in 0..4 {
            let bits = (key >> (16 * round)) as u32;
            x = x.wrapping_add(bits) & mask;
            x = x.wrapping_mul(bits.wrapping_mul(0x9e37_79b1) >> 8 | 1) & mask;
            x ^= x >> half;
            x = x.wrapping_mul(0x2c1b_3c6d) & mask;
            x ^= x >> half;
        }
        if x < length {
            return (x + rotation as u32) % length;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_within_a_cell_reach_neither_of_its_ends() {
        let [first, last] = [0, u32::MAX].map(to_unit_interval);
        assert!(first > 0.0 && last < 1.0);
        assert_eq!(first, 1.0 - last);
    }

    #[test]
    fn permutations_permute() {
        for length in [1, 2, 3, 16, 17, 100, 1000] {
            for key in 0..20 {
                let key = split_mix(7, key);
                let mut seen = vec![false; length as usize];
                for index in 0..length {
                    seen[permute(index, length, key) as usize] = true;
                }
                assert!(seen.into_iter().all(|seen| seen));
            }
        }
    }

    #[test]
    fn every_cell_row_and_column_holds_one_sample() {
        for (samples, columns, rows) in [(16, 4, 4), (12, 3, 4), (64, 8, 8)] {
            for pair in 0..10 {
                let mut seen = [vec![0; samples], vec![0; samples], vec![0; samples]];
                for sample in 0..samples {
                    let numbers = Stratified::new(3, 5, sample as u32, samples as u32);
                    let [x, y] = numbers.pair(pair);
                    let in_cells = |u: f64, cells: usize| (u * cells as f64) as usize;
                    seen[0][in_cells(y, rows) * columns + in_cells(x, columns)] += 1;
                    seen[1][in_cells(x, samples)] += 1;
                    seen[2][in_cells(y, samples)] += 1;
                }
                assert!(seen.iter().flatten().all(|&count| count == 1), "{samples}: {seen:?}");
            }
        }
    }
}
