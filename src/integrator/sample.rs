//! Sample addresses and render counters.

use crate::geometry::PathRays;
use crate::math::{Isa, Ray};

/// The address of one sample of one pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SampleAddress {
    /// Column in the full picture.
    pub x: u32,
    /// Row in the full picture, from the top.
    pub y: u32,
    /// Index of the sample.
    pub sample: u32,
}

/// Counters collected while rendering.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RenderStats {
    /// Rays traced, shadow rays included.
    pub rays: u64,
    /// Paths cut off at the hard path length limit.
    pub truncated_paths: u64,
    /// Connections tried over polished balls.
    pub connections: u64,
}

impl RenderStats {
    /// Counts the rays of a query. Rays that are invalid or have an empty interval are not traced
    /// and do not count.
    pub(super) fn count_rays(&mut self, rays: &[Ray]) {
        let is_traced = |ray: &&Ray| ray.is_valid() && ray.t_min < ray.t_max;
        self.rays += rays.iter().filter(is_traced).count() as u64;
    }

    /// Counts the rays of a path stage; invalid or empty rays do not count.
    pub(super) fn count_path_rays(&mut self, rays: &PathRays, isa: Isa) {
        self.rays += rays.count_traced(isa) as u64;
    }
}

impl std::ops::Add for RenderStats {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            rays: self.rays + other.rays,
            truncated_paths: self.truncated_paths + other.truncated_paths,
            connections: self.connections + other.connections,
        }
    }
}
