//! Every sampling routine against its own density: the table, and the test that each row is put to.
//!
//! A routine draws points from random numbers of a fixed seed; they are counted in cells, and the
//! counts are compared with the density integrated over each cell (Pearson's chi-square). A new
//! routine adds its row to the file of its area, in the same commit.

mod background;
mod camera;
mod geometry;
mod lights;
mod materials;
mod sampling;
mod sampling_test;

pub use sampling_test::SamplingTest;

use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};
use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::check;
use sampling_test::MAX_MIDPOINTS;

/// Cells expected to hold fewer points than this are pooled, as the chi-square distribution wants.
const MIN_EXPECTED: f64 = 5.0;
/// A density that adds up to one but for this share does so: what is integrated over cells with an edge
/// in them is off by no more.
const SUM_ERROR: f64 = 1e-3;
/// A cell is well enough integrated where the last step moved what is expected by at most this many of
/// its standard deviations: over all cells that adds less to the statistic than chance does.
const INTEGRATION_ERROR: f64 = 0.03;

/// What the test says of a pair.
#[derive(Clone, Debug)]
pub struct ChiSquareResult {
    /// The probability of counts at least as far from the density, were the pair right; 0 where
    /// they cannot be.
    pub p_value: f64,
    /// Pearson's statistic.
    pub statistic: f64,
    /// Its degrees of freedom.
    pub degrees_of_freedom: usize,
    /// What was counted.
    pub histogram: Histogram,
}

/// Points counted in cells, row by row, beside what the density lets expect.
#[derive(Clone, Debug)]
pub struct Histogram {
    /// Cells along the first coordinate (rows) and the second (columns).
    pub cells: [usize; 2],
    /// Points that each cell should hold.
    pub expected: Vec<f64>,
    /// Points that it holds.
    pub observed: Vec<u64>,
}

/// All pairs. Their names differ.
pub fn sampling_tests() -> Vec<SamplingTest> {
    let areas = [
        sampling::tests,
        geometry::tests,
        materials::tests,
        lights::tests,
        background::tests,
        camera::tests,
    ];
    areas.into_iter().flat_map(|pairs| pairs()).collect()
}

/// Draws this many points and compares them with the density. The random numbers are a function of
/// the pair's name and `index`. A million points see an error of one percent in a few cells.
pub fn chi_square_test(pair: &SamplingTest, points: u32, index: u64) -> ChiSquareResult {
    let histogram = Histogram {
        cells: pair.cells,
        expected: expected_counts(pair, points),
        observed: observed_counts(pair, points, index),
    };
    let (statistic, freedom) = pearson(&histogram, f64::from(points));
    let p_value = ChiSquared::new(freedom.max(1) as f64).map_or(0.0, |law| law.sf(statistic));
    ChiSquareResult { p_value, statistic, degrees_of_freedom: freedom, histogram }
}

/// The statistic, infinite where points lie where there is no density or the density adds up to
/// more than one; and the degrees of freedom.
fn pearson(histogram: &Histogram, points: f64) -> (f64, usize) {
    let Histogram { expected, observed, .. } = histogram;
    let total: f64 = expected.iter().sum();
    let inside: u64 = observed.iter().sum();
    // What the routine gave up on, or put outside, is one more cell.
    let lost = (points - total, points - inside as f64);
    if total.is_nan() || lost.0 < -SUM_ERROR * points {
        return (f64::INFINITY, 1);
    }
    let is_whole = lost.1 == 0.0 && lost.0 < SUM_ERROR * points;
    let lost = if is_whole { (0.0, 0.0) } else { lost };
    let cells = expected.iter().zip(observed).map(|(&e, &o)| (e, o as f64));
    let all = cells.chain([(lost.0.max(0.0), lost.1)]);
    let (small, mut large): (Vec<_>, Vec<_>) = all.partition(|cell| cell.0 < MIN_EXPECTED);
    let pooled = small.iter().fold((0.0, 0.0), |sum, cell| (sum.0 + cell.0, sum.1 + cell.1));
    if pooled.0 >= MIN_EXPECTED {
        large.push(pooled);
    } else if pooled.1 > pooled.0 + 30.0 {
        return (f64::INFINITY, 1);
    }
    let statistic = large.iter().map(|(e, o)| (o - e) * (o - e) / e).sum();
    (statistic, large.len().saturating_sub(1))
}

fn observed_counts(pair: &SamplingTest, points: u32, index: u64) -> Vec<u64> {
    let mut rng = StdRng::seed_from_u64(check::seed(&pair.name, index));
    let mut counts = vec![0; pair.cells[0] * pair.cells[1]];
    for _ in 0..points {
        let u = std::array::from_fn(|_| rng.random());
        let cell = (pair.sample)(u).and_then(|at| cell_of(pair, at));
        if let Some([row, column]) = cell {
            counts[row * pair.cells[1] + column] += 1;
        }
    }
    counts
}

fn cell_of(pair: &SamplingTest, at: [f64; 2]) -> Option<[usize; 2]> {
    let along = |axis: usize| {
        let place = (at[axis] - pair.low[axis]) / (pair.high[axis] - pair.low[axis]);
        let cells = pair.cells[axis];
        (0.0..=1.0).contains(&place).then(|| ((place * cells as f64) as usize).min(cells - 1))
    };
    Some([along(0)?, along(1)?])
}

fn expected_counts(pair: &SamplingTest, points: u32) -> Vec<f64> {
    let [rows, columns] = pair.cells;
    let cells = (0..rows).flat_map(|row| (0..columns).map(move |column| [row, column]));
    cells.map(|cell| expected_in_cell(pair, cell, f64::from(points))).collect()
}

/// Points expected in one cell.
fn expected_in_cell(pair: &SamplingTest, cell: [usize; 2], points: f64) -> f64 {
    let mut side = pair.min_midpoints;
    let mut coarse = points * integrate_midpoint(pair, cell, side);
    loop {
        side *= 2;
        let fine = points * integrate_midpoint(pair, cell, side);
        let moved = (fine - coarse).abs();
        if side == MAX_MIDPOINTS || moved <= INTEGRATION_ERROR * fine.max(1.0).sqrt() {
            return fine;
        }
        coarse = fine;
    }
}

/// The density integrated over a cell by the midpoint rule, `side` points along each side.
fn integrate_midpoint(pair: &SamplingTest, cell: [usize; 2], side: usize) -> f64 {
    let step: [f64; 2] = std::array::from_fn(|axis| {
        (pair.high[axis] - pair.low[axis]) / (pair.cells[axis] * side) as f64
    });
    let at = |axis: usize, i: usize| {
        pair.low[axis] + ((cell[axis] * side + i) as f64 + 0.5) * step[axis]
    };
    let column = |i| (0..side).map(|j| (pair.pdf)([at(0, i), at(1, j)])).sum::<f64>();
    (0..side).map(column).sum::<f64>() * step[0] * step[1]
}
