//! An environment map: interpolated radiance over all directions, with exact importance sampling.
//!
//! Nodes form a grid: each row has a height (the sine of its elevation), each column an azimuth.
//! Between four nodes radiance is linear in height and azimuth, the coordinates in which solid
//! angle is uniform. The weight of a cell is therefore the mean of its corners times its solid
//! angle, directions are sampled by inverting two linear densities, and the resulting pdf is
//! exactly proportional to the sampling function.
//!
//! That function is not luminance itself but its excess above the mean: BSDF sampling, with which
//! it is combined, handles the constant part best (Karlik, Sik, Vevoda, Skrivan and Krivanek 2019,
//! "MIS Compensation: Optimizing Sampling Techniques in Multiple Importance Sampling"). Every
//! direction keeps a tenth of its luminance, so that light sampling covers all light.

use std::f64::consts::{PI, TAU};

use rayon::prelude::*;

use crate::color::{Rgb, luminance};
use crate::math::DVec3;
use crate::sampling::{DiscreteDistribution, atan2, cos, sin_cos_2pi};

/// Minimum sampling weight of a node, as a fraction of its luminance.
const MIN_WEIGHT_FRACTION: f64 = 0.1;

/// Radiance over the sphere of directions, y up.
#[derive(Clone, Debug)]
pub struct EnvironmentMap {
    columns: usize,
    /// Height of each row of nodes, decreasing from 1 to -1. Two rows may share a height: a sharp
    /// edge.
    heights: Vec<f64>,
    radiance: Vec<Rgb>,
    mean_luminance: f64,
    /// Distribution over the bands between rows.
    band_distribution: Option<DiscreteDistribution>,
    /// Distribution over the cells of each band, for bands that emit light.
    cell_distributions: Vec<Option<DiscreteDistribution>>,
    /// Integral of the sampling function over all directions.
    total_weight: f64,
}

/// A direction of a map, with its radiance and the pdf of sampling it per solid angle.
#[derive(Clone, Copy, Debug)]
pub struct MapSample {
    /// Unit direction.
    pub direction: DVec3,
    /// Radiance from there.
    pub radiance: Rgb,
    /// The pdf, as [`EnvironmentMap::pdf`] returns it.
    pub pdf: f64,
}

/// A direction's position in the grid.
struct GridPosition {
    band: usize,
    column: usize,
    /// Fraction from the column to the next.
    across: f64,
    /// Fraction from the upper row to the lower.
    down: f64,
}

impl EnvironmentMap {
    /// Creates a map of constant radiance.
    pub fn constant(radiance: Rgb) -> Self {
        Self::from_rows(1, vec![1.0, -1.0], vec![radiance; 2])
    }

    /// Creates a gradient that is linear in the height: from zenith to horizon to nadir.
    pub fn gradient(zenith: Rgb, horizon: Rgb, nadir: Rgb) -> Self {
        Self::from_rows(1, vec![1.0, 0.0, -1.0], vec![zenith, horizon, nadir])
    }

    /// Creates a map from an image in latitude and longitude, rows from the top. The image's centre
    /// faces -z, its right side +x.
    ///
    /// Pixels are areas: the interpolated light of each is its radiance times its exact solid
    /// angle. A node's light is the mean distance to the heights above and below, so the middles
    /// between the heights must be the edges between the rows, `cos(k d)` for rows of `d` radians.
    /// The cosine of the row's centre divided by `cos(d / 2)` is that, by the theorem for the sum
    /// of two cosines. The first and the last row reach the poles.
    ///
    /// # Panics
    /// Unless there are `width` times `height` pixels, and at least one.
    pub fn from_image(width: usize, height: usize, pixels: &[Rgb]) -> Self {
        assert!(width > 0 && height > 0 && pixels.len() == width * height);
        if height == 1 {
            return Self::from_rows(width, vec![1.0, -1.0], pixels.repeat(2));
        }
        let half = 0.5 * PI / height as f64;
        let node = |row: usize| cos((2 * row + 1) as f64 * half) / cos(half);
        let mut heights: Vec<f64> = (0..height).map(node).collect();
        (heights[0], heights[height - 1]) = (1.0, -1.0);
        Self::from_rows(width, heights, pixels.to_vec())
    }

