//! Chi-square test of every sampling routine against its own pdf: the table, and the test applied
//! to each row.
//!
//! A routine draws points from random numbers of a fixed seed. The points are counted in cells, and
//! the counts are compared with the pdf integrated over each cell (Pearson's chi-square). A new
//! routine adds its row to the file of its area, in the same commit.

mod background;
mod camera;
mod geometry;
mod lights;
mod materials;
mod sampling;
mod sampling_test;
mod specular;

pub use sampling_test::SamplingTest;

use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};
use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::check;
use sampling_test::MAX_MIDPOINTS;

/// Minimum expected count of a cell. Smaller cells are pooled, as the chi-square distribution
/// requires.
const MIN_EXPECTED: f64 = 5.0;
/// Tolerance for the pdf's integral being 1. The error of integrating over cells with
/// discontinuities is no larger.
const SUM_ERROR: f64 = 1e-3;
/// A cell's integral has converged if the last refinement moved the expected count by at most this
/// many of its standard deviations. Over all cells, that adds less to the statistic than chance
/// does.
const INTEGRATION_ERROR: f64 = 0.03;

/// Result of a chi-square test.
#[derive(Clone, Debug)]
pub struct ChiSquareResult {
    /// Probability of counts at least this far from the pdf if sampling and pdf agree; 0 if such
    /// counts are impossible.
    pub p_value: f64,
    /// Pearson's chi-square statistic.
    pub statistic: f64,
    /// Degrees of freedom of the statistic.
    pub degrees_of_freedom: usize,
    /// Observed and expected counts.
    pub histogram: Histogram,
}

/// Observed and expected counts per cell, in row-major order.
#[derive(Clone, Debug)]
pub struct Histogram {
    /// Number of cells along the first coordinate (rows) and the second (columns).
    pub cells: [usize; 2],
    /// Expected number of points in each cell.
    pub expected: Vec<f64>,
    /// Observed number of points in each cell.
    pub observed: Vec<u64>,
}

/// All sampling tests. Their names are unique.
pub fn sampling_tests() -> Vec<SamplingTest> {
    let areas = [
        sampling::tests,
        geometry::tests,
        materials::tests,
        lights::tests,
        specular::tests,
        background::tests,
        camera::tests,
    ];
    areas.into_iter().flat_map(|tests| tests()).collect()
}

/// Draws `points` points and compares them with the pdf. Random numbers depend only on the test's
/// name and `index`. A million points detect an error of one percent in a few cells.
pub fn chi_square_test(test: &SamplingTest, points: u32, index: u64) -> ChiSquareResult {
    let histogram = Histogram {
        cells: test.cells,
        expected: expected_counts(test, points),
        observed: observed_counts(test, points, index),
    };
    let (statistic, degrees_of_freedom) = pearson(&histogram, f64::from(points));
    let p_value = ChiSquared::new(degrees_of_freedom.max(1) as f64)
        .map_or(0.0, |distribution| distribution.sf(statistic));
    ChiSquareResult { p_value, statistic, degrees_of_freedom, histogram }
}

/// Returns the statistic and the degrees of freedom. The statistic is infinite if points lie where
/// the pdf is zero, or if the pdf integrates to more than one.
fn pearson(histogram: &Histogram, points: f64) -> (f64, usize) {
    let Histogram { expected, observed, .. } = histogram;
    let total: f64 = expected.iter().sum();
    let accepted: u64 = observed.iter().sum();
    // Samples that the routine rejected or put outside form one more cell.
    let rejected = (points - total, points - accepted as f64);
    if total.is_nan() || rejected.0 < -SUM_ERROR * points {
        return (f64::INFINITY, 1);
    }
    let is_complete = rejected.1 == 0.0 && rejected.0 < SUM_ERROR * points;
    let rejected = if is_complete { (0.0, 0.0) } else { rejected };
    let cells = expected.iter().zip(observed).map(|(&e, &o)| (e, o as f64));
    let with_rejected = cells.chain([(rejected.0.max(0.0), rejected.1)]);
    let (small, mut large): (Vec<_>, Vec<_>) =
        with_rejected.partition(|cell| cell.0 < MIN_EXPECTED);
    let pooled = small.iter().fold((0.0, 0.0), |sum, cell| (sum.0 + cell.0, sum.1 + cell.1));
    if pooled.0 >= MIN_EXPECTED {
        large.push(pooled);
    } else if pooled.1 > pooled.0 + 30.0 {
        return (f64::INFINITY, 1);
    }
    let statistic = large.iter().map(|(e, o)| (o - e) * (o - e) / e).sum();
    (statistic, large.len().saturating_sub(1))
}

fn observed_counts(test: &SamplingTest, points: u32, index: u64) -> Vec<u64> {
    let mut rng = StdRng::seed_from_u64(check::seed(&test.name, index));
    let mut counts = vec![0; test.cells[0] * test.cells[1]];
    for _ in 0..points {
        let u = std::array::from_fn(|_| rng.random());
        let cell = (test.sample)(u).and_then(|point| cell_of(test, point));
        if let Some([row, column]) = cell {
            counts[row * test.cells[1] + column] += 1;
        }
    }
    counts
}

fn cell_of(test: &SamplingTest, point: [f64; 2]) -> Option<[usize; 2]> {
    let cell_index = |axis: usize| {
        let position = (point[axis] - test.low[axis]) / (test.high[axis] - test.low[axis]);
        let cells = test.cells[axis];
        (0.0..=1.0).contains(&position).then(|| ((position * cells as f64) as usize).min(cells - 1))
    };
    Some([cell_index(0)?, cell_index(1)?])
}

fn expected_counts(test: &SamplingTest, points: u32) -> Vec<f64> {
    let [rows, columns] = test.cells;
    let cells = (0..rows).flat_map(|row| (0..columns).map(move |column| [row, column]));
    cells.map(|cell| expected_in_cell(test, cell, f64::from(points))).collect()
}

/// Expected number of points in one cell.
fn expected_in_cell(test: &SamplingTest, cell: [usize; 2], points: f64) -> f64 {
    let mut side = test.min_midpoints;
    let mut coarse = points * integrate_midpoint(test, cell, side);
    loop {
        side *= 2;
        let fine = points * integrate_midpoint(test, cell, side);
        let change = (fine - coarse).abs();
        if side == MAX_MIDPOINTS || change <= INTEGRATION_ERROR * fine.max(1.0).sqrt() {
            return fine;
        }
        coarse = fine;
    }
}

/// Integrates the pdf over a cell by the midpoint rule, with `side` points along each side.
fn integrate_midpoint(test: &SamplingTest, cell: [usize; 2], side: usize) -> f64 {
    let step: [f64; 2] = std::array::from_fn(|axis| {
        (test.high[axis] - test.low[axis]) / (test.cells[axis] * side) as f64
    });
    let point = |axis: usize, i: usize| {
        test.low[axis] + ((cell[axis] * side + i) as f64 + 0.5) * step[axis]
    };
    let column = |i| (0..side).map(|j| (test.pdf)([point(0, i), point(1, j)])).sum::<f64>();
    (0..side).map(column).sum::<f64>() * step[0] * step[1]
}
