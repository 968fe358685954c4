//! Positions and radii of the spheres.

use std::f64::consts::PI;

use crate::math::DVec3;

use super::arrangement::Arrangement;
use super::rng::{self, IndexedRng};

/// Mean number of gas spheres hit by a ray across the box.
const GAS_MEAN_HITS: f64 = 8.0;
/// Maximum mean radius of the gas.
const MAX_GAS_RADIUS: f64 = 0.2;
/// Fraction of the volume filled by packed spheres.
const PACKING_FRACTION: f64 = 0.5;
/// Relative variation of packed radii. The largest sphere then just fits its lattice site.
const PACKED_RADIUS_SPREAD: f64 = 0.125;
const CLUSTERS: u64 = 400;
/// Range of the clusters' standard deviations.
const CLUSTER_SIGMA_RANGE: [f64; 2] = [0.006, 0.1];
/// N pi r^2 of the spheres in clusters, with the mean of r^2.
const CLUSTER_CROSS_SECTION: f64 = 4.0;
/// Ratio of the largest to the smallest radius in clusters.
const CLUSTER_RADIUS_RATIO: f64 = 100.0;
/// Maximum radius in clusters; applies to small numbers of spheres.
const MAX_CLUSTER_RADIUS: f64 = 0.1;
/// Lattice radius relative to the distance between neighbors.
const LATTICE_RADIUS: f64 = 0.4;

/// A sphere with its position.
pub(super) struct PlacedSphere {
    pub(super) center: DVec3,
    pub(super) radius: f64,
    /// A number in `[0, 1)`, equal for all spheres of a cluster.
    pub(super) hue: f64,
}

/// The shared parameters of an arrangement.
#[derive(Clone, Debug)]
pub(super) enum Placement {
    Gas { radius: f64 },
    Packed { grid: Grid, radius: f64 },
    Clusters { clusters: Vec<Cluster>, largest: f64 },
    Lattice { grid: Grid },
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Cluster {
    center: DVec3,
    sigma: f64,
    hue: f64,
}

/// A grid of cubic cells around the origin, with x varying fastest and z slowest and from the
/// front. The last layer, which may not be full, is then at the back.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid {
    cell: f64,
    counts: [u64; 3],
}

impl Placement {
    pub(super) fn new(arrangement: Arrangement, count: u64, seed: u64) -> Self {
        let n = count as f64;
        match arrangement {
            Arrangement::Gas => {
                Self::Gas { radius: (GAS_MEAN_HITS / (PI * n)).sqrt().min(MAX_GAS_RADIUS) }
            }
            Arrangement::Packed => {
                let variance = 1.0 + PACKED_RADIUS_SPREAD * PACKED_RADIUS_SPREAD;
                let radius = libm::cbrt(PACKING_FRACTION / variance * 3.0 / (4.0 * PI * n));
                Self::Packed { grid: Grid::new(count.div_ceil(4), 4.0 / n), radius }
            }
            Arrangement::Clusters => {
                // For uniform ln r in [ln a, ln b], the mean of r^2 is (b^2 - a^2) / (2 ln(b / a)).
                let mean =
                    (1.0 - CLUSTER_RADIUS_RATIO.powi(-2)) / (2.0 * libm::log(CLUSTER_RADIUS_RATIO));
                let largest =
                    (CLUSTER_CROSS_SECTION / (PI * n * mean)).sqrt().min(MAX_CLUSTER_RADIUS);
                let clusters = (0..CLUSTERS).map(|cluster| Cluster::new(seed, cluster)).collect();
                Self::Clusters { clusters, largest }
            }
            Arrangement::Lattice => Self::Lattice { grid: Grid::new(count, 1.0 / n) },
        }
    }

    pub(super) fn sphere_at(&self, index: u64, numbers: &mut IndexedRng) -> PlacedSphere {
        match self {
            Self::Gas { radius } => {
                let center = numbers.in_cube();
                PlacedSphere { center, radius: radius * numbers.uniform_in(0.75, 1.25), hue: 0.0 }
            }
            Self::Packed { grid, radius } => packed(grid, *radius, index, numbers),
            Self::Clusters { clusters, largest } => {
                let which = numbers.index_below(clusters.len());
                let Cluster { center: middle, sigma: size, hue: kind } = clusters[which];
                let center = middle + size * numbers.normal();
                let radius = numbers.log_uniform_in(largest / CLUSTER_RADIUS_RATIO, *largest);
                PlacedSphere { center, radius, hue: kind }
            }
            Self::Lattice { grid } => {
                let center = grid.corner_of(index) + DVec3::splat(0.5 * grid.cell);
                PlacedSphere { center, radius: LATTICE_RADIUS * grid.cell, hue: 0.0 }
            }
        }
    }
}

/// Each sphere stays within its own ball of a lattice of touching balls.
fn packed(grid: &Grid, radius: f64, index: u64, numbers: &mut IndexedRng) -> PlacedSphere {
    const SITES: [[f64; 3]; 4] =
        [[0.25; 3], [0.25, 0.75, 0.75], [0.75, 0.25, 0.75], [0.75, 0.75, 0.25]];
    let site = grid.corner_of(index / 4) + grid.cell * DVec3::from_array(SITES[index as usize % 4]);
    let radius =
        radius * numbers.uniform_in(1.0 - PACKED_RADIUS_SPREAD, 1.0 + PACKED_RADIUS_SPREAD);
    // Slightly less than what fits, so that spheres do not touch after rounding to f32.
    let room = grid.cell / 8f64.sqrt() * (1.0 - 1e-4) - radius;
    PlacedSphere { center: site + room * numbers.in_ball(), radius, hue: 0.0 }
}

impl Cluster {
    fn new(seed: u64, cluster: u64) -> Self {
        let mut numbers = rng::for_cluster(seed, cluster);
        let [small, large] = CLUSTER_SIGMA_RANGE;
        let size = numbers.log_uniform_in(small, large);
        // Keeps wide clusters roughly inside the box.
        let middle = (1.0 - 3.0 * size) * numbers.in_cube();
        Self { center: middle, sigma: size, hue: numbers.uniform() }
    }
}

impl Grid {
    /// A nearly cubic grid of at least `cells` cells of this volume.
    fn new(cells: u64, volume: f64) -> Self {
        let side = (libm::cbrt(cells as f64).round() as u64).max(1);
        Self { cell: libm::cbrt(volume), counts: [side, side, cells.div_ceil(side * side)] }
    }

    /// The lowest corner of a cell.
    fn corner_of(&self, cell: u64) -> DVec3 {
        let [nx, ny, nz] = self.counts;
        let place = [cell % nx, cell / nx % ny, nz - 1 - cell / nx / ny].map(|i| i as f64);
        let half = DVec3::from_array([nx, ny, nz].map(|n| n as f64 / 2.0));
        self.cell * (DVec3::from_array(place) - half)
    }
}
