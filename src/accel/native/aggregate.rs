//! The structure that rays are traced through.

use std::sync::Arc;

use crate::geometry::{Sphere, SphereSet};
use crate::math::Ray;

use super::bvh::Bvh;
use super::giants::Giants;
use super::node::SphereLeaf;
use super::query::{BestHit, ExactQuery};

/// The BVH of the particles, and the giants.
pub(super) struct Aggregate {
    pub(super) tree: Bvh,
    pub(super) giants: Giants,
    /// The spheres of both.
    pub(super) spheres: Arc<SphereSet>,
}

impl Aggregate {
    /// Returns the sphere that the user wrote, of which a lane of a leaf holds a copy. Only where
    /// that copy is rounded is it read from elsewhere.
    #[inline(always)]
    pub(super) fn sphere(&self, leaf: &SphereLeaf, lane: usize, id: u32) -> Sphere {
        if self.spheres.is_exact_in_f32() { leaf.sphere(lane) } else { self.spheres.sphere(id) }
    }

    /// Finds the best hit of a valid ray on a giant, or any hit if `any`. Giants come first: there
    /// are few, and a hit on one shortens the traversal of the tree.
    #[inline(always)]
    pub(super) fn closest_giant(&self, ray: &Ray, any: bool) -> BestHit {
        let best = BestHit::none(ray);
        if self.giants.is_empty() {
            return best;
        }
        let mut query = ExactQuery::new(ray, best);
        self.giants.trace(&mut query, any);
        query.best
    }
}
