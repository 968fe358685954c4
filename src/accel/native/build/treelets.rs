//! The top levels of the tree: the Morton curve, split into treelets.

use std::ops::Range;

use crate::geometry::SphereSet;

use super::aabb::Aabb;
use super::binary_bvh::BinaryBvh;

/// Maximum number of spheres in a treelet.
pub(super) const MAX_TREELET_SIZE: usize = 4096;
/// Levels split by Morton code; below them, the spheres are split in halves.
const MAX_MORTON_DEPTH: usize = 40;
/// Maximum depth: 20 more levels halve 2^32 spheres down to a treelet.
pub(super) const MAX_DEPTH: usize = MAX_MORTON_DEPTH + 20;

/// The treelets of a set, in Morton order, and the binary tree over them.
pub(super) struct Treelets {
    /// The spheres of each treelet. None is empty.
    pub(super) ranges: Vec<Range<usize>>,
    /// For each node of the tree, children first, its two children; `None` for the next treelet.
    top_tree: Vec<Option<[u32; 2]>>,
}

impl Treelets {
    pub(super) fn new(set: &SphereSet) -> Self {
        let mut treelets = Self { ranges: Vec::new(), top_tree: Vec::new() };
        if set.particle_count() > 0 {
            treelets.split(set, 0..set.particle_count(), 0);
        }
        treelets
    }

    fn split(&mut self, set: &SphereSet, range: Range<usize>, level: usize) -> u32 {
        debug_assert!(level <= MAX_DEPTH, "{level}");
        if range.len() <= MAX_TREELET_SIZE {
            self.ranges.push(range);
            self.top_tree.push(None);
        } else {
            let mid = range.start + morton_split(set, &range, level);
            let left = self.split(set, range.start..mid, level + 1);
            let right = self.split(set, mid..range.end, level + 1);
            self.top_tree.push(Some([left, right]));
        }
        self.top_tree.len() as u32 - 1
    }

    /// Batches of treelets in order, each with at least `spheres` spheres.
    pub(super) fn batches(&self, spheres: usize) -> impl Iterator<Item = &[Range<usize>]> {
        let mut remaining = &self.ranges[..];
        std::iter::from_fn(move || {
            let first = remaining.first()?.start;
            let end = remaining.partition_point(|range| range.start < first + spheres);
            let (batch, rest) = remaining.split_at(end);
            remaining = rest;
            Some(batch)
        })
    }

    /// Builds the binary tree whose primitives are the treelets.
    pub(super) fn build_top_tree(&self, boxes: &[Aabb]) -> BinaryBvh {
        let mut binary = BinaryBvh::default();
        let mut treelet = 0;
        for node in &self.top_tree {
            match *node {
                Some([left, right]) => binary.push_inner(left, right),
                None => {
                    treelet += 1;
                    binary.push_leaf(1, treelet as u32 - 1, boxes[treelet - 1])
                }
            };
        }
        binary
    }
}

/// Returns the index where the highest differing bit of the Morton codes changes; the middle if all
/// are equal.
fn morton_split(set: &SphereSet, range: &Range<usize>, level: usize) -> usize {
    let code = |index: usize| set.morton_code(&set.rounded_particle(index as u32));
    let differing = code(range.start) ^ code(range.end - 1);
    if level >= MAX_MORTON_DEPTH || differing == 0 {
        return range.len() / 2;
    }
    let bit = 1u64 << differing.ilog2();
    // The codes ascend: bisects for the first that has the bit.
    let (mut low, mut high) = (range.start, range.end);
    while low < high {
        let middle = low + (high - low) / 2;
        if code(middle) & bit == 0 { low = middle + 1 } else { high = middle }
    }
    low - range.start
}
