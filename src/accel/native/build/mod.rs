//! Builds the tree on all threads of the current rayon pool. The result does not depend on the
//! number of threads.
//!
//! Spheres are sorted by Morton code, which gives the top levels of the tree: the sequence is split
//! where the highest bit changes, down to *treelets* of a few thousand spheres (Lauterbach et al.
//! 2009, "Fast BVH Construction on GPUs"). Each treelet is built with the surface area heuristic,
//! in parallel with the others; the tree as a whole loses no quality. Both parts first build a
//! binary tree and then collapse it to eight children per node.
//!
//! Treelets are built in batches, and each batch is appended to the tree. Beyond the tree itself,
//! memory is needed for only one batch.

mod aabb;
mod binary_bvh;
mod collapse;
mod emit;
mod split;
mod treelets;

use std::ops::Range;

use rayon::prelude::*;

use crate::accel::options::{BuildOptions, BuildQuality};
use crate::error::{Error, Result};
use crate::geometry::SphereSet;

use super::bvh::Bvh;
use super::kernel::huge_pages::HugePageVec;
use super::limits::MAX_DEPTH;
use super::node::{BvhNode, LEAF_SIZE, LeafIds, NodeRef, SphereLeaf};

use binary_bvh::BinaryBvh;
use collapse::{Collapse, LeafKind};
use emit::EmittedTree;
use treelets::Treelets;

pub(super) use aabb::{Aabb, fast_max};
pub(super) use split::PrimRef;

/// Spheres per batch of treelets.
const SPHERES_PER_BATCH: usize = 1 << 20;

const _: () =
    assert!(treelets::MAX_DEPTH + binary_bvh::MAX_DEPTH <= MAX_DEPTH, "no tree outgrows the stack");

/// Build statistics.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct BuildStats {
    /// Number of treelets.
    pub(super) treelets: usize,
    /// Number of treelets that were collapsed by dynamic programming and not greedily.
    pub(super) optimal_treelets: usize,
}

/// A built treelet.
struct Treelet {
    emitted: EmittedTree,
    root: NodeRef,
    bounds: Aabb,
    is_optimal: bool,
}

/// Builds the tree over the particles of a set.
///
/// # Errors
/// On cancellation, if out of memory, and beyond 2^31 leaves.
pub(super) fn build(set: &SphereSet, options: &BuildOptions) -> Result<(Bvh, BuildStats)> {
    let spheres = set.particle_count();
    if spheres <= MAX_LIST_SIZE {
        return Ok((build_list(set)?, BuildStats::default()));
    }
    let treelets = Treelets::new(set);
    let (nodes, leaves) = estimate_counts(spheres);
    let mut forest = BvhStorage {
        nodes: HugePageVec::with_capacity(nodes)?,
        leaves: HugePageVec::with_capacity(leaves)?,
        ids: HugePageVec::with_capacity(leaves)?,
    };
    let mut shape = BuildStats { treelets: treelets.ranges.len(), optimal_treelets: 0 };
    let mut roots = Vec::with_capacity(treelets.ranges.len());
    for batch in treelets.batches(SPHERES_PER_BATCH) {
        let built: Result<Vec<Treelet>> = batch
            .par_iter()
            .map(|range| {
                options.cancel.check().map(|()| build_treelet(set, range.clone(), options.quality))
            })
            .collect();
        let built = built?;
        shape.optimal_treelets += built.iter().filter(|treelet| treelet.is_optimal).count();
        roots.extend(forest.append_treelets(built)?);
        let done = batch.last().map_or(0, |range| range.end);
        options.progress.report(done as f64 / spheres.max(1) as f64);
    }
    let root = match roots[..] {
        [] => None,
        _ => Some(forest.append_top_levels(&treelets, &roots)?),
    };
    Ok((Bvh::new(forest.nodes, forest.leaves, forest.ids, root), shape))
}

/// Up to this many spheres are tested one by one: a tree over them would cost more than it saves.
const MAX_LIST_SIZE: usize = 32;

/// Builds a list of leaves for a few spheres, without a tree.
fn build_list(set: &SphereSet) -> Result<Bvh> {
    let items: Vec<PrimRef> = prim_refs(set, 0..set.particle_count()).collect();
    let groups = || items.chunks(LEAF_SIZE);
    let mut leaves = HugePageVec::with_capacity(0)?;
    let mut ids = HugePageVec::with_capacity(0)?;
    leaves
        .grow(groups().len())?
        .iter_mut()
        .zip(groups())
        .for_each(|(to, of)| *to = SphereLeaf::from_prims(of));
    ids.grow(groups().len())?
        .iter_mut()
        .zip(groups())
        .for_each(|(to, of)| *to = SphereLeaf::prim_ids(of));
    Ok(Bvh::new(HugePageVec::with_capacity(0)?, leaves, ids, None))
}

