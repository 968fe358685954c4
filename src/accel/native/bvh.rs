//! The tree.

use rayon::prelude::*;

use super::kernel::huge_pages::HugePageVec;
use super::limits::MAX_CANDIDATE_LEAVES;
use super::node::{BvhNode, LeafIds, NodeRef, SphereLeaf, WIDTH};

/// Nodes, leaves and the ids of the spheres in the leaves.
pub(super) struct Bvh {
    nodes: HugePageVec<BvhNode>,
    leaves: HugePageVec<SphereLeaf>,
    ids: HugePageVec<LeafIds>,
    /// Where a traversal starts; `None` for a list of leaves without a tree, short enough for one
    /// ray to keep all of them as candidates.
    pub(super) root: Option<NodeRef>,
    /// The centre of the root's bounds; the origin without a tree.
    pub(super) center: [f32; 3],
    /// The mean extent of the boxes of leaves, over all axes; 0 without a tree.
    pub(super) mean_leaf_extent: f32,
}

impl Bvh {
    /// A tree of at most [`MAX_DEPTH`](super::limits::MAX_DEPTH) levels of nodes.
    ///
    /// # Panics
    /// If a child refers to no node or leaf of the tree, or a leaf has no ids. The kernel relies on
    /// this.
    pub(super) fn new(
        nodes: HugePageVec<BvhNode>,
        leaves: HugePageVec<SphereLeaf>,
        ids: HugePageVec<LeafIds>,
        root: Option<NodeRef>,
    ) -> Self {
        let mut tree = Self { nodes, leaves, ids, root, center: [0.0; 3], mean_leaf_extent: 0.0 };
        let exists = |child: &NodeRef| {
            let len = if child.is_leaf() { tree.leaves().len() } else { tree.nodes().len() };
            child.index() < len
        };
        match tree.root {
            Some(root) => assert!(exists(&root), "the root exists"),
            None => assert!(tree.leaves().len() <= MAX_CANDIDATE_LEAVES, "a list is short"),
        }
        let of_nodes = tree.nodes().par_iter();
        assert!(of_nodes.all(|node| node.children.iter().all(exists)), "all children exist");
        assert_eq!(tree.leaves().len(), tree.ids().len(), "every leaf has its ids");
        tree.compute_extents();
        tree
    }

    /// Computes the centre and the mean leaf extent.
    fn compute_extents(&mut self) {
        let Some(root) = self.root.filter(|root| !root.is_leaf()) else { return };
        let root = &self.nodes()[root.index()];
        let min = |planes: &[f32; WIDTH]| planes.iter().copied().fold(f32::INFINITY, f32::min);
        let max = |planes: &[f32; WIDTH]| planes.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        let middle =
            [0, 1, 2].map(|axis| 0.5 * (min(&root.planes[axis]) + max(&root.planes[axis + 3])));
        let extents: f64 = self.nodes().par_iter().map(leaf_extents).sum();
        self.mean_leaf_extent = (extents / (3 * self.leaves().len()) as f64) as f32;
        self.center = middle;
    }

    #[inline(always)]
    pub(super) fn nodes(&self) -> &[BvhNode] {
        self.nodes.as_slice()
    }

    #[inline(always)]
    pub(super) fn leaves(&self) -> &[SphereLeaf] {
        self.leaves.as_slice()
    }

    /// The ids of the spheres in each leaf.
    #[inline(always)]
    pub(super) fn ids(&self) -> &[LeafIds] {
        self.ids.as_slice()
    }

    /// Bytes held.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(self.nodes()) + size_of_val(self.leaves()) + size_of_val(self.ids())
    }
}

/// The sum of the extents of a node's leaves along all axes.
fn leaf_extents(node: &BvhNode) -> f64 {
    let lanes = (0..WIDTH).filter(|&lane| node.children[lane].is_leaf());
    let extent = |lane: usize, axis: usize| node.planes[axis + 3][lane] - node.planes[axis][lane];
    let extents = lanes.map(|lane| (0..3).map(|axis| f64::from(extent(lane, axis))).sum::<f64>());
    extents.sum()
}
