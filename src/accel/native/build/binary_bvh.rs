//! The binary tree over one treelet, from which the wide tree is collapsed.

use super::aabb::Aabb;
use super::split::{self, PrimRef, SAH_BLOCK_SIZE};

/// Levels split by the surface area heuristic; below them, primitives are split in halves.
const MAX_SAH_DEPTH: usize = 24;
/// Maximum depth over `2^12` primitives, and so of a treelet: each halving leaves half of the
/// primitives, rounded up.
pub(super) const MAX_DEPTH: usize = MAX_SAH_DEPTH + 12;

/// A binary tree, stored children first; the last node is the root.
#[derive(Default)]
pub(super) struct BinaryBvh {
    pub(super) nodes: Vec<BinaryNode>,
}

/// A node: consecutive primitives, their bounds, and two children.
#[derive(Clone, Copy, Debug)]
pub(super) struct BinaryNode {
    pub(super) bounds: Aabb,
    /// The first primitive.
    pub(super) first: u32,
    /// The number of primitives.
    pub(super) count: u32,
    /// The two children; `None` for a leaf.
    pub(super) children: Option<[u32; 2]>,
}

impl BinaryBvh {
    /// Builds a tree with the surface area heuristic, down to [`SAH_BLOCK_SIZE`] primitives.
    /// Reorders the primitives.
    pub(super) fn build_sah(items: &mut [PrimRef]) -> Self {
        let mut binary = Self { nodes: Vec::with_capacity(items.len()) };
        binary.build_sah_node(items, 0, split::bounds_of(items), 0);
        binary
    }

    fn build_sah_node(
        &mut self,
        items: &mut [PrimRef],
        first: u32,
        bounds: Aabb,
        level: usize,
    ) -> u32 {
        debug_assert!(level <= MAX_DEPTH, "{level}");
        if items.len() <= SAH_BLOCK_SIZE {
            return self.push_leaf(items.len(), first, bounds);
        }
        let split = if level < MAX_SAH_DEPTH {
            split::split_sah(items)
        } else {
            split::split_median(items)
        };
        let (left, right) = items.split_at_mut(split.index);
        let children = [
            self.build_sah_node(left, first, split.bounds[0], level + 1),
            self.build_sah_node(right, first + split.index as u32, split.bounds[1], level + 1),
        ];
        self.push(BinaryNode { bounds, first, count: items.len() as u32, children: Some(children) })
    }

    /// Builds a tree over primitives in Morton order, whose `codes` are given. Splits where the
    /// highest differing bit of the Morton codes changes.
    pub(super) fn build_morton(items: &[PrimRef], codes: &[u64]) -> Self {
        let mut binary = Self { nodes: Vec::with_capacity(items.len()) };
        binary.build_morton_node(items, codes, 0, 0);
        binary
    }

    fn build_morton_node(
        &mut self,
        items: &[PrimRef],
        codes: &[u64],
        first: u32,
        level: usize,
    ) -> u32 {
        debug_assert!(level <= MAX_DEPTH, "{level}");
        if items.len() <= SAH_BLOCK_SIZE {
            return self.push_leaf(items.len(), first, split::bounds_of(items));
        }
        let mid = if level < MAX_SAH_DEPTH { split::morton_split(codes) } else { items.len() / 2 };
        let left = self.build_morton_node(&items[..mid], &codes[..mid], first, level + 1);
        let right =
            self.build_morton_node(&items[mid..], &codes[mid..], first + mid as u32, level + 1);
        self.push_inner(left, right)
    }

    /// Appends a leaf.
    pub(super) fn push_leaf(&mut self, count: usize, first: u32, bounds: Aabb) -> u32 {
        self.push(BinaryNode { bounds, first, count: count as u32, children: None })
    }

    /// Appends the parent of two nodes with consecutive primitives.
    pub(super) fn push_inner(&mut self, left: u32, right: u32) -> u32 {
        let [a, b] = [left, right].map(|child| self.nodes[child as usize]);
        let bounds = a.bounds.union(&b.bounds);
        let (first, count) = (a.first, a.count + b.count);
        self.push(BinaryNode { bounds, first, count, children: Some([left, right]) })
    }

    fn push(&mut self, node: BinaryNode) -> u32 {
        self.nodes.push(node);
        self.nodes.len() as u32 - 1
    }

    /// The index of the root.
    pub(super) fn root(&self) -> u32 {
        self.nodes.len() as u32 - 1
    }
}
