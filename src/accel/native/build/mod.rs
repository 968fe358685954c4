//! Builds the tree, on all threads of the current rayon pool, and the same one on any number.
//!
//! The spheres come sorted along a Morton curve, so the curve itself gives the upper part of the
//! tree: it is cut where its highest bit changes, down to *cells* of a few thousand spheres
//! (Lauterbach et al. 2009, "Fast BVH Construction on GPUs"). Each cell becomes a tree of its own,
//! cut by the surface area heuristic, which as a whole costs no quality and lets the cells be built
//! apart. A binary tree is built first in both parts, and then collapsed to eight children a node.
//!
//! Cells are built in waves, and the trees of a wave moved behind those of the one before: beside
//! the tree itself, no more memory is needed than for one wave.

mod binary;
mod bounds;
mod cells;
mod collapse;
mod grown;
mod split;

use std::ops::Range;

use rayon::prelude::*;

use crate::accel::options::{BuildOptions, Quality};
use crate::error::{Error, Result};
use crate::geometry::SphereSet;

use super::kernel::pages::Pages;
use super::limits::LEVELS;
use super::node::{Child, LEAF_SIZE, Leaf, LeafIds, Node};
use super::tree::Tree;

use binary::Binary;
use cells::Cells;
use collapse::{Collapse, Leaves};
use grown::Grown;

pub(super) use bounds::{Bounds, larger};
pub(super) use split::Item;

/// Spheres of a wave.
const WAVE: usize = 1 << 20;

const _: () = assert!(cells::LEVELS + binary::LEVELS <= LEVELS, "no tree outgrows the stack");

/// How the tree over some spheres came about.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Shape {
    /// Cells, whose trees were built apart.
    pub(super) cells: usize,
    /// Those of them whose nodes were chosen by dynamic programming, and not greedily.
    pub(super) optimal: usize,
}

/// A finished cell.
struct Cell {
    grown: Grown,
    root: Child,
    bounds: Bounds,
    is_optimal: bool,
}

/// Builds the tree over the particles of a set.
///
/// # Errors
/// On cancellation, when memory does not suffice, and beyond 2^31 leaves.
pub(super) fn build(set: &SphereSet, options: &BuildOptions) -> Result<(Tree, Shape)> {
    let spheres = set.particles();
    if spheres.len() <= LIST {
        return Ok((list(set)?, Shape::default()));
    }
    let cells = Cells::of(set);
    let (nodes, leaves) = expected(spheres.len());
    let mut forest = Forest {
        nodes: Pages::with_capacity(nodes)?,
        leaves: Pages::with_capacity(leaves)?,
        ids: Pages::with_capacity(leaves)?,
    };
    let mut shape = Shape { cells: cells.ranges.len(), optimal: 0 };
    let mut roots = Vec::with_capacity(cells.ranges.len());
    for wave in cells.waves(WAVE) {
        let built: Result<Vec<Cell>> = wave
            .par_iter()
            .map(|range| options.cancel.check().map(|()| cell(set, range.clone(), options.quality)))
            .collect();
        let built = built?;
        shape.optimal += built.iter().filter(|cell| cell.is_optimal).count();
        roots.extend(forest.take_in(built)?);
        let done = wave.last().map_or(0, |range| range.end);
        options.progress.report(done as f64 / spheres.len().max(1) as f64);
    }
    let root = match roots[..] {
        [] => None,
        _ => Some(forest.crown(&cells, &roots)?),
    };
    Ok((Tree::new(forest.nodes, forest.leaves, forest.ids, root), shape))
}

/// As many spheres are tested one after the other: a tree over them would cost more than it saves.
const LIST: usize = 32;

/// The leaves of a few spheres, without a tree.
fn list(set: &SphereSet) -> Result<Tree> {
    let items: Vec<Item> = items(set, 0..set.particles().len()).collect();
    let groups = || items.chunks(LEAF_SIZE);
    let mut leaves = Pages::with_capacity(0)?;
    let mut ids = Pages::with_capacity(0)?;
    leaves.grow(groups().len())?.iter_mut().zip(groups()).for_each(|(to, of)| *to = Leaf::of(of));
    ids.grow(groups().len())?.iter_mut().zip(groups()).for_each(|(to, of)| *to = Leaf::ids_of(of));
    Ok(Tree::new(Pages::with_capacity(0)?, leaves, ids, None))
}

