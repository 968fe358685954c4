//! What a ray is traced through.

use std::sync::Arc;

use crate::geometry::SphereSet;
use crate::math::Ray;

use super::bvh::Bvh;
use super::giants::Giants;
use super::query::{BestHit, ExactQuery};

/// The tree of the particles, and the giants beside it.
pub(super) struct Aggregate {
    pub(super) tree: Bvh,
    pub(super) giants: Giants,
    /// The spheres that both are made of.
    pub(super) spheres: Arc<SphereSet>,
}

impl Aggregate {
    /// The best hit of a valid ray on a giant; with `any`, some hit. Giants come first: there are few,
    /// and a hit on one shortens the way through the tree.
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
