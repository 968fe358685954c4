//! The generator matrices: four dimensions of Niederreiter's (0, 4)-sequence in base 4.
//!
//! An index is read as a vector of base-4 digits, lowest first, and a digit as an element of the
//! field GF(4) = {0, 1, w, w^2} with w^2 = w + 1. Dimension `d` multiplies the vector by Pascal's
//! matrix with powers of the d-th element (Faure 1982; Niederreiter 1987, "Point Sets and Sequences
//! with Small Discrepancy"). Of an aligned block of 4^m points, each box with sides 4^-k and volume
//! 4^-m holds one. Elements are pairs of bits, so everything here is linear over GF(2), as in
//! Sobol's sequence.
//!
//! The two bits that represent an element are chosen such that dimensions 0 and 1, and 2 and 3, are
//! (0, 2)-sequences in base 2 as well: of an aligned block of 2^m points, each box with sides 2^-k
//! and area 2^-m holds one. Ahmed, Pharr, Ostromoukhov and Huang 2025, "SZ Sequences: Binary-Based
//! (0, 2^q)-Sequences", found such sequences by a search.

/// Number of dimensions, equal to the size of a set; GF(4) has no more elements.
pub(super) const DIMENSIONS: usize = 4;

/// Contribution of each group of four index bits to the point, in all dimensions. The first group
/// is that of the lowest four bits, lowest bit first.
static TABLES: [[[u32; 16]; 8]; DIMENSIONS] = direction_tables();

/// Returns a coordinate of a point of the sequence. The index and the coordinate are bit-reversed:
/// bit 31 of the index is worth 1, bit 0 of the coordinate is worth 1/2.
pub(super) fn reversed_point(mut reversed_index: u32, dimension: usize) -> u32 {
    if dimension == 0 {
        return reversed_index.reverse_bits(); // van der Corput: the reversed index is the point
    }
    let mut point = 0;
    for group in &TABLES[dimension] {
        if reversed_index == 0 {
            break;
        }
        point ^= group[(reversed_index >> 28) as usize];
        reversed_index <<= 4;
    }
    point
}

/// Returns the contribution of a bit of the reversed index to a coordinate of its point.
pub(super) fn direction_number(dimension: u32, bit: u32) -> u32 {
    reversed_point(1 << bit, dimension as usize)
}

const fn direction_tables() -> [[[u32; 16]; 8]; DIMENSIONS] {
    let mut tables = [[[0; 16]; 8]; DIMENSIONS];
    let mut dimension = 1;
    while dimension < DIMENSIONS {
        let directions = direction_numbers(dimension as u32);
        let mut entry = 0;
        while entry < 8 * 16 * 4 {
            let (group, bits, bit) = (entry / 64, entry / 4 % 16, entry % 4);
            if bits >> (3 - bit) & 1 == 1 {
                tables[dimension][group][bits] ^= directions[4 * group + bit].reverse_bits();
            }
            entry += 1;
        }
        dimension += 1;
    }
    tables
}

/// Computes the direction numbers of a dimension, binary fractions in 32 bits: the contribution of
/// each index bit to the point.
const fn direction_numbers(dimension: u32) -> [u32; 32] {
    let mut directions = [0; 32];
    let mut bit = 0;
    while bit < 32 {
        let column = bit / 2;
        // Row `row` of Pascal's matrix has C(column, row) a^(column - row), and the binomial
        // coefficient is odd where `row` has no bit that `column` lacks (Lucas).
        let mut power = 1 << (bit % 2);
        let mut row = column + 1;
        while row > 0 {
            row -= 1;
            if row & column == row {
                directions[bit] |= digit(power, dimension) << (30 - 2 * row);
            }
            power = multiply(power, dimension);
        }
        bit += 1;
    }
    directions
}

/// Returns the two bits of a coordinate that represent an element.
const fn digit(element: u32, dimension: u32) -> u32 {
    let [one, omega] = [element & 1, element >> 1];
    let upper = if dimension % 2 == 0 { one } else { one ^ omega };
    upper << 1 | omega
}

