//! A row of the table: a sampling routine, its pdf, and their common domain.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use crate::math::DVec3;
use crate::sampling::{atan2, sin_cos};

/// Number of cells along each coordinate.
const CELLS: [usize; 2] = [41, 61];
/// Midpoints along a cell's side in the first integration step. Each step doubles them.
const MIN_MIDPOINTS: usize = 4;
/// Largest number of midpoints along a cell's side.
pub(super) const MAX_MIDPOINTS: usize = 64;

type Sample = Box<dyn Fn([f64; 4]) -> Option<[f64; 2]> + Send + Sync>;
type Density = Box<dyn Fn([f64; 2]) -> f64 + Send + Sync>;

/// A sampling routine and its pdf over a rectangle in two coordinates.
///
/// Routines take four random numbers in `[0, 1)`, use as many as they need, and may return nothing.
/// The fraction of samples rejected must equal one minus the integral of the pdf.
pub struct SamplingTest {
    /// Unique name of what is sampled.
    pub name: String,
    /// Draws a point from four random numbers.
    pub(super) sample: Sample,
    /// Pdf over the coordinates, including the Jacobian.
    pub(super) pdf: Density,
    pub(super) low: [f64; 2],
    pub(super) high: [f64; 2],
    pub(super) cells: [usize; 2],
    /// Midpoints along a cell's side in the first integration step.
    pub(super) min_midpoints: usize,
}

impl SamplingTest {
    /// Test over a planar rectangle, with the pdf per unit area.
    pub fn over_rectangle(
        name: impl Into<String>,
        [low, high]: [[f64; 2]; 2],
        sample: impl Fn([f64; 4]) -> Option<[f64; 2]> + Send + Sync + 'static,
        pdf: impl Fn([f64; 2]) -> f64 + Send + Sync + 'static,
    ) -> Self {
        let (sample, density) = (Box::new(sample), Box::new(pdf));
        let (cells, min_midpoints) = (CELLS, MIN_MIDPOINTS);
        Self { name: name.into(), sample, pdf: density, low, high, cells, min_midpoints }
    }

    /// Integrates every cell with the maximum number of midpoints. For pdfs with jumps inside
    /// cells, where coarse steps may agree by chance.
    #[must_use]
    pub fn with_discontinuities(self) -> Self {
        Self { min_midpoints: MAX_MIDPOINTS / 2, ..self }
    }

    /// Test over unit directions at most `max_theta` radians from +z, with the pdf per unit solid
    /// angle. Cells are in polar angle and azimuth.
    pub fn over_cap(
        name: impl Into<String>,
        max_theta: f64,
        sample: impl Fn([f64; 4]) -> Option<DVec3> + Send + Sync + 'static,
        pdf: impl Fn(DVec3) -> f64 + Send + Sync + 'static,
    ) -> Self {
        let density = move |[theta, phi]: [f64; 2]| {
            let ((sin, cos), (sin_phi, cos_phi)) = (sin_cos(theta), sin_cos(phi));
            pdf(DVec3::new(sin * cos_phi, sin * sin_phi, cos)) * sin
        };
        let range = [[0.0, 0.0], [max_theta, TAU]];
        Self::over_rectangle(name, range, move |u| sample(u).map(polar), density)
    }

    /// Test over the hemisphere around +z, with the pdf per unit solid angle.
    pub fn over_hemisphere(
        name: impl Into<String>,
        sample: impl Fn([f64; 4]) -> Option<DVec3> + Send + Sync + 'static,
        pdf: impl Fn(DVec3) -> f64 + Send + Sync + 'static,
    ) -> Self {
        Self::over_cap(name, FRAC_PI_2, sample, pdf)
    }

    /// Test over all directions, with the pdf per unit solid angle.
    pub fn over_sphere(
        name: impl Into<String>,
        sample: impl Fn([f64; 4]) -> Option<DVec3> + Send + Sync + 'static,
        pdf: impl Fn(DVec3) -> f64 + Send + Sync + 'static,
    ) -> Self {
        Self::over_cap(name, PI, sample, pdf)
    }

    /// Test over indices, with one probability for each.
    pub fn over_indices(
        name: impl Into<String>,
        probabilities: Vec<f64>,
        sample: impl Fn([f64; 4]) -> Option<usize> + Send + Sync + 'static,
    ) -> Self {
        let count = probabilities.len();
        let sample_center = move |u| Some([sample(u)? as f64 + 0.5, 0.5]);
        let range = [[0.0, 0.0], [count as f64, 1.0]];
        let pmf = move |[x, _]: [f64; 2]| probabilities[(x as usize).min(count - 1)];
        Self { cells: [count, 1], ..Self::over_rectangle(name, range, sample_center, pmf) }
    }
}

/// Polar angle, accurate near both poles, and azimuth in `[0, 2 pi)`.
pub(super) fn polar(w: DVec3) -> [f64; 2] {
    let theta = atan2((w.x * w.x + w.y * w.y).sqrt(), w.z);
    [theta, atan2(w.y, w.x).rem_euclid(TAU)]
}
