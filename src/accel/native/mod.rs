//! The bounding volume hierarchy in Rust: eight boxes a node, eight spheres a leaf, sixteen rays at a
//! time.
//!
//! Boxes are f32 and only decide what is looked at, and so does a first test of the spheres, whose
//! error is bounded. Whether a sphere is hit, and which one first, is decided in f64 by
//! [`crate::geometry::Sphere::first_root`], as in the brute-force backend, so that the two give the
//! same ids, and every form of the kernel too.

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

/// The hierarchy, and the form of the kernel that goes through it.
pub(super) struct NativeAccel {
    bvh: Aggregate,
    stats: BuildStats,
    isa: KernelIsa,
}

impl NativeAccel {
    /// Builds on the current rayon pool, whatever `options.threads` says.
    pub(super) fn new(spheres: Arc<SphereSet>, options: &BuildOptions) -> Result<Self> {
        let (tree, shape) = build::build(&spheres, options)?;
        let first_giant = spheres.particles().len();
        let giants = Giants::build(spheres.giants(), first_giant, &options.cancel)?;
        let instance = options.isa.unwrap_or_else(KernelIsa::best);
        Ok(Self { bvh: Aggregate { tree, giants, spheres }, stats: shape, isa: instance })
    }
}

impl Accel for NativeAccel {
    fn closest(&self, rays: &[Ray], hits: &mut [Hit]) {
        kernel::closest(self.isa, &self.bvh, rays, hits);
    }

    fn occluded(&self, rays: &[Ray], blocked: &mut [bool]) {
        kernel::occluded(self.isa, &self.bvh, rays, blocked);
    }

    /// The ray is known to 48 bits, and spheres are tested with the arithmetic of the brute-force
    /// backend; boxes leave nothing out (see `node` and `kernel::ray_state`). So the band is the same:
    /// `k 2^-24 = 2^-44`.
    fn error_bound(&self) -> ErrorBound {
        let k = 2f64.powi(-20);
        ErrorBound { particles: k, giants: k, rounds_origin: false }
    }

    fn bytes(&self) -> usize {
        self.bvh.tree.bytes() + self.bvh.giants.bytes()
    }

    fn details(&self) -> String {
        let BuildStats { treelets: cells, optimal_treelets: optimal } = self.stats;
        match cells {
            0 => self.isa.name().to_owned(),
            _ => {
                format!("{}; {optimal} of {cells} cells collapsed optimally", self.isa.name())
            }
        }
    }
}
