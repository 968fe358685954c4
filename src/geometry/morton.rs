//! Sorting spheres along a Morton curve, so that neighbours in space are neighbours in memory.

use rayon::prelude::*;

use crate::math::Vec3;

/// Spheres to sort, by index.
pub(super) trait SortableSpheres: Sync {
    /// Number of spheres.
    fn len(&self) -> usize;
    /// The sphere in f32, for its position along the curve.
    fn rounded(&self, index: usize) -> [f32; 4];
    /// All bits of the sphere as written, and its row: breaks ties between equal positions.
    fn rank(&self, index: usize) -> ([u64; 4], u32);
    /// Returns true if the sphere belongs at the end.
    fn is_last(&self, index: usize) -> bool;
}

/// Returns the indices of the spheres in Morton order, and the curve. Equal spheres are adjacent,
/// the one with the smaller row first. Spheres that are last are in index order.
///
/// Sorts 8-byte keys (a 30-bit code and the index) and breaks ties with a 63-bit code, so that a
/// cluster far smaller than the bounding box is sorted too.
pub(super) fn morton_order(spheres: &impl SortableSpheres) -> (Vec<u32>, MortonCurve) {
    let curve = MortonCurve::fit(spheres);
    let keys = sorted_keys(spheres, curve);
    (keys.par_iter().map(|&key| index_of(key) as u32).collect(), curve)
}

fn sorted_keys(spheres: &impl SortableSpheres, curve: MortonCurve) -> Vec<u64> {
    let key = |index: u32| {
        let code = match spheres.is_last(index as usize) {
            true => u32::MAX,
            false => curve.coarse_code(&spheres.rounded(index as usize)),
        };
        u64::from(code) << 32 | u64::from(index)
    };
    let count = u32::try_from(spheres.len()).expect("the scene checks the number of spheres");
    let mut keys: Vec<u64> = (0..count).into_par_iter().map(key).collect();
    keys.par_sort_unstable();
    let rank = |&key: &u64| {
        let index = index_of(key);
        (curve.fine_code(&spheres.rounded(index)), spheres.rank(index))
    };
    keys.par_chunk_by_mut(|a, b| a >> 32 == b >> 32)
        .filter(|cell| cell.len() > 1 && cell[0] >> 32 != u64::from(u32::MAX))
        .for_each(|cell| cell.par_sort_unstable_by_key(rank));
    keys
}

fn index_of(key: u64) -> usize {
    (key & u64::from(u32::MAX)) as usize
}

/// A Morton curve over a box, which contains nearly all centres: a single distant emitter must not
/// squeeze the rest into a few cells. Centres outside the box are sorted into the cells at its
/// edge.
#[derive(Clone, Copy, Debug)]
pub(super) struct MortonCurve {
    low: Vec3,
    high: Vec3,
}

/// Number of centres sampled to compute the box.
const SAMPLE_SIZE: usize = 1 << 14;
/// One in this many samples may lie outside, at either end of an axis.
const OUTLIER_DIVISOR: usize = 1000;

impl MortonCurve {
    fn fit(spheres: &impl SortableSpheres) -> Self {
        let step = spheres.len().div_ceil(SAMPLE_SIZE).max(1);
        let sampled = || (0..spheres.len()).step_by(step).map(|index| spheres.rounded(index));
        let range = |axis: usize| {
            let mut values: Vec<f32> = sampled().map(|sphere| sphere[axis]).collect();
            values.sort_unstable_by(f32::total_cmp);
            let outliers = values.len() / OUTLIER_DIVISOR;
            let high = values.len().saturating_sub(1 + outliers);
            (values.get(outliers).copied().unwrap_or(0.0), values.get(high).copied().unwrap_or(0.0))
        };
        let [x, y, z] = [range(0), range(1), range(2)];
        Self { low: Vec3::new(x.0, y.0, z.0), high: Vec3::new(x.1, y.1, z.1) }
    }

    fn coarse_code(self, sphere: &[f32; 4]) -> u32 {
        (self.fine_code(sphere) >> 33) as u32
    }

    /// Returns the code: 21 bits per axis, interleaved, x highest.
    pub(super) fn fine_code(self, &[x, y, z, _]: &[f32; 4]) -> u64 {
        const CELLS: f32 = (1u32 << 21) as f32;
        let extent = (self.high - self.low).max(Vec3::splat(f32::MIN_POSITIVE));
        let cell = ((Vec3::new(x, y, z) - self.low) / extent * CELLS)
            .clamp(Vec3::ZERO, Vec3::splat(CELLS - 1.0));
        let [x, y, z] = cell.to_array().map(|c| spread_bits(c as u32));
        x << 2 | y << 1 | z
    }
}

