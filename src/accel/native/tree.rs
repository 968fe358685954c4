//! The finished tree.

use rayon::prelude::*;

use super::kernel::{KEPT, pages::Pages};
use super::node::{Child, Leaf, LeafIds, Node, WIDTH};

/// Levels of nodes that no tree has more of; the builder sees to that.
pub(super) const LEVELS: usize = 96;
/// Entries that the stack of a traversal needs: its end, and each level takes one and leaves up to
/// eight, which are always written.
pub(super) const STACK_SIZE: usize = 1 + (WIDTH - 1) * LEVELS + 2 * WIDTH;

/// Nodes, leaves and the ids of the leaves' spheres.
pub(super) struct Tree {
    nodes: Pages<Node>,
    leaves: Pages<Leaf>,
    ids: Pages<LeafIds>,
    /// Where a traversal starts; `None` for a list of leaves without a tree over it, which are no more
    /// than a ray can keep.
    pub(super) root: Option<Child>,
}

impl Tree {
    /// A tree of at most [`LEVELS`] levels of nodes.
    ///
    /// # Panics
    /// When a child is no node or leaf of the tree, or a leaf has no ids. The kernel relies on it.
    pub(super) fn new(
        nodes: Pages<Node>,
        leaves: Pages<Leaf>,
        ids: Pages<LeafIds>,
        root: Option<Child>,
    ) -> Self {
        let tree = Self { nodes, leaves, ids, root };
        let exists = |child: &Child| {
            let there = if child.is_leaf() { tree.leaves().len() } else { tree.nodes().len() };
            child.index() < there
        };
        match tree.root {
            Some(root) => assert!(exists(&root), "the root exists"),
            None => assert!(tree.leaves().len() <= KEPT, "a list is short"),
        }
        let of_nodes = tree.nodes().par_iter();
        assert!(of_nodes.all(|node| node.children.iter().all(exists)), "all children exist");
        assert_eq!(tree.leaves().len(), tree.ids().len(), "every leaf has its ids");
        tree
    }

    #[inline(always)]
    pub(super) fn nodes(&self) -> &[Node] {
        self.nodes.as_slice()
    }

    #[inline(always)]
    pub(super) fn leaves(&self) -> &[Leaf] {
        self.leaves.as_slice()
    }

    /// As many as leaves.
    #[inline(always)]
    pub(super) fn ids(&self) -> &[LeafIds] {
        self.ids.as_slice()
    }

    /// Bytes held.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(self.nodes()) + size_of_val(self.leaves()) + size_of_val(self.ids())
    }
}
