//! The typical distance between neighbours.

use std::collections::HashMap;

use rayon::prelude::*;

use crate::math::DVec3;

/// Points whose nearest neighbour is searched.
const SAMPLES: usize = 4000;

/// The median distance from a point to its nearest other point, estimated from evenly spaced rows.
/// `None` for fewer than two points, or if most of them coincide.
///
/// All points are sorted into a grid with a few points per cell, of which only the cells around the
/// samples are kept, so memory is small and the time is that of one pass over the points.
pub fn median_spacing(count: usize, point: impl Fn(usize) -> DVec3 + Sync) -> Option<f64> {
    let samples: Vec<usize> = (0..count).step_by(count.div_ceil(SAMPLES).max(1)).collect();
    let grid = Grid::fitting(count, &point)?;
    let mut unresolved: Vec<(usize, f64)> =
        samples.iter().map(|row| (*row, f64::INFINITY)).collect();
    let mut found = Vec::new();
    let mut grid = grid;
    // Where points are sparse, the cells grow until a neighbour is within reach.
    for _ in 0..MAX_ROUNDS {
        unresolved = grid.search(count, &point, unresolved);
        let reach = grid.size;
        let (near, far) = unresolved.into_iter().partition(|(_, distance)| *distance <= reach);
        found.extend(Vec::into_iter(near).map(|(_, distance): (usize, f64)| distance));
        unresolved = far;
        // The median is known once more than half of the distances are.
        if 2 * found.len() > samples.len() {
            break;
        }
        grid.size *= 3.0;
    }
    found.extend(unresolved.into_iter().map(|(_, distance)| distance));
    let middle = found.len() / 2;
    let (_, median, _) = found.select_nth_unstable_by(middle, f64::total_cmp);
    (median.is_finite() && *median > 0.0).then_some(*median)
}

/// Each round makes the cells three times as wide.
const MAX_ROUNDS: usize = 40;

/// A grid of cubic cells.
struct Grid {
    low: DVec3,
    size: f64,
}

impl Grid {
    /// A grid whose cells hold about two points each, if the points fill their bounding box.
    fn fitting(count: usize, point: &(impl Fn(usize) -> DVec3 + Sync)) -> Option<Self> {
        let nothing = || (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let (low, high) = (0..count)
            .into_par_iter()
            .map(point)
            .filter(|p| p.is_finite())
            .fold(nothing, |(low, high), p| (low.min(p), high.max(p)))
            .reduce(nothing, |(a, b), (c, d)| (a.min(c), b.max(d)));
        let extent = (high - low).max_element();
        if !(count >= 2 && extent > 0.0 && extent.is_finite()) {
            return None;
        }
        let box_size = (high - low).max(DVec3::splat(extent * 1e-3));
        let size = libm::cbrt(2.0 * box_size.x * box_size.y * box_size.z / count as f64);
        Some(Self { low, size: size.max(extent * 1e-6) })
    }

    /// The cell of a point, none of whose coordinates is below the lowest.
    fn cell(&self, point: DVec3) -> [i32; 3] {
        ((point - self.low) / self.size).to_array().map(|x| x as i32)
    }

    /// Shortens the distance of each sample to that of the nearest point in its cell or a cell
    /// beside it.
    fn search(
        &self,
        count: usize,
        point: &(impl Fn(usize) -> DVec3 + Sync),
        samples: Vec<(usize, f64)>,
    ) -> Vec<(usize, f64)> {
        let mut around: HashMap<[i32; 3], Vec<u32>> = HashMap::new();
        let mut filter = Filter::default();
        for (index, (row, _)) in samples.iter().enumerate() {
            let [x, y, z] = self.cell(point(*row));
            for step in 0..27 {
                let cell = [x + step % 3 - 1, y + step / 3 % 3 - 1, z + step / 9 - 1];
                around.entry(cell).or_default().push(index as u32);
                filter.insert(cell);
            }
        }
        let nearest = || samples.iter().map(|(_, distance)| *distance).collect::<Vec<f64>>();
        let shorten = |mut distances: Vec<f64>, row: usize| {
            let other = point(row);
            let cell = self.cell(other);
            if !filter.may_have(cell) {
                return distances;
            }
            for index in around.get(&cell).into_iter().flatten() {
                let (sample, _) = samples[*index as usize];
                if sample != row {
                    let distance = point(sample).distance(other);
                    let known = &mut distances[*index as usize];
                    *known = known.min(distance);
                }
            }
            distances
        };
        let merge = |a: Vec<f64>, b: Vec<f64>| a.iter().zip(b).map(|(a, b)| a.min(b)).collect();
        let rows = (0..count).into_par_iter().with_min_len(1 << 16);
        let distances = rows.fold(nearest, shorten).reduce(nearest, merge);
        samples.iter().zip(distances).map(|((row, _), distance)| (*row, distance)).collect()
    }
}

/// A set of cells that may seem to have others, too. Most points are far from all samples, which is
/// found out by one look at a bit.
struct Filter(Vec<u64>);

impl Filter {
    /// About forty bits for each cell around a sample.
    const LOG_BITS: u32 = 22;

