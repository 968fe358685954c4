//! A tree over spheres: finds those that a query may concern.

use std::ops::ControlFlow;

use crate::geometry::Sphere;
use crate::math::DVec3;

/// Maximum number of spheres in a leaf.
const MAX_LEAF: usize = 4;

/// A bounding-box tree over the centres of spheres, without pointers: a range of the sorted spheres
/// is split in the middle.
pub(super) struct SphereTree {
    /// Spheres with their index, sorted along the tree.
    spheres: Vec<(Sphere, u32)>,
    /// In depth-first order; the second child of a node follows all nodes of the first.
    nodes: Vec<Node>,
}

/// A range still to be visited: its node, its first sphere and their number.
pub(super) type PendingRange = (usize, usize, usize);

/// The bounds of a range of spheres.
#[derive(Clone, Copy)]
pub(super) struct SphereBounds {
    /// Bounds of the centres.
    min: DVec3,
    max: DVec3,
    /// Bounds of the radii.
    pub(super) radii: [f64; 2],
}

#[derive(Clone, Copy)]
struct Node {
    bounds: SphereBounds,
    /// Number of nodes in this subtree.
    size: u32,
}

impl SphereBounds {
    /// Returns the squares of the least and the largest distance of a point from a centre in the
    /// box.
    #[inline]
    pub(super) fn distances_squared(&self, point: DVec3) -> [f64; 2] {
        let Self { min, max, .. } = *self;
        let nearest = (min - point).max(point - max).max(DVec3::ZERO).length_squared();
        let farthest = (max - point).max(point - min).length_squared();
        [nearest, farthest]
    }
}

impl SphereTree {
    /// Builds the tree over spheres, whose indices count from 0.
    pub(super) fn new(spheres: impl Iterator<Item = Sphere>) -> Self {
        let mut spheres: Vec<_> = spheres.zip(0..).collect();
        let mut nodes = Vec::new();
        build(&mut spheres, &mut nodes);
        Self { spheres, nodes }
    }

    /// Calls `test` with the index of every sphere, leaving out ranges of which `may_concern`
    /// returns false, until `test` breaks. `pending` is scratch space.
    #[inline]
    pub(super) fn visit(
        &self,
        pending: &mut Vec<PendingRange>,
        may_concern: impl Fn(&SphereBounds) -> bool,
        mut test: impl FnMut(u32, &Sphere) -> ControlFlow<()>,
    ) {
        let (mut node, mut first, mut count) = (0, 0, self.spheres.len());
        pending.clear();
        loop {
            if count > 0 && may_concern(&self.nodes[node].bounds) {
                if count > MAX_LEAF {
                    let half = count / 2;
                    let second = node + 1 + self.nodes[node + 1].size as usize;
                    pending.push((second, first + half, count - half));
                    (node, count) = (node + 1, half);
                    continue;
                }
                for (sphere, index) in &self.spheres[first..first + count] {
                    if test(*index, sphere).is_break() {
                        return;
                    }
                }
            }
            let Some(next) = pending.pop() else { return };
            (node, first, count) = next;
        }
    }
}

/// Sorts a range of spheres into a subtree and returns its number of nodes.
fn build(spheres: &mut [(Sphere, u32)], nodes: &mut Vec<Node>) -> u32 {
    let mut bounds = SphereBounds {
        min: DVec3::INFINITY,
        max: DVec3::NEG_INFINITY,
        radii: [f64::INFINITY, 0.0],
    };
    for (Sphere { center, radius }, _) in spheres.iter() {
        (bounds.min, bounds.max) = (bounds.min.min(*center), bounds.max.max(*center));
        bounds.radii = [bounds.radii[0].min(*radius), bounds.radii[1].max(*radius)];
    }
    let index = nodes.len();
    nodes.push(Node { bounds, size: 1 });
    if spheres.len() > MAX_LEAF {
        let extent = bounds.max - bounds.min;
        let axis = (0..3).max_by(|&a, &b| extent[a].total_cmp(&extent[b])).unwrap_or(0);
        let half = spheres.len() / 2;
        let key = |(sphere, index): &(Sphere, u32)| (sphere.center[axis], *index);
        spheres.select_nth_unstable_by(half, |a, b| {
            let ((a, i), (b, j)) = (key(a), key(b));
            a.total_cmp(&b).then(i.cmp(&j))
        });
        let (first, second) = spheres.split_at_mut(half);
        nodes[index].size += build(first, nodes) + build(second, nodes);
    }
    nodes[index].size
}