    /// Creates a map from rows of nodes, whose first column lies half a column to the right of +z.
    pub(super) fn from_rows(columns: usize, heights: Vec<f64>, radiance: Vec<Rgb>) -> Self {
        let bands = heights.len() - 1;
        let empty = vec![None; bands];
        let mut map = Self {
            columns,
            heights,
            radiance,
            mean_luminance: 0.0,
            band_distribution: None,
            cell_distributions: empty,
            total_weight: 0.0,
        };
        let total: f64 = (0..bands).map(|band| map.band_weights(band).iter().sum::<f64>()).sum();
        if !map.is_constant() {
            map.mean_luminance = total / (2.0 * TAU);
            let cell_weights: Vec<Vec<f64>> =
                (0..bands).into_par_iter().map(|band| map.band_weights(band)).collect();
            let band_weights: Vec<f64> =
                cell_weights.iter().map(|cells| cells.iter().sum()).collect();
            map.total_weight = band_weights.iter().sum();
            map.band_distribution = DiscreteDistribution::new(band_weights);
            map.cell_distributions =
                cell_weights.into_par_iter().map(DiscreteDistribution::new).collect();
        }
        map
    }

    /// Returns true if the radiance is constant, so that light sampling does not apply.
    pub fn is_constant(&self) -> bool {
        self.radiance.iter().all(|radiance| *radiance == self.radiance[0])
    }

    /// Returns the maximum radiance in any channel.
    pub(super) fn max_radiance(&self) -> f32 {
        self.radiance.iter().map(|radiance| radiance.max_element()).fold(0.0, f32::max)
    }

    /// Returns the radiance from a unit direction.
    pub fn radiance(&self, direction: DVec3) -> Rgb {
        self.radiance_at(&self.locate(direction))
    }

    /// Returns the radiance from a unit direction, and the pdf of [`Self::sample`] per solid angle.
    pub fn radiance_and_pdf(&self, direction: DVec3) -> (Rgb, f64) {
        let position = self.locate(direction);
        (self.radiance_at(&position), self.pdf_at(&position))
    }

    fn radiance_at(&self, position: &GridPosition) -> Rgb {
        let mut sum = DVec3::ZERO;
        for (node, weight) in self.bilinear_weights(position) {
            sum += self.radiance[node].as_dvec3() * weight;
        }
        sum.as_vec3()
    }

    /// Samples a direction, from `u` in `[0, 1)^2`; `None` for a constant map.
    pub fn sample(&self, u: [f64; 2]) -> Option<MapSample> {
        let bands = self.band_distribution.as_ref()?;
        let band = bands.sample(u[0]);
        let cells = self.cell_distributions[band].as_ref()?;
        let column = cells.sample(u[1]);
        let [a, b, c, d] = self.corner_nodes(band, column).map(|node| self.sampling_weight(node));
        let down = sample_linear(a + b, c + d, bands.remap(band, u[0]));
        let [left, right] = [a + (c - a) * down, b + (d - b) * down];
        let across = sample_linear(left, right, cells.remap(column, u[1]));
        let height = self.heights[band] - down * (self.heights[band] - self.heights[band + 1]);
        let (sin, cos) = sin_cos_2pi((column as f64 + 0.5 + across) / self.columns as f64);
        let sin_theta = ((1.0 - height) * (1.0 + height)).max(0.0).sqrt();
        let position = GridPosition { band, column, across, down };
        Some(MapSample {
            direction: DVec3::new(-sin_theta * sin, height, sin_theta * cos),
            radiance: self.radiance_at(&position),
            pdf: self.pdf_at(&position),
        })
    }

    /// Returns the pdf of [`Self::sample`] per solid angle.
    pub fn pdf(&self, direction: DVec3) -> f64 {
        if self.band_distribution.is_none() {
            return 0.0;
        }
        self.pdf_at(&self.locate(direction))
    }

    fn pdf_at(&self, position: &GridPosition) -> f64 {
        if self.band_distribution.is_none() {
            return 0.0;
        }
        let weight: f64 = self
            .bilinear_weights(position)
            .map(|(node, weight)| self.sampling_weight(node) * weight)
            .into_iter()
            .sum();
        weight / self.total_weight
    }

    /// Returns the integral of the sampling function over all directions, in W/m^2 of luminance; 0
    /// for a constant map, which is left to BSDF sampling.
    pub(super) fn total_weight(&self) -> f64 {
        self.total_weight
    }

    /// Returns the sampling weight of a node.
    fn sampling_weight(&self, node: usize) -> f64 {
        let luminance = f64::from(luminance(self.radiance[node]));
        (luminance - self.mean_luminance).max(MIN_WEIGHT_FRACTION * luminance)
    }

