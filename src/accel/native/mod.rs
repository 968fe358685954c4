//! The bounding volume hierarchy in Rust: eight boxes a node, eight spheres a leaf.
//!
//! Boxes are f32 and only decide what is looked at. Whether a sphere is hit, and which one first,
//! is decided in f64 by [`crate::geometry::Sphere::first_root`], as in the brute-force backend, so
//! that the two give the same ids. This is not yet the fast kernel: rays are traced one at a time,
//! in safe Rust that the compiler vectorises for the instruction set of the whole program.

mod bounds;
mod build;
mod giants;
mod node;
mod slabs;
mod split;
mod traverse;

use crate::accel::{Accel, BuildOptions, Precision};
use crate::error::Result;
use crate::geometry::SphereSet;
use crate::math::{Hit, Ray};

use build::Tree;
use giants::Giants;
use traverse::{Goal, Query, Stack};

/// The tree of the particles, and the giants beside it.
pub(super) struct Native {
    tree: Tree,
    giants: Giants,
}

impl Native {
    /// Builds on the current rayon pool, whatever `options.threads` says.
    pub(super) fn new(spheres: &SphereSet, options: &BuildOptions) -> Result<Self> {
        let tree = Tree::build(spheres.particles(), &options.cancel)?;
        let first_giant = spheres.particles().len();
        let giants = Giants::build(spheres.giants(), first_giant, &options.cancel)?;
        Ok(Self { tree, giants })
    }

    /// The ray after it was traced; `None` if it is not valid. Giants come first: there are few,
    /// and a hit on one shortens the way through the tree.
    fn trace(&self, ray: &Ray, goal: Goal, stack: &mut Stack) -> Option<Query> {
        let mut query = Query::new(ray)?;
        self.giants.trace(&mut query, goal);
        if !query.reaches(goal) {
            self.tree.trace(&mut query, goal, stack);
        }
        Some(query)
    }
}

impl Accel for Native {
    fn closest(&self, rays: &[Ray], hits: &mut [Hit]) {
        let mut stack = Stack::new();
        for (ray, hit) in rays.iter().zip(hits) {
            let traced = self.trace(ray, Goal::Closest, &mut stack);
            *hit = traced.map_or(Hit::MISS, |query| query.hit());
        }
    }

    fn occluded(&self, rays: &[Ray], blocked: &mut [bool]) {
        let mut stack = Stack::new();
        for (ray, blocked) in rays.iter().zip(blocked) {
            let traced = self.trace(ray, Goal::Any, &mut stack);
            *blocked = traced.is_some_and(|query| query.has_hit());
        }
    }

    /// The ray is known to 48 bits, and spheres are tested with the arithmetic of the brute-force
    /// backend; boxes leave nothing out (see `node` and `slabs`). So the band is the same:
    /// `k 2^-24 = 2^-44`.
    fn precision(&self) -> Precision {
        let k = 2f64.powi(-20);
        Precision { particles: k, giants: k, rounds_origin: false }
    }

    fn bytes(&self) -> usize {
        self.tree.bytes() + self.giants.bytes()
    }
}