/// Some of the set's spheres with their ids.
fn items(set: &SphereSet, range: Range<usize>) -> impl Iterator<Item = Item> {
    let start = range.start as u32;
    let spheres = set.particles()[range].iter();
    spheres.zip(start..).map(|(&sphere, id)| Item { sphere, id })
}

/// Builds one cell.
fn cell(set: &SphereSet, range: Range<usize>, quality: Quality) -> Cell {
    let spheres = &set.particles()[range.clone()];
    let mut items: Vec<Item> = items(set, range).collect();
    let binary = match quality {
        Quality::Best => Binary::shaped(&mut items),
        Quality::Fast => {
            let codes: Vec<u64> = spheres.iter().map(|sphere| set.place_on_curve(sphere)).collect();
            Binary::along_the_curve(&items, &codes)
        }
    };
    let collapse = Collapse::best(&binary, Leaves::Spheres);
    let mut grown = Grown::default();
    let root = grown.subtree(&binary, &collapse, &items, binary.root());
    let bounds = binary.nodes[binary.root() as usize].bounds;
    Cell { grown, root, bounds, is_optimal: collapse.is_optimal() }
}

/// How many nodes and leaves there will be, or somewhat more: room that is not used costs nothing.
fn expected(spheres: usize) -> (usize, usize) {
    (spheres.div_ceil(12) + 1, spheres.div_ceil(3) + 1)
}

/// What has grown so far.
struct Forest {
    nodes: Pages<Node>,
    leaves: Pages<Leaf>,
    ids: Pages<LeafIds>,
}

impl Forest {
    /// Moves the trees of a wave behind what is here; returns their roots and boxes.
    fn take_in(&mut self, cells: Vec<Cell>) -> Result<Vec<(Child, Bounds)>> {
        let (mut node, mut leaf) = (self.nodes.len(), self.leaves.len());
        let sum = |of: fn(&Grown) -> usize| cells.iter().map(|cell| of(&cell.grown)).sum::<usize>();
        let mut nodes = self.nodes.grow(sum(|grown| grown.nodes.len()))?;
        let mut leaves = self.leaves.grow(sum(|grown| grown.leaves.len()))?;
        let mut ids = self.ids.grow(sum(|grown| grown.leaves.len()))?;
        let mut moves = Vec::with_capacity(cells.len());
        let mut roots = Vec::with_capacity(cells.len());
        for Cell { grown, root, bounds, .. } in cells {
            roots.push((root.moved_by(node, leaf), bounds));
            let (own_nodes, own_leaves, own_ids);
            (own_nodes, nodes) = nodes.split_at_mut(grown.nodes.len());
            (own_leaves, leaves) = leaves.split_at_mut(grown.leaves.len());
            (own_ids, ids) = ids.split_at_mut(grown.leaves.len());
            let moved_by = (node, leaf);
            node += grown.nodes.len();
            leaf += grown.leaves.len();
            moves.push((grown, moved_by, own_nodes, own_leaves, own_ids));
        }
        if leaf > Child::LIMIT || node > Child::LIMIT {
            return Err(Error::backend("there are more spheres than the native intersector takes"));
        }
        moves.into_par_iter().for_each(|(grown, (node, leaf), nodes, leaves, ids)| {
            leaves.copy_from_slice(&grown.leaves);
            ids.copy_from_slice(&grown.ids);
            for (to, from) in nodes.iter_mut().zip(&grown.nodes) {
                *to = Node { children: from.children.map(|c| c.moved_by(node, leaf)), ..*from };
            }
        });
        Ok(roots)
    }

    /// Adds the nodes above the cells; returns the root.
    fn crown(&mut self, cells: &Cells, roots: &[(Child, Bounds)]) -> Result<Child> {
        let boxes: Vec<Bounds> = roots.iter().map(|(_, bounds)| *bounds).collect();
        let binary = cells.tree_over(&boxes);
        let collapse = Collapse::best(&binary, Leaves::Trees);
        let mut nodes = Vec::new();
        let root = grown::crown(&binary, &collapse, roots, self.nodes.len(), &mut nodes);
        self.nodes.grow(nodes.len())?.copy_from_slice(&nodes);
        Ok(root)
    }
}

#[cfg(test)]
mod tests;
