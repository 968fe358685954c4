//! Writes nodes and leaves as a collapse has chosen them.

use super::binary::Binary;
use super::bounds::Bounds;
use super::collapse::Collapse;
use super::split::Item;
use crate::accel::native::node::{Child, Leaf, LeafIds, Node};

/// Nodes and leaves that refer to each other by their place in here, parents before children.
#[derive(Default)]
pub(super) struct Grown {
    pub(super) nodes: Vec<Node>,
    pub(super) leaves: Vec<Leaf>,
    pub(super) ids: Vec<LeafIds>,
}

impl Grown {
    /// Adds the tree over a part of the binary tree, and returns its root.
    pub(super) fn subtree(
        &mut self,
        binary: &Binary,
        collapse: &Collapse,
        items: &[Item],
        part: u32,
    ) -> Child {
        if collapse.is_leaf(part) {
            let part = &binary.nodes[part as usize];
            let items = &items[part.first as usize..][..part.count as usize];
            self.leaves.push(Leaf::of(items));
            self.ids.push(Leaf::ids_of(items));
            return Child::leaf(self.leaves.len() - 1);
        }
        let place = self.nodes.len();
        self.nodes.push(Node::EMPTY);
        for (lane, &child) in collapse.children(part).as_slice().iter().enumerate() {
            let root = self.subtree(binary, collapse, items, child);
            self.nodes[place].set(lane, &binary.nodes[child as usize].bounds, root);
        }
        Child::node(place)
    }
}

/// Adds the nodes over trees that are there already, which are the items of the binary tree, and
/// returns the root. `before` nodes come before `nodes`.
pub(super) fn crown(
    binary: &Binary,
    collapse: &Collapse,
    roots: &[(Child, Bounds)],
    before: usize,
    nodes: &mut Vec<Node>,
) -> Child {
    top(binary, collapse, roots, before, nodes, binary.root())
}

fn top(
    binary: &Binary,
    collapse: &Collapse,
    roots: &[(Child, Bounds)],
    before: usize,
    nodes: &mut Vec<Node>,
    part: u32,
) -> Child {
    if collapse.is_leaf(part) {
        return roots[binary.nodes[part as usize].first as usize].0;
    }
    let place = nodes.len();
    nodes.push(Node::EMPTY);
    for (lane, &child) in collapse.children(part).as_slice().iter().enumerate() {
        let root = top(binary, collapse, roots, before, nodes, child);
        nodes[place].set(lane, &binary.nodes[child as usize].bounds, root);
    }
    Child::node(before + place)
}
