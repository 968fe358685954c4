//! The binary tree over one cell: what the wide tree is cut from.

use super::aabb::Aabb;
use super::split::{self, PrimRef, SAH_BLOCK_SIZE};

/// Levels that the heuristic may shape; below them, items are halved.
const MAX_SAH_DEPTH: usize = 24;
/// Most levels over `2^12` items, and so over a cell: each of the halved ones leaves half of the
/// items, rounded up.
pub(super) const MAX_DEPTH: usize = MAX_SAH_DEPTH + 12;

/// A binary tree, children before parents; the last node is the root.
#[derive(Default)]
pub(super) struct BinaryBvh {
    pub(super) nodes: Vec<BinaryNode>,
}

/// A node: consecutive items, their box, and the two halves they come in.
#[derive(Clone, Copy, Debug)]
pub(super) struct BinaryNode {
    pub(super) bounds: Aabb,
    /// The first of the items.
    pub(super) first: u32,
    /// How many there are.
    pub(super) count: u32,
    /// The two children; `None` for a leaf.
    pub(super) children: Option<[u32; 2]>,
}

impl BinaryBvh {
    /// Over items that it reorders, cut where the surface area heuristic says so, down to
    /// [`SAH_BLOCK_SIZE`] items.
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
        let cut = if level < MAX_SAH_DEPTH {
            split::split_sah(items)
        } else {
            split::split_median(items)
        };
        let (left, right) = items.split_at_mut(cut.index);
        let halves = [
            self.build_sah_node(left, first, cut.bounds[0], level + 1),
            self.build_sah_node(right, first + cut.index as u32, cut.bounds[1], level + 1),
        ];
        self.push(BinaryNode { bounds, first, count: items.len() as u32, children: Some(halves) })
    }

    /// Over items in the order of a curve, whose places along it are `codes`: cut wherever the curve
    /// leaves the larger of the boxes that it fills one after the other.
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
        let at = if level < MAX_SAH_DEPTH { split::morton_split(codes) } else { items.len() / 2 };
        let left = self.build_morton_node(&items[..at], &codes[..at], first, level + 1);
        let right =
            self.build_morton_node(&items[at..], &codes[at..], first + at as u32, level + 1);
        self.push_inner(left, right)
    }

    /// Adds a leaf.
    pub(super) fn push_leaf(&mut self, count: usize, first: u32, bounds: Aabb) -> u32 {
        self.push(BinaryNode { bounds, first, count: count as u32, children: None })
    }

    /// Adds the parent of two nodes whose items are consecutive.
    pub(super) fn push_inner(&mut self, left: u32, right: u32) -> u32 {
        let [a, b] = [left, right].map(|half| self.nodes[half as usize]);
        let bounds = a.bounds.union(&b.bounds);
        let (first, count) = (a.first, a.count + b.count);
        self.push(BinaryNode { bounds, first, count, children: Some([left, right]) })
    }

    fn push(&mut self, part: BinaryNode) -> u32 {
        self.nodes.push(part);
        self.nodes.len() as u32 - 1
    }

    /// The number of the root.
    pub(super) fn root(&self) -> u32 {
        self.nodes.len() as u32 - 1
    }
}
