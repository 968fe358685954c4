//! Collapses a binary tree to eight children per node by choosing the binary nodes to keep.
//!
//! There are two methods. *Greedy* opens the child with the largest box until there are eight (Wald
//! et al. 2008, "Getting Rid of Packets"), which may leave nodes half empty. *Optimal* finds the
//! cheapest of all cuts of the binary tree by dynamic programming from the leaves up (Ylitie et al.
//! 2017, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs"). The cost here
//! is the product of tracing time, estimated by the surface area heuristic, and memory. Near the
//! greedy tree with time `T` and bytes `B`, a change of `T B` is a change of `t / T + b / B`, which
//! is a sum over nodes and leaves. The tree with the smaller product is used, so the result is
//! never worse than greedy.

use crate::accel::native::node::{BvhNode, LEAF_SIZE, LeafIds, SphereLeaf, WIDTH};

use super::binary_bvh::{BinaryBvh, BinaryNode};

/// Cost of visiting a node, for each ray that hits its box.
const NODE_COST: f32 = 1.0;
/// Cost of visiting a leaf.
const LEAF_COST: f32 = 0.8;
const NODE_BYTES: f32 = size_of::<BvhNode>() as f32;
const LEAF_BYTES: f32 = (size_of::<SphereLeaf>() + size_of::<LeafIds>()) as f32;

/// The kind of leaves in the binary tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LeafKind {
    /// Groups of spheres: nodes of up to eight may become leaves, which cost time and memory.
    Spheres,
    /// Existing treelets, whose cost is fixed.
    Treelets,
}

/// A cut of the binary tree.
pub(super) struct Collapse<'a> {
    bvh: &'a BinaryBvh,
    leaf_kind: LeafKind,
    /// Cut tables of the optimal method; empty for greedy.
    cuts: Vec<CutTable>,
}

/// The best cuts of a node into at most `n + 1` nodes, for every `n`.
#[derive(Clone, Copy, Default)]
struct CutTable {
    cost: [f32; WIDTH],
    /// How many of the nodes come from the left child; 0 if the node is not cut. The last entry is
    /// the cut into the children of a wide node.
    left: [u8; WIDTH],
}

/// Tracing time and memory of a tree.
#[derive(Clone, Copy, Debug, Default)]
struct TreeCost {
    time: f32,
    bytes: f32,
}

impl<'a> Collapse<'a> {
    /// Returns the greedy cut, or the optimal one if its product of time and memory is smaller.
    pub(super) fn best(binary: &'a BinaryBvh, leaves: LeafKind) -> Self {
        let greedy = Self::greedy(binary, leaves);
        let reference = greedy.cost();
        let optimal = Self::optimal(binary, leaves, reference);
        if optimal.cost().product() < reference.product() { optimal } else { greedy }
    }

    fn greedy(binary: &'a BinaryBvh, leaves: LeafKind) -> Self {
        Self { bvh: binary, leaf_kind: leaves, cuts: Vec::new() }
    }

    fn optimal(binary: &'a BinaryBvh, leaves: LeafKind, reference: TreeCost) -> Self {
        let mut collapse =
            Self { bvh: binary, leaf_kind: leaves, cuts: Vec::with_capacity(binary.nodes.len()) };
        for node in &binary.nodes {
            let choice = collapse.best_cuts(node, reference);
            collapse.cuts.push(choice);
        }
        collapse
    }

    /// Returns true if the optimal method was used.
    pub(super) fn is_optimal(&self) -> bool {
        !self.cuts.is_empty()
    }

    /// Returns true if a node of the binary tree becomes a leaf.
    pub(super) fn is_leaf(&self, index: u32) -> bool {
        let node = &self.bvh.nodes[index as usize];
        match (node.children, self.cuts.get(index as usize)) {
            (None, _) => true,
            (_, Some(choice)) => choice.left[WIDTH - 1] == 0,
            (Some(children), None) => {
                self.can_be_leaf(node) && {
                    let [a, b] = children.map(|child| self.area(child));
                    // Two leaves are better if most rays that hit the node miss both.
                    2.0 * (a + b) >= node.bounds.half_area()
                }
            }
        }
    }

    /// The nodes that become the children of an interior node.
    pub(super) fn children(&self, index: u32) -> Children {
        let mut children = Children { nodes: [0; WIDTH], count: 0 };
        if self.is_optimal() {
            let pair = self.bvh.nodes[index as usize].children.expect("no leaf");
            let left = self.cuts[index as usize].left[WIDTH - 1];
            self.collect_children(pair[0], left, &mut children);
            self.collect_children(pair[1], WIDTH as u8 - left, &mut children);
        } else {
            children.expand(0, self.bvh.nodes[index as usize].children.expect("no leaf"));
            while children.count < WIDTH {
                let interior = (0..children.count).filter(|&i| !self.is_leaf(children.nodes[i]));
                let area = |i: &usize| self.area(children.nodes[*i]);
                let Some(largest) = interior.max_by(|a, b| area(a).total_cmp(&area(b))) else {
                    break;
                };
                let pair = self.bvh.nodes[children.nodes[largest] as usize].children;
                children.expand(largest, pair.expect("no leaf"));
            }
        }
        children
    }

    /// Adds the best cut of a node into at most `max_count` nodes.
    fn collect_children(&self, index: u32, max_count: u8, children: &mut Children) {
        let left =
            if max_count < 2 { 0 } else { self.cuts[index as usize].left[max_count as usize - 2] };
        match self.bvh.nodes[index as usize].children {
            Some(pair) if left > 0 => {
                self.collect_children(pair[0], left, children);
                self.collect_children(pair[1], max_count - left, children);
            }
            _ => children.push(index),
        }
    }

