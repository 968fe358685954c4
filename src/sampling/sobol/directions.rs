//! The Sobol sequence: a binary matrix for each dimension.
//!
//! The matrices are derived from primitive polynomials over GF(2) and a few odd initial numbers,
//! those of Joe and Kuo 2008, "Constructing Sobol sequences with better two-dimensional
//! projections", SIAM J. Sci. Comput. 30(5), table `new-joe-kuo-6.21201`.

/// Number of dimensions in the table, equal to the size of a set; see `docs/sampling.md`.
pub(super) const DIMENSIONS: usize = 4;

/// One dimension: the degree `s` of its polynomial, the polynomial's inner coefficients `a` as
/// bits, and the initial numbers `m_1 ... m_s`, padded with 0.
type Initial = (usize, u32, [u32; 3]);

/// The dimensions after the first, which is van der Corput's and needs no table.
const INITIAL: [Initial; DIMENSIONS - 1] =
    [(1, 0, [1, 0, 0]), (2, 1, [1, 3, 0]), (3, 1, [1, 3, 1])];

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
        let directions = direction_numbers(INITIAL[dimension - 1]);
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

/// Computes the direction numbers, binary fractions in 32 bits: the contribution of each index bit
/// to the point.
const fn direction_numbers((degree, coefficients, initial): Initial) -> [u32; 32] {
    let mut v = [0; 32];
    let mut k = 0;
    while k < 32 {
        v[k] = if k < degree {
            initial[k] << (31 - k)
        } else {
            v[k - degree] ^ (v[k - degree] >> degree)
        };
        let mut i = 1;
        while i < degree && k >= degree {
            if coefficients >> (degree - 1 - i) & 1 == 1 {
                v[k] ^= v[k - i];
            }
            i += 1;
        }
        k += 1;
    }
    v
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(index: u32, dimension: usize) -> f64 {
        f64::from(reversed_point(index.reverse_bits(), dimension).reverse_bits()) / 2f64.powi(32)
    }

    #[test]
    fn the_first_points_are_sobols() {
        // In index order, without the Gray code: computed by hand from the table.
        let expected = [
            [0.0, 0.0, 0.0, 0.0],
            [0.5, 0.5, 0.5, 0.5],
            [0.25, 0.75, 0.75, 0.75],
            [0.75, 0.25, 0.25, 0.25],
            [0.125, 0.625, 0.375, 0.125],
            [0.625, 0.125, 0.875, 0.625],
            [0.375, 0.375, 0.625, 0.875],
            [0.875, 0.875, 0.125, 0.375],
        ];
        for (index, coordinates) in expected.into_iter().enumerate() {
            for (dimension, expected) in coordinates.into_iter().enumerate() {
                assert_eq!(point(index as u32, dimension), expected, "{index} {dimension}");
            }
        }
    }

    #[test]
    fn direction_numbers_follow_from_the_ones_before() {
        // m_k = 2 a_1 m_(k-1) ^ 4 a_2 m_(k-2) ^ ... ^ 2^s m_(k-s) ^ m_(k-s), by hand.
        let numbers = |initial| -> [u32; 6] {
            let v = direction_numbers(initial);
            std::array::from_fn(|k| v[k] >> (31 - k))
        };
        let expected = [[1, 3, 5, 15, 17, 51], [1, 3, 3, 9, 29, 23], [1, 3, 1, 5, 31, 29]];
        assert_eq!(INITIAL.map(numbers), expected);
    }

    #[test]
    fn the_table_obeys_its_rules() {
        for (row, (degree, coefficients, initial)) in INITIAL.into_iter().enumerate() {
            let polynomial = 1 << degree | coefficients << 1 | 1;
            assert_eq!(order_of_x(polynomial, degree), (1 << degree) - 1, "primitive, row {row}");
            for (k, m) in initial.into_iter().enumerate() {
                let allowed = if k < degree { m % 2 == 1 && m < 2 << k } else { m == 0 };
                assert!(allowed, "row {row}: m_{} = {m}", k + 1);
            }
        }
    }

    /// Returns the smallest power of x that is 1 modulo the polynomial.
    fn order_of_x(polynomial: u32, degree: usize) -> u32 {
        let (mut power, mut order) = (1u32, 0);
        loop {
            power <<= 1;
            if power >> degree & 1 == 1 {
                power ^= polynomial;
            }
            order += 1;
            if power == 1 {
                return order;
            }
        }
    }

    #[test]
    fn every_dimension_by_itself_visits_every_cell_once() {
        for dimension in 0..DIMENSIONS {
            let mut seen = vec![false; 1024];
            for index in 3 * 1024..4 * 1024 {
                let cell = (point(index, dimension) * 1024.0) as usize;
                assert!(!std::mem::replace(&mut seen[cell], true));
            }
        }
    }
}
