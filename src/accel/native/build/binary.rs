//! The binary tree over one cell: what the wide tree is cut from.

use super::bounds::Bounds;
use super::split::{self, GROUP, Item};

/// Levels that the heuristic may shape; below them, items are halved.
const SHAPED_LEVELS: usize = 24;
/// Most levels over `2^12` items, and so over a cell: each of the halved ones leaves half of the
/// items, rounded up.
pub(super) const LEVELS: usize = SHAPED_LEVELS + 12;

/// A binary tree, children before parents; the last node is the root.
#[derive(Default)]
pub(super) struct Binary {
    pub(super) nodes: Vec<Part>,
}

/// A node: consecutive items, their box, and the two halves they come in.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    pub(super) bounds: Bounds,
    /// The first of the items.
    pub(super) first: u32,
    /// How many there are.
    pub(super) count: u32,
    /// The two children; `None` for a leaf.
    pub(super) halves: Option<[u32; 2]>,
}

impl Binary {
    /// Over items that it reorders, cut where the surface area heuristic says so, down to
    /// [`GROUP`] items.
    pub(super) fn shaped(items: &mut [Item]) -> Self {
        let mut binary = Self { nodes: Vec::with_capacity(items.len()) };
        binary.shape(items, 0, split::bounds_of(items), 0);
        binary
    }

    fn shape(&mut self, items: &mut [Item], first: u32, bounds: Bounds, level: usize) -> u32 {
        debug_assert!(level <= LEVELS, "{level}");
        if items.len() <= GROUP {
            return self.leaf(items.len(), first, bounds);
        }
        let cut = if level < SHAPED_LEVELS { split::cut(items) } else { split::halve(items) };
        let (left, right) = items.split_at_mut(cut.at);
        let halves = [
            self.shape(left, first, cut.bounds[0], level + 1),
            self.shape(right, first + cut.at as u32, cut.bounds[1], level + 1),
        ];
        self.push(Part { bounds, first, count: items.len() as u32, halves: Some(halves) })
    }

    /// Over items in the order of a curve, whose places along it are `codes`: cut wherever the curve
    /// leaves the larger of the boxes that it fills one after the other.
    pub(super) fn along_the_curve(items: &[Item], codes: &[u64]) -> Self {
        let mut binary = Self { nodes: Vec::with_capacity(items.len()) };
        binary.follow(items, codes, 0, 0);
        binary
    }

    fn follow(&mut self, items: &[Item], codes: &[u64], first: u32, level: usize) -> u32 {
        debug_assert!(level <= LEVELS, "{level}");
        if items.len() <= GROUP {
            return self.leaf(items.len(), first, split::bounds_of(items));
        }
        let at = if level < SHAPED_LEVELS { split::curve_cut(codes) } else { items.len() / 2 };
        let left = self.follow(&items[..at], &codes[..at], first, level + 1);
        let right = self.follow(&items[at..], &codes[at..], first + at as u32, level + 1);
        self.join(left, right)
    }

    /// Adds a leaf.
    pub(super) fn leaf(&mut self, count: usize, first: u32, bounds: Bounds) -> u32 {
        self.push(Part { bounds, first, count: count as u32, halves: None })
    }

    /// Adds the parent of two nodes whose items are consecutive.
    pub(super) fn join(&mut self, left: u32, right: u32) -> u32 {
        let [a, b] = [left, right].map(|half| self.nodes[half as usize]);
        let bounds = a.bounds.join(&b.bounds);
        let (first, count) = (a.first, a.count + b.count);
        self.push(Part { bounds, first, count, halves: Some([left, right]) })
    }

    fn push(&mut self, part: Part) -> u32 {
        self.nodes.push(part);
        self.nodes.len() as u32 - 1
    }

    /// The number of the root.
    pub(super) fn root(&self) -> u32 {
        self.nodes.len() as u32 - 1
    }
}