    fn area(&self, index: u32) -> f32 {
        self.bvh.nodes[index as usize].bounds.half_area()
    }

    fn can_be_leaf(&self, node: &BinaryNode) -> bool {
        self.leaf_kind == LeafKind::Spheres && node.count as usize <= LEAF_SIZE
    }

    fn leaf_cost(&self, area: f32) -> TreeCost {
        match self.leaf_kind {
            LeafKind::Spheres => TreeCost { time: LEAF_COST * area, bytes: LEAF_BYTES },
            LeafKind::Treelets => TreeCost::default(),
        }
    }

    fn best_cuts(&self, node: &BinaryNode, reference: TreeCost) -> CutTable {
        let area = node.bounds.half_area();
        let as_leaf = self.leaf_cost(area).relative_to(reference);
        let Some(children) = node.children else {
            return CutTable { cost: [as_leaf; WIDTH], left: [0; WIDTH] };
        };
        let [a, b] = children.map(|child| &self.cuts[child as usize]);
        // The cheapest cut for each exact number of nodes, from two.
        let mut cut = [(f32::INFINITY, 0u8); WIDTH + 1];
        for (parts, cut) in cut.iter_mut().enumerate().skip(2) {
            for left in 1..parts {
                let cost = a.cost[left - 1] + b.cost[parts - left - 1];
                if cost < cut.0 {
                    *cut = (cost, left as u8);
                }
            }
        }
        let as_node = TreeCost { time: NODE_COST * area, bytes: NODE_BYTES }.relative_to(reference)
            + cut[WIDTH].0;
        let is_leaf = self.can_be_leaf(node) && as_leaf <= as_node;
        let mut choice = CutTable::default();
        choice.left[WIDTH - 1] = if is_leaf { 0 } else { cut[WIDTH].1 };
        choice.cost[0] = if is_leaf { as_leaf } else { as_node };
        for (parts, &(cost, left)) in cut.iter().enumerate().skip(2) {
            let before = choice.cost[parts - 2];
            choice.cost[parts - 1] = before.min(cost);
            if parts < WIDTH {
                let same = if parts > 2 { choice.left[parts - 3] } else { 0 };
                choice.left[parts - 2] = if cost < before { left } else { same };
            }
        }
        choice
    }

    /// Time and memory of the collapsed tree.
    fn cost(&self) -> TreeCost {
        let mut total = TreeCost::default();
        let mut remaining = vec![self.bvh.root()];
        while let Some(index) = remaining.pop() {
            let area = self.area(index);
            if self.is_leaf(index) {
                total.add(self.leaf_cost(area));
            } else {
                total.add(TreeCost { time: NODE_COST * area, bytes: NODE_BYTES });
                remaining.extend(self.children(index).as_slice());
            }
        }
        total
    }
}

/// Up to eight children.
pub(super) struct Children {
    nodes: [u32; WIDTH],
    count: usize,
}

impl Children {
    pub(super) fn as_slice(&self) -> &[u32] {
        &self.nodes[..self.count]
    }

    fn push(&mut self, index: u32) {
        self.nodes[self.count] = index;
        self.count += 1;
    }

    /// Replaces a child by its two children; in an empty list, just adds the two.
    fn expand(&mut self, slot: usize, children: [u32; 2]) {
        let rest = slot + usize::from(self.count > 0);
        self.nodes.copy_within(rest..self.count.max(rest), slot + 2);
        self.nodes[slot..slot + 2].copy_from_slice(&children);
        self.count += if self.count > 0 { 1 } else { 2 };
    }
}

impl TreeCost {
    fn product(self) -> f32 {
        self.time * self.bytes
    }

    fn add(&mut self, other: Self) {
        self.time += other.time;
        self.bytes += other.bytes;
    }

    /// The change of the product near a tree with the cost `other`.
    fn relative_to(self, other: Self) -> f32 {
        let ratio = |value: f32, of: f32| if of > 0.0 { value / of } else { 0.0 };
        ratio(self.time, other.time) + ratio(self.bytes, other.bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::super::split::PrimRef;
    use super::*;

    /// Spheres in a row at growing distances: greedy opens the long end again and again.
    fn row(count: u32) -> Vec<PrimRef> {
        let sphere = |i: u32| [1.02f32.powi(i as i32), 0.3 * (i % 7) as f32, 0.0, 0.2];
        (0..count).map(|id| PrimRef { sphere: sphere(id), id }).collect()
    }

    #[test]
    fn the_optimal_way_is_taken_where_it_is_better_and_never_where_it_is_worse() {
        for count in [9, 20, 100, 1000] {
            let binary = BinaryBvh::build_sah(&mut row(count));
            let greedy = Collapse::greedy(&binary, LeafKind::Spheres).cost();
            let best = Collapse::best(&binary, LeafKind::Spheres);
            assert!(best.cost().product() <= greedy.product(), "{count} spheres");
            assert_eq!(best.is_optimal(), best.cost().product() < greedy.product());
        }
        assert!(
            Collapse::best(&BinaryBvh::build_sah(&mut row(1000)), LeafKind::Spheres).is_optimal()
        );
    }

    #[test]
    fn expanding_a_node_puts_its_children_in_its_slot() {
        let mut children = Children { nodes: [0; WIDTH], count: 0 };
        children.expand(0, [1, 2]);
        children.expand(0, [3, 4]);
        children.expand(1, [5, 6]);
        assert_eq!(children.as_slice(), [3, 5, 6, 2]);
    }
}
