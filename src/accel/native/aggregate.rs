//! The structure that rays are traced through.

use std::sync::Arc;

use crate::geometry::SphereSet;
use crate::math::Ray;

use super::bvh::Bvh;
use super::giants::Giants;
use super::query::{BestHit, ExactQuery};

/// The tree of the particles, and the giants.
pub(super) struct Aggregate {
    pub(super) tree: Bvh,
    pub(super) giants: Giants,
    /// The spheres of both.
    pub(super) spheres: Arc<SphereSet>,
}

impl Aggregate {
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