/// Multiplies elements of the field: polynomials over GF(2) modulo x^2 + x + 1.
const fn multiply(a: u32, b: u32) -> u32 {
    let product = ((a & 1) * b) ^ ((a >> 1) * (b << 1));
    product ^ ((product >> 2) * 0b111)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(index: u32, dimension: usize) -> f64 {
        f64::from(reversed_point(index.reverse_bits(), dimension).reverse_bits()) / 2f64.powi(32)
    }

    #[test]
    fn the_first_points_follow_by_hand() {
        // Digits 1, w, w^2 are 0.5, 0.25, 0.75 in even dimensions and 0.5, 0.75, 0.25 in odd ones;
        // index 4 is digit 1 in the second place plus d in the first.
        let expected = [
            [0.0, 0.0, 0.0, 0.0],
            [0.5, 0.5, 0.5, 0.5],
            [0.25, 0.75, 0.25, 0.75],
            [0.75, 0.25, 0.75, 0.25],
            [0.125, 0.625, 0.375, 0.375],
            [0.625, 0.125, 0.875, 0.875],
            [0.375, 0.375, 0.125, 0.625],
            [0.875, 0.875, 0.625, 0.125],
        ];
        for (index, coordinates) in expected.into_iter().enumerate() {
            for (dimension, expected) in coordinates.into_iter().enumerate() {
                assert_eq!(point(index as u32, dimension), expected, "{index} {dimension}");
            }
        }
    }

    #[test]
    fn elements_form_a_field() {
        for a in 0..4 {
            for b in 0..4 {
                assert_eq!(multiply(a, b), multiply(b, a));
                assert_eq!(multiply(a, b) == 0, a == 0 || b == 0);
                for c in 0..4 {
                    assert_eq!(multiply(a, b ^ c), multiply(a, b) ^ multiply(a, c));
                    assert_eq!(multiply(a, multiply(b, c)), multiply(multiply(a, b), c));
                }
            }
            assert_eq!(multiply(a, 1), a);
        }
        assert_eq!(multiply(2, 2), 2 ^ 1, "w^2 = w + 1");
    }

    /// Returns the rows of a dimension's matrix: bit `k` of a row belongs to index bit `k`.
    fn rows(dimension: u32) -> [u32; 32] {
        let directions = direction_numbers(dimension);
        std::array::from_fn(|row| (0..32).map(|k| (directions[k] >> (31 - row) & 1) << k).sum())
    }

    /// Returns true if no row is a sum of others, looking at the lower `columns` bits.
    fn independent(rows: impl Iterator<Item = u32>, columns: u32) -> bool {
        let mut basis = [0u32; 32];
        rows.into_iter().all(|row| {
            let mut row = row & (u32::MAX >> (32 - columns));
            while row != 0 && basis[row.ilog2() as usize] != 0 {
                row ^= basis[row.ilog2() as usize];
            }
            if row != 0 {
                basis[row.ilog2() as usize] = row;
            }
            row != 0
        })
    }

    #[test]
    fn both_pairs_are_perfect_in_base_2_at_every_count() {
        for [a, b] in [[0, 1], [2, 3]].map(|pair| pair.map(rows)) {
            for m in 1..=32 {
                for k in 0..=m {
                    let upper = a.into_iter().take(k).chain(b.into_iter().take(m - k));
                    assert!(independent(upper, m as u32), "2^{m} points, {k} digits of the first");
                }
            }
        }
    }

    #[test]
    fn all_four_are_perfect_in_base_4_at_every_count() {
        let all = [0, 1, 2, 3].map(rows);
        let mut checked = 0;
        for m in 1..=16 {
            for i in 0..=m {
                for j in 0..=m - i {
                    for k in 0..=m - i - j {
                        let digits = [i, j, k, m - i - j - k];
                        let upper = all.iter().zip(digits).flat_map(|(rows, n)| &rows[..2 * n]);
                        assert!(independent(upper.copied(), 2 * m as u32), "{digits:?}");
                        checked += 1;
                    }
                }
            }
        }
        assert_eq!(checked, 4844);
    }
}
