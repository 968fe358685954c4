//! The bounding volume hierarchy in Rust: eight boxes per node, eight spheres per leaf, sixteen
//! rays at a time.
//!
//! Boxes and the spheres in leaves are f32 and only select candidates, with bounded error. The
//! final hit test is done in f64 by [`crate::geometry::Sphere::first_root`] on the spheres that the
//! user wrote, as in the brute-force backend, so both backends and all kernel variants return the
//! same ids.

mod aggregate;
mod build;
mod bvh;
mod giants;
#[allow(unsafe_code, reason = "the one measured kernel; its head says why it is sound")]
mod kernel;
mod limits;
mod node;
mod query;

use std::sync::Arc;

use crate::accel::intersector::{Accel, ErrorBound};
use crate::accel::options::BuildOptions;
use crate::error::Result;
use crate::geometry::SphereSet;
use crate::math::{Hit, Ray};

pub use kernel::KernelIsa;

use aggregate::Aggregate;
use build::BuildStats;
use giants::Giants;

/// The hierarchy, and the kernel variant that traverses it.
pub(super) struct NativeAccel {
    bvh: Aggregate,
    stats: BuildStats,
    isa: KernelIsa,
}

impl NativeAccel {
    /// Builds on the current rayon pool and ignores `options.threads`.
    pub(super) fn new(spheres: Arc<SphereSet>, options: &BuildOptions) -> Result<Self> {
        let (tree, shape) = build::build(&spheres, options)?;
        let first_giant = spheres.particle_count();
        let giants = Giants::build(spheres.giants(), first_giant, &options.cancel)?;
        let isa = options.isa.unwrap_or_else(KernelIsa::best);
        Ok(Self { bvh: Aggregate { tree, giants, spheres }, stats: shape, isa })
    }
}

impl Accel for NativeAccel {
    fn closest(&self, rays: &[Ray], hits: &mut [Hit]) {
        kernel::closest(self.isa, &self.bvh, rays, hits);
    }

    fn occluded(&self, rays: &[Ray], occluded: &mut [bool]) {
        kernel::occluded(self.isa, &self.bvh, rays, occluded);
    }

    /// Rays are stored with 48 bits, spheres are tested with the arithmetic of the brute-force
    /// backend, and boxes are conservative (see `node` and `kernel::ray_state`). So the error is
    /// that of brute force: `k 2^-24 = 2^-44`.
    fn error_bound(&self) -> ErrorBound {
        let k = 2f64.powi(-20);
        ErrorBound { particles: k, giants: k, rounds_origin: false }
    }

    fn bytes(&self) -> usize {
        self.bvh.tree.bytes() + self.bvh.giants.bytes()
    }

    fn details(&self) -> String {
        let BuildStats { treelets, optimal_treelets: optimal } = self.stats;
        match treelets {
            0 => self.isa.name().to_owned(),
            _ => {
                format!("{}; {optimal} of {treelets} treelets collapsed optimally", self.isa.name())
            }
        }
    }
}
