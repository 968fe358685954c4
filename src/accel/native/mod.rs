//! The bounding volume hierarchy in Rust: eight boxes a node, eight spheres a leaf, sixteen rays at a
//! time.
//!
//! Boxes are f32 and only decide what is looked at, and so does a first test of the spheres, whose
//! error is bounded. Whether a sphere is hit, and which one first, is decided in f64 by
//! [`crate::geometry::Sphere::first_root`], as in the brute-force backend, so that the two give the
//! same ids, and every form of the kernel too.

mod bounds;
mod build;
mod giants;
#[allow(unsafe_code, reason = "the one measured kernel; its head says why it is sound")]
mod kernel;
mod node;
mod query;
mod split;
mod tree;

use crate::accel::{Accel, BuildOptions, Precision};
use crate::error::Result;
use crate::geometry::SphereSet;
use crate::math::{Hit, Ray};

pub use kernel::Instance;

use giants::Giants;
use node::Child;
use query::Query;
use tree::Tree;

/// The tree of the particles, and the giants beside it.
pub(super) struct Native {
    tree: Tree,
    giants: Giants,
    instance: Instance,
}

impl Native {
    /// Builds on the current rayon pool, whatever `options.threads` says.
    pub(super) fn new(spheres: &SphereSet, options: &BuildOptions) -> Result<Self> {
        let tree = Tree::build(spheres.particles(), &options.cancel)?;
        let first_giant = spheres.particles().len();
        let giants = Giants::build(spheres.giants(), first_giant, &options.cancel)?;
        Ok(Self { tree, giants, instance: options.instance.unwrap_or_else(Instance::best) })
    }

    /// A ray that needs the tree, with the tree's root; else what is known of it already, which is
    /// nothing if it is not valid. Giants come first: there are few, and a hit on one shortens the
    /// way through the tree.
    #[inline(always)]
    fn begin(&self, ray: &Ray, any: bool) -> std::result::Result<(Query, Child), Option<Query>> {
        let mut query = Query::new(ray).ok_or(None)?;
        if !self.giants.is_empty() {
            self.giants.trace(&mut query, any);
        }
        match self.tree.root {
            Some(root) if query.direction.length_squared() > 0.0 && !(any && query.has_hit()) => {
                Ok((query, root))
            }
            _ => Err(Some(query)),
        }
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
}
