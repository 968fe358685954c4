//! Emits the nodes and leaves of a collapsed tree.

use super::aabb::Aabb;
use super::binary_bvh::BinaryBvh;
use super::collapse::Collapse;
use super::split::PrimRef;
use crate::accel::native::node::{BvhNode, LeafIds, NodeRef, SphereLeaf};

/// Nodes and leaves that refer to each other by index, parents before children.
#[derive(Default)]
pub(super) struct EmittedTree {
    pub(super) nodes: Vec<BvhNode>,
    pub(super) leaves: Vec<SphereLeaf>,
    pub(super) ids: Vec<LeafIds>,
}

impl EmittedTree {
    /// Emits the tree over a subtree of the binary tree, and returns the root.
    pub(super) fn emit_subtree(
        &mut self,
        binary: &BinaryBvh,
        collapse: &Collapse,
        items: &[PrimRef],
        node: u32,
    ) -> NodeRef {
        if collapse.is_leaf(node) {
            let node = &binary.nodes[node as usize];
            let items = &items[node.first as usize..][..node.count as usize];
            self.leaves.push(SphereLeaf::from_prims(items));
            self.ids.push(SphereLeaf::prim_ids(items));
            return NodeRef::leaf(self.leaves.len() - 1);
        }
        let index = self.nodes.len();
        self.nodes.push(BvhNode::EMPTY);
        for (lane, &child) in collapse.children(node).as_slice().iter().enumerate() {
            let root = self.emit_subtree(binary, collapse, items, child);
            self.nodes[index].set_child(lane, &binary.nodes[child as usize].bounds, root);
        }
        NodeRef::node(index)
    }
}

/// Emits the nodes above existing treelets, which are the primitives of the binary tree, and
/// returns the root. `before` nodes precede `nodes`.
pub(super) fn emit_top_levels(
    binary: &BinaryBvh,
    collapse: &Collapse,
    roots: &[(NodeRef, Aabb)],
    before: usize,
    nodes: &mut Vec<BvhNode>,
) -> NodeRef {
    emit_top_node(binary, collapse, roots, before, nodes, binary.root())
}

fn emit_top_node(
    binary: &BinaryBvh,
    collapse: &Collapse,
    roots: &[(NodeRef, Aabb)],
    before: usize,
    nodes: &mut Vec<BvhNode>,
    node: u32,
) -> NodeRef {
    if collapse.is_leaf(node) {
        return roots[binary.nodes[node as usize].first as usize].0;
    }
    let index = nodes.len();
    nodes.push(BvhNode::EMPTY);
    for (lane, &child) in collapse.children(node).as_slice().iter().enumerate() {
        let root = emit_top_node(binary, collapse, roots, before, nodes, child);
        nodes[index].set_child(lane, &binary.nodes[child as usize].bounds, root);
    }
    NodeRef::node(before + index)
}