    /// Returns the sampling weight of every cell between two rows.
    fn band_weights(&self, band: usize) -> Vec<f64> {
        let height = self.heights[band] - self.heights[band + 1];
        let solid_angle = TAU / self.columns as f64 * height;
        let cell_weights = |column| {
            let corners = self.corner_nodes(band, column).map(|node| self.sampling_weight(node));
            0.25 * solid_angle * corners.iter().sum::<f64>()
        };
        (0..self.columns).map(cell_weights).collect()
    }

    fn locate(&self, direction: DVec3) -> GridPosition {
        let height = direction.y;
        let below = self.heights.partition_point(|&row| row > height);
        let band = below.clamp(1, self.heights.len() - 1) - 1;
        let [above, below] = [self.heights[band], self.heights[band + 1]];
        let down = ((above - height) / (above - below)).clamp(0.0, 1.0);
        if self.columns == 1 {
            return GridPosition { band, column: 0, across: 0.0, down };
        }
        // Azimuth from +z (behind the viewer, at the image's left edge) towards -x.
        let turns = atan2(-direction.x, direction.z) / TAU;
        let x = (turns - turns.floor()) * self.columns as f64 - 0.5;
        let column = x.floor();
        let across = x - column;
        let column = (column + self.columns as f64) as usize % self.columns;
        GridPosition { band, column, across, down }
    }

    /// Returns the four nodes around a grid position with their bilinear weights.
    fn bilinear_weights(&self, position: &GridPosition) -> [(usize, f64); 4] {
        let GridPosition { band, column, across, down } = *position;
        let [a, b, c, d] = self.corner_nodes(band, column);
        let (up, back) = (1.0 - down, 1.0 - across);
        [(a, up * back), (b, up * across), (c, down * back), (d, down * across)]
    }

    /// Returns the nodes at the upper left, upper right, lower left and lower right.
    fn corner_nodes(&self, band: usize, column: usize) -> [usize; 4] {
        let next = (column + 1) % self.columns;
        let row = band * self.columns;
        [row + column, row + next, row + self.columns + column, row + self.columns + next]
    }
}

/// Samples a number in `[0, 1]` with a density that is linear from `a` to `b`.
fn sample_linear(a: f64, b: f64, u: f64) -> f64 {
    if a + b <= 0.0 {
        return u;
    }
    // The root of the cumulative distribution, written to avoid cancellation where a is close to b.
    let t = u * (a + b) / (a + (a * a + u * (b * b - a * a)).max(0.0).sqrt());
    t.clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::sin_cos;

    /// Integral over all directions by the midpoint rule, in W/m^2: exact up to the kinks at nodes.
    fn integral(map: &EnvironmentMap, columns: usize) -> f64 {
        let (rows, columns) = (4000, 8 * columns);
        let mut sum = 0.0;
        for row in 0..rows {
            let height = 1.0 - (row as f64 + 0.5) / rows as f64 * 2.0;
            let flat = ((1.0 - height) * (1.0 + height)).sqrt();
            for column in 0..columns {
                let (sin, cos) = sin_cos((column as f64 + 0.5) / columns as f64 * TAU);
                sum += f64::from(map.radiance(DVec3::new(flat * sin, height, flat * cos)).y);
            }
        }
        sum * 2.0 * TAU / (rows * columns) as f64
    }

    /// One bright pixel, in any row, holds its radiance times its solid angle, whether it is looked
    /// up or sampled.
    #[test]
    fn pixels_are_areas() {
        for (width, height) in [(2, 1), (4, 2), (6, 3), (16, 8)] {
            for row in 0..height {
                let mut pixels = vec![Rgb::ZERO; width * height];
                pixels[row * width + 1] = Rgb::splat(100.0);
                let map = EnvironmentMap::from_image(width, height, &pixels);
                let edge = |k: usize| cos(k as f64 / height as f64 * PI);
                let solid_angle = TAU / width as f64 * (edge(row) - edge(row + 1));
                let expected = 100.0 * solid_angle;
                let found = integral(&map, width);
                assert!((found / expected - 1.0).abs() < 1e-4, "row {row} of {height}: {found}");
                let mean = map.mean_luminance * 2.0 * TAU;
                assert!((mean / expected - 1.0).abs() < 1e-6, "row {row} of {height}: {mean}");
            }
        }
    }
}