/// Inserts two zero bits between the low 21 bits.
fn spread_bits(bits: u32) -> u64 {
    let mut v = u64::from(bits) & 0x1f_ffff;
    v = (v | v << 32) & 0x001f_0000_0000_ffff;
    v = (v | v << 16) & 0x001f_0000_ff00_00ff;
    v = (v | v << 8) & 0x100f_00f0_0f00_f00f;
    v = (v | v << 4) & 0x10c3_0c30_c30c_30c3;
    (v | v << 2) & 0x1249_2492_4924_9249
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Spheres in f32, and the index of those that come last.
    struct Listed<'a>(&'a [[f32; 4]], fn(usize) -> bool);

    impl SortableSpheres for Listed<'_> {
        fn len(&self) -> usize {
            self.0.len()
        }

        fn rounded(&self, index: usize) -> [f32; 4] {
            self.0[index]
        }

        fn rank(&self, index: usize) -> ([u64; 4], u32) {
            (self.0[index].map(|x| x.to_bits().into()), index as u32)
        }

        fn is_last(&self, index: usize) -> bool {
            self.1(index)
        }
    }

    fn order(spheres: &[[f32; 4]], is_last: fn(usize) -> bool) -> Vec<u32> {
        morton_order(&Listed(spheres, is_last)).0
    }

    #[test]
    fn spreading_leaves_two_gaps_between_bits() {
        assert_eq!(spread_bits(0b111), 0b1_001_001);
        assert_eq!(spread_bits(0x1f_ffff).count_ones(), 21);
        assert_eq!(spread_bits(1 << 20), 1 << 60);
    }

    #[test]
    fn order_is_a_permutation_with_equal_spheres_side_by_side() {
        let position = |x: f32| [x, 0.0, 0.0, 1.0];
        let spheres = [
            position(0.9),
            position(0.1),
            position(0.5),
            position(0.1),
            position(0.0),
            position(1.0),
        ];
        assert_eq!(order(&spheres, |i| i == 2), [4, 1, 3, 0, 5, 2]);
    }

    #[test]
    fn a_tiny_cluster_beside_an_outlier_is_still_sorted() {
        let mut spheres: Vec<_> =
            (0..100u32).map(|i| [(i * 37 % 100) as f32, 0.0, 0.0, 1.0]).collect();
        spheres.push([1e6, 0.0, 0.0, 1.0]);
        let xs: Vec<_> =
            order(&spheres, |_| false).iter().map(|&i| spheres[i as usize][0]).collect();
        assert!(xs.is_sorted());
    }

    /// Checks the order of a grid's cells along the curve: their bits interleaved, x highest.
    fn along_the_curve(cells: u32, step: f32) {
        let position = |i: u32| [i % cells, i / cells % cells, i / cells / cells];
        let spheres: Vec<[f32; 4]> = (0..cells.pow(3))
            .map(|i| position(i).map(|c| c as f32 * step))
            .map(|[x, y, z]| [x, y, z, 1.0])
            .chain([[1.0, 1.0, 1.0, 1.0]])
            .collect();
        let code = |i: u32| {
            let bit = |c: u32, k: u32, axis: u32| u64::from(c >> k & 1) << (3 * k + 2 - axis);
            let [x, y, z] = position(i);
            (0..10).map(|k| bit(x, k, 0) | bit(y, k, 1) | bit(z, k, 2)).sum::<u64>()
        };
        let mut expected: Vec<u32> = (0..cells.pow(3)).collect();
        expected.sort_by_key(|&i| code(i));
        expected.push(cells.pow(3));
        assert_eq!(order(&spheres, |_| false), expected, "steps of {step}");
    }

    #[test]
    fn spheres_stand_along_the_curve_at_every_scale() {
        // The last sphere spans the box; the cells are larger than those of the coarse code, which
        // are 2^-10 wide, or far smaller.
        along_the_curve(8, 0.125);
        along_the_curve(16, 2f32.powi(-20));
    }

    #[test]
    fn one_in_a_thousand_may_lie_outside_of_the_box() {
        let position = |i: u32| [i as f32, 2.0 * i as f32, 0.0, 1.0];
        let MortonCurve { low, high } =
            MortonCurve::fit(&Listed(&(0..5000).map(position).collect::<Vec<_>>(), |_| false));
        assert_eq!(low.to_array(), [5.0, 10.0, 0.0]);
        assert_eq!(high.to_array(), [4994.0, 9988.0, 0.0]);
        let outliers = [-1e6, 1e6].map(|x| MortonCurve { low, high }.fine_code(&[x, x, x, 1.0]));
        assert_eq!(outliers, [0, (1 << 63) - 1]);
    }

    #[test]
    fn what_comes_last_keeps_the_order_of_its_indices() {
        let spheres = [0.5, 0.1, 0.9, 0.3].map(|x| [x, 0.0, 0.0, 1.0]);
        assert_eq!(order(&spheres, |i| i != 2), [2, 0, 1, 3]);
    }

    #[test]
    fn the_cells_divide_the_box_wherever_it_lies() {
        let low = Vec3::new(-3.0, 1.0, 10.0);
        let curve = MortonCurve { low, high: Vec3::new(-1.0, 2.0, 14.0) };
        let code = |x: f32, y: f32, z: f32| curve.fine_code(&[x, y, z, 1.0]);
        assert_eq!(code(-3.0, 1.0, 10.0), 0);
        // Halfway along an axis its highest bit is set, and at a quarter the next one.
        assert_eq!(code(-2.0, 1.0, 10.0), 1 << 62);
        assert_eq!(code(-3.0, 1.5, 10.0), 1 << 61);
        assert_eq!(code(-3.0, 1.0, 12.0), 1 << 60);
        assert_eq!(code(-2.5, 1.25, 11.0), 0b111 << 57);
    }
}
