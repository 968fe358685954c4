//! The bounding volume hierarchy in Rust: eight boxes a node, eight spheres a leaf, sixteen rays at a
//! time.
//!
//! Boxes are f32 and only decide what is looked at, and so does a first test of the spheres, whose
//! error is bounded. Whether a sphere is hit, and which one first, is decided in f64 by
//! [`crate::geometry::Sphere::first_root`], as in the brute-force backend, so that the two give the
//! same ids, and every form of the kernel too.

mod build;
mod giants;
#[allow(unsafe_code, reason = "the one measured kernel; its head says why it is sound")]
mod kernel;
mod node;
mod query;
mod tree;

use std::sync::Arc;

use crate::accel::{Accel, BuildOptions, Precision};
use crate::error::Result;
use crate::geometry::SphereSet;
use crate::math::{Hit, Ray};

pub use kernel::Instance;

use build::Shape;
use giants::Giants;
use query::{Best, Query};
use tree::Tree;

/// The tree of the particles, and the giants beside it.
pub(super) struct Native {
    tree: Tree,
    shape: Shape,
    giants: Giants,
    instance: Instance,
    spheres: Arc<SphereSet>,
}

impl Native {
    /// Builds on the current rayon pool, whatever `options.threads` says.
    pub(super) fn new(spheres: Arc<SphereSet>, options: &BuildOptions) -> Result<Self> {
        let (tree, shape) = build::build(&spheres, options)?;
        let first_giant = spheres.particles().len();
        let giants = Giants::build(spheres.giants(), first_giant, &options.cancel)?;
        let instance = options.instance.unwrap_or_else(Instance::best);
        Ok(Self { tree, shape, giants, instance, spheres })
    }

    /// The best hit of a valid ray on a giant; with `any`, some hit. Giants come first: there are few,
    /// and a hit on one shortens the way through the tree.
    #[inline(always)]
    fn best_giant(&self, ray: &Ray, any: bool) -> Best {
        let best = Best::none(ray);
        if self.giants.is_empty() {
            return best;
        }
        let mut query = Query::new(ray, best);
        self.giants.trace(&mut query, any);
        query.best
    }
}

impl Accel for Native {
    fn closest(&self, rays: &[Ray], hits: &mut [Hit]) {
        kernel::closest(self, rays, hits);
    }

    fn occluded(&self, rays: &[Ray], blocked: &mut [bool]) {
        kernel::occluded(self, rays, blocked);
    }

    /// The ray is known to 48 bits, and spheres are tested with the arithmetic of the brute-force
    /// backend; boxes leave nothing out (see `node` and `kernel::slot`). So the band is the same:
    /// `k 2^-24 = 2^-44`.
    fn precision(&self) -> Precision {
        let k = 2f64.powi(-20);
        Precision { particles: k, giants: k, rounds_origin: false }
    }

    fn bytes(&self) -> usize {
        self.tree.bytes() + self.giants.bytes()
    }

    fn details(&self) -> String {
        let Shape { cells, optimal } = self.shape;
        match cells {
            0 => self.instance.name().to_owned(),
            _ => {
                format!("{}; {optimal} of {cells} cells collapsed optimally", self.instance.name())
            }
        }
    }
}