/// Spheres of the set with their ids.
fn prim_refs(set: &SphereSet, range: Range<usize>) -> impl Iterator<Item = PrimRef> {
    let ids = range.start as u32..range.end as u32;
    ids.map(|id| PrimRef { sphere: set.rounded_particle(id), id })
}

/// Builds one treelet.
fn build_treelet(set: &SphereSet, range: Range<usize>, quality: BuildQuality) -> Treelet {
    let mut items: Vec<PrimRef> = prim_refs(set, range).collect();
    let binary = match quality {
        BuildQuality::Best => BinaryBvh::build_sah(&mut items),
        BuildQuality::Fast => {
            let code = |item: &PrimRef| set.morton_code(&item.sphere);
            let codes: Vec<u64> = items.iter().map(code).collect();
            BinaryBvh::build_morton(&items, &codes)
        }
    };
    let collapse = Collapse::best(&binary, LeafKind::Spheres);
    let mut built = EmittedTree::default();
    let root = built.emit_subtree(&binary, &collapse, &items, binary.root());
    let bounds = binary.nodes[binary.root() as usize].bounds;
    Treelet { emitted: built, root, bounds, is_optimal: collapse.is_optimal() }
}

/// Estimates the node and leaf counts, erring on the high side: unused capacity costs nothing.
fn estimate_counts(spheres: usize) -> (usize, usize) {
    (spheres.div_ceil(12) + 1, spheres.div_ceil(3) + 1)
}

/// The tree so far.
struct BvhStorage {
    nodes: HugePageVec<BvhNode>,
    leaves: HugePageVec<SphereLeaf>,
    ids: HugePageVec<LeafIds>,
}

impl BvhStorage {
    /// Appends a batch of treelets; returns their roots and boxes.
    fn append_treelets(&mut self, treelets: Vec<Treelet>) -> Result<Vec<(NodeRef, Aabb)>> {
        let (mut node, mut leaf) = (self.nodes.len(), self.leaves.len());
        let sum = |of: fn(&EmittedTree) -> usize| {
            treelets.iter().map(|treelet| of(&treelet.emitted)).sum::<usize>()
        };
        let mut nodes = self.nodes.grow(sum(|built| built.nodes.len()))?;
        let mut leaves = self.leaves.grow(sum(|built| built.leaves.len()))?;
        let mut ids = self.ids.grow(sum(|built| built.leaves.len()))?;
        let mut moves = Vec::with_capacity(treelets.len());
        let mut roots = Vec::with_capacity(treelets.len());
        for Treelet { emitted: built, root, bounds, .. } in treelets {
            roots.push((root.offset_by(node, leaf), bounds));
            let (own_nodes, own_leaves, own_ids);
            (own_nodes, nodes) = nodes.split_at_mut(built.nodes.len());
            (own_leaves, leaves) = leaves.split_at_mut(built.leaves.len());
            (own_ids, ids) = ids.split_at_mut(built.leaves.len());
            let moved_by = (node, leaf);
            node += built.nodes.len();
            leaf += built.leaves.len();
            moves.push((built, moved_by, own_nodes, own_leaves, own_ids));
        }
        if leaf > NodeRef::MAX_INDEX || node > NodeRef::MAX_INDEX {
            return Err(Error::backend("there are more spheres than the native intersector takes"));
        }
        moves.into_par_iter().for_each(|(built, (node, leaf), nodes, leaves, ids)| {
            leaves.copy_from_slice(&built.leaves);
            ids.copy_from_slice(&built.ids);
            for (to, from) in nodes.iter_mut().zip(&built.nodes) {
                *to = BvhNode { children: from.children.map(|c| c.offset_by(node, leaf)), ..*from };
            }
        });
        Ok(roots)
    }

    /// Appends the nodes above the treelets; returns the root.
    fn append_top_levels(
        &mut self,
        treelets: &Treelets,
        roots: &[(NodeRef, Aabb)],
    ) -> Result<NodeRef> {
        let boxes: Vec<Aabb> = roots.iter().map(|(_, bounds)| *bounds).collect();
        let binary = treelets.build_top_tree(&boxes);
        let collapse = Collapse::best(&binary, LeafKind::Treelets);
        let mut nodes = Vec::new();
        let root = emit::emit_top_levels(&binary, &collapse, roots, self.nodes.len(), &mut nodes);
        self.nodes.grow(nodes.len())?.copy_from_slice(&nodes);
        Ok(root)
    }
}

#[cfg(test)]
mod tests;