    fn bit([x, y, z]: [i32; 3]) -> (usize, u64) {
        let (x, y, z) = (i64::from(x) as u64, i64::from(y) as u64, i64::from(z) as u64);
        let mixed = x
            .wrapping_mul(0x9e37_79b9_7f4a_7c15)
            .wrapping_add(y)
            .wrapping_mul(0xbf58_476d_1ce4_e5b9)
            .wrapping_add(z)
            .wrapping_mul(0x94d0_49bb_1331_11eb);
        let bit = mixed >> (64 - Self::LOG_BITS);
        (bit as usize / 64, 1 << (bit % 64))
    }

    fn insert(&mut self, cell: [i32; 3]) {
        let (word, bit) = Self::bit(cell);
        self.0[word] |= bit;
    }

    fn may_have(&self, cell: [i32; 3]) -> bool {
        let (word, bit) = Self::bit(cell);
        self.0[word] & bit != 0
    }
}

impl Default for Filter {
    fn default() -> Self {
        Self(vec![0; 1 << (Self::LOG_BITS - 6)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lattice(side: usize, spacing: f64) -> Vec<DVec3> {
        let rows = 0..side * side * side;
        let at = |row: usize| [row % side, row / side % side, row / side / side];
        rows.map(|row| DVec3::from_array(at(row).map(|x| x as f64 * spacing))).collect()
    }

    fn spacing(points: &[DVec3]) -> Option<f64> {
        median_spacing(points.len(), |row| points[row])
    }

    #[test]
    fn a_lattice_has_its_constant() {
        for (side, constant) in [(2, 1.0), (10, 0.25), (40, 3e5)] {
            let found = spacing(&lattice(side, constant)).unwrap();
            assert!((found - constant).abs() < 1e-9 * constant, "{found}");
        }
    }

    #[test]
    fn it_is_the_median_of_all_pairs_searched_one_by_one() {
        // Clusters of very different density, and a far outlier.
        let mut state = 1u64;
        let mut random = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 40) as f64 / (1u64 << 24) as f64
        };
        let mut points: Vec<DVec3> = (0..1500)
            .map(|row| {
                DVec3::new(random(), random(), random()) * if row % 3 == 0 { 100.0 } else { 1.0 }
            })
            .collect();
        points.push(DVec3::splat(1e7));
        let nearest = |row: usize| {
            let others = (0..points.len()).filter(|other| *other != row);
            others.map(|other| points[row].distance(points[other])).fold(f64::INFINITY, f64::min)
        };
        let mut all: Vec<f64> = (0..points.len()).map(nearest).collect();
        all.sort_by(f64::total_cmp);
        assert_eq!(spacing(&points), Some(all[all.len() / 2]));
    }

    #[test]
    fn few_or_equal_points_have_none() {
        assert_eq!(spacing(&[]), None);
        assert_eq!(spacing(&[DVec3::ONE]), None);
        assert_eq!(spacing(&[DVec3::ONE; 10]), None);
        assert_eq!(spacing(&[DVec3::ZERO, DVec3::X * 2.0]), Some(2.0));
    }
}
