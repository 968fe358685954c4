//! The giants, in f64: a plain list, or a small tree of their own beyond 64.
//!
//! The tree is binary and implicit: the spheres are split in halves along the longest extent of
//! their centres down to eight, and a node's children follow from its range. Boxes are f64 and need
//! only the slack of [`super::node::BvhNode::set_child`].

use crate::error::Result;
use crate::geometry::Sphere;
use crate::math::DVec3;
use crate::task::CancelToken;

use super::node::F64_BOX_SLACK;
use super::query::ExactQuery;

/// Up to this many giants are tested one by one.
const MAX_LIST_SIZE: usize = 64;
/// Maximum number of spheres in a leaf.
const MAX_LEAF_SIZE: usize = 8;

/// The giants of a scene; the tree's nodes are in depth-first order.
pub(super) struct Giants {
    giants: Box<[Giant]>,
    nodes: Box<[GiantNode]>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Giant {
    sphere: Sphere,
    id: u32,
}

/// A box, its giants, and the index of its right child (the left child comes next); a leaf has no
/// right child.
#[derive(Clone, Debug, PartialEq)]
struct GiantNode {
    low: DVec3,
    high: DVec3,
    first: u32,
    count: u32,
    right: Option<u32>,
}

impl Giants {
    /// Builds over giants with the ids from `first_id`.
    ///
    /// # Errors
    /// On cancellation.
    pub(super) fn build(
        giants: impl Iterator<Item = Sphere>,
        first_id: usize,
        cancel: &CancelToken,
    ) -> Result<Self> {
        let giant = |(i, sphere)| Giant { sphere, id: (first_id + i) as u32 };
        let mut giants: Box<[Giant]> = giants.enumerate().map(giant).collect();
        let mut nodes = Vec::new();
        if giants.len() > MAX_LIST_SIZE {
            build_node(&mut giants, 0, &mut nodes, cancel)?;
        }
        Ok(Self { giants, nodes: nodes.into_boxed_slice() })
    }

    /// Bytes held.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(&*self.giants) + size_of_val(&*self.nodes)
    }

    /// Returns true if there are no giants.
    #[inline(always)]
    pub(super) fn is_empty(&self) -> bool {
        self.giants.is_empty()
    }

    /// Tests every giant that may improve the query's best hit; if `any`, stops at the first hit.
    pub(super) fn trace(&self, query: &mut ExactQuery, any: bool) {
        if self.nodes.is_empty() {
            intersect_all(&self.giants, query);
        } else {
            self.traverse(0, safe_inverse(query.direction), query, any);
        }
    }

    /// Recursive; the tree is at most 30 levels deep, because it is split in halves.
    fn traverse(&self, index: usize, inverse: DVec3, query: &mut ExactQuery, any: bool) {
        let node = &self.nodes[index];
        if (any && query.best.is_hit()) || !node.may_intersect(inverse, query) {
            return;
        }
        match node.right {
            None => {
                intersect_all(&self.giants[node.first as usize..][..node.count as usize], query)
            }
            Some(right) => {
                let (left, right) = (index + 1, right as usize);
                let order = |index: usize| {
                    let GiantNode { low, high, .. } = &self.nodes[index];
                    (low + high).dot(query.direction)
                };
                let (near, far) =
                    if order(left) <= order(right) { (left, right) } else { (right, left) };
                self.traverse(near, inverse, query, any);
                self.traverse(far, inverse, query, any);
            }
        }
    }
}

/// The reciprocal of each component. Components below 2^-60 of the length are raised to that, which
/// moves a point of the ray by far less than the slack and avoids division by zero.
fn safe_inverse(direction: DVec3) -> DVec3 {
    let smallest = direction.length() / (1u64 << 60) as f64;
    direction.abs().max(DVec3::splat(smallest)).copysign(direction).recip()
}

fn intersect_all(giants: &[Giant], query: &mut ExactQuery) {
    giants.iter().for_each(|giant| query.intersect(giant.id, &giant.sphere));
}

fn build_node(
    giants: &mut [Giant],
    first: usize,
    nodes: &mut Vec<GiantNode>,
    cancel: &CancelToken,
) -> Result<()> {
    cancel.check()?;
    let index = nodes.len();
    nodes.push(GiantNode::new(giants, first));
    if giants.len() > MAX_LEAF_SIZE {
        let mid = split_median(giants);
        let (left, right) = giants.split_at_mut(mid);
        build_node(left, first, nodes, cancel)?;
        nodes[index].right = Some(nodes.len() as u32);
        build_node(right, first + mid, nodes, cancel)?;
    }
    Ok(())
}

/// Moves the half with the smaller centres to the front, along the axis of the largest extent.
fn split_median(giants: &mut [Giant]) -> usize {
    let (low, high) =
        bounds_of(giants.iter().map(|giant| (giant.sphere.center, giant.sphere.center)));
    let axis = (high - low).max_position();
    let mid = giants.len() / 2;
    giants.select_nth_unstable_by(mid, |a, b| {
        let (x, y) = (a.sphere.center[axis], b.sphere.center[axis]);
        x.total_cmp(&y).then(a.id.cmp(&b.id))
    });
    mid
}

fn bounds_of(boxes: impl Iterator<Item = (DVec3, DVec3)>) -> (DVec3, DVec3) {
    let empty = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    boxes.fold(empty, |(low, high), next| (low.min(next.0), high.max(next.1)))
}

impl GiantNode {
    fn new(giants: &[Giant], first: usize) -> Self {
        let (low, high) = bounds_of(giants.iter().map(|Giant { sphere, .. }| {
            (sphere.center - sphere.radius, sphere.center + sphere.radius)
        }));
        let slack = F64_BOX_SLACK * low.abs().max(high.abs()).max_element();
        let (low, high) = (low - slack, high + slack);
        Self { low, high, first: first as u32, count: giants.len() as u32, right: None }
    }

    /// Returns true if the ray may intersect the box before its best hit.
    ///
    /// The planes are moved apart by the bound on the f64 error for this origin, both here and in
    /// the sphere test.
    fn may_intersect(&self, inverse: DVec3, query: &ExactQuery) -> bool {
        let slack = F64_BOX_SLACK * query.origin.abs().max_element();
        let a = (self.low - slack - query.origin) * inverse;
        let b = (self.high + slack - query.origin) * inverse;
        let (mut entry, mut exit) = (query.t_min, query.best.t);
        for axis in 0..3 {
            entry = entry.max(a[axis].min(b[axis]));
            exit = exit.min(a[axis].max(b[axis]));
        }
        entry <= exit * (1.0 + F64_BOX_SLACK)
    }
}
