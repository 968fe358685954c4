//! Builds the tree from the top, one wide node at a time.
//!
//! A node's items are cut in two, and the part with the largest box again, until eight parts are
//! there or none can be cut any more (Wald et al. 2008, "Getting Rid of Packets"). Parts become
//! subtrees, which are built by as many threads as the current rayon pool has and joined in the
//! order of the parts: the tree does not depend on the number of threads.

use rayon::prelude::*;

use crate::accel::Cancel;
use crate::error::{Error, Result};

use super::bounds::Bounds;
use super::kernel::pages::Pages;
use super::node::{Child, LEAF_SIZE, Leaf, Node, WIDTH};
use super::split::{self, Cut, Item};
use super::tree::Tree;

/// Levels of nodes that the heuristic may shape; below them, items are halved.
const SHAPED_LEVELS: usize = 20;
/// A node in the halved levels has at most half (rounded up) of its parent's items, so 30 levels
/// bring 2^32 items down to a leaf.
/// Below this many items a subtree is built by one thread.
const PARALLEL: usize = 4096;

impl Tree {
    /// Builds the tree over `[x, y, z, radius]`; ids are indices.
    ///
    /// # Errors
    /// On cancellation, and beyond 2^31 leaves.
    pub(super) fn build(spheres: &[[f32; 4]], cancel: &Cancel) -> Result<Self> {
        let item = |(id, &sphere): (usize, &[f32; 4])| Item { sphere, id: id as u32 };
        let mut items: Vec<Item> = spheres.par_iter().enumerate().map(item).collect();
        let mut grown = Grown::default();
        let mut root = None;
        if !items.is_empty() {
            let whole = Part::open(split::bounds_of(&items), items.len());
            let job = Job { items: &mut items, first: 0, part: whole, level: 0 };
            root = Some(grow(job, &mut grown, cancel)?);
        }
        if grown.leaves.len() > Child::LIMIT {
            return Err(Error::backend("there are more spheres than the native intersector takes"));
        }
        let leaf = |range: &LeafRange| &items[range.first as usize..][..range.count as usize];
        let (mut nodes, mut leaves, mut ids) =
            (Pages::with_capacity(0)?, Pages::with_capacity(0)?, Pages::with_capacity(0)?);
        nodes.grow(grown.nodes.len())?.copy_from_slice(&grown.nodes);
        let into = leaves.grow(grown.leaves.len())?.par_iter_mut().zip(&grown.leaves);
        into.for_each(|(into, range)| *into = Leaf::of(leaf(range)));
        let into = ids.grow(grown.leaves.len())?.par_iter_mut().zip(&grown.leaves);
        into.for_each(|(into, range)| *into = Leaf::ids_of(leaf(range)));
        cancel.check()?;
        Ok(Self::new(nodes, leaves, ids, root))
    }
}

/// Nodes and leaves that refer to each other by their place in here, children before parents.
#[derive(Default)]
struct Grown {
    nodes: Vec<Node>,
    leaves: Vec<LeafRange>,
}

/// Which of all items a leaf holds.
#[derive(Clone, Copy)]
struct LeafRange {
    first: u32,
    count: u32,
}

/// Consecutive items that become one child.
#[derive(Clone, Copy)]
struct Part {
    bounds: Bounds,
    count: usize,
    /// Whether it is known to be one leaf.
    closed: bool,
}

/// A part with its items.
struct Job<'a> {
    items: &'a mut [Item],
    /// The number of the first item among all.
    first: usize,
    part: Part,
    /// Nodes above.
    level: usize,
}

impl Part {
    fn open(bounds: Bounds, count: usize) -> Self {
        Self { bounds, count, closed: false }
    }
}

/// Adds the tree over a part to what has grown, and returns its root.
fn grow(job: Job, grown: &mut Grown, cancel: &Cancel) -> Result<Child> {
    let parts = cut_up(job.items, job.part, job.level);
    if let [_] = parts[..] {
        let range = LeafRange { first: job.first as u32, count: job.items.len() as u32 };
        grown.leaves.push(range);
        return Ok(Child::leaf(grown.leaves.len() - 1));
    }
    cancel.check()?;
    let is_large = job.items.len() >= PARALLEL;
    let jobs = jobs(job, &parts);
    let children: Vec<Child> = if is_large {
        let apart = |job| {
            let mut grown = Grown::default();
            grow(job, &mut grown, cancel).map(|root| (grown, root))
        };
        let subtrees: Result<Vec<(Grown, Child)>> = jobs.into_par_iter().map(apart).collect();
        subtrees?.into_iter().map(|(subtree, root)| grown.append(subtree, root)).collect()
    } else {
        let together = |job| grow(job, grown, cancel);
        jobs.into_iter().map(together).collect::<Result<_>>()?
    };
    let mut node = Node::EMPTY;
    for (lane, (&child, part)) in children.iter().zip(&parts).enumerate() {
        node.set(lane, &part.bounds, child);
    }
    grown.nodes.push(node);
    Ok(Child::node(grown.nodes.len() - 1))
}

/// The parts of a job, as jobs one level below.
fn jobs<'a>(job: Job<'a>, parts: &[Part]) -> Vec<Job<'a>> {
    let Job { mut items, mut first, level, .. } = job;
    let mut jobs = Vec::with_capacity(parts.len());
    for &part in parts {
        let (own, rest) = items.split_at_mut(part.count);
        jobs.push(Job { items: own, first, part, level: level + 1 });
        items = rest;
        first += part.count;
    }
    jobs
}

/// Cuts the items into up to eight parts, the largest first; one part means a leaf.
fn cut_up(items: &mut [Item], whole: Part, level: usize) -> Vec<Part> {
    let mut parts = Vec::with_capacity(WIDTH);
    parts.push(whole);
    while parts.len() < WIDTH {
        let Some(largest) = largest_open(&parts) else { break };
        let part = parts[largest];
        let start: usize = parts[..largest].iter().map(|part| part.count).sum();
        match cut(&mut items[start..][..part.count], &part.bounds, level) {
            None => parts[largest].closed = true,
            Some(Cut { at, bounds: [left, right] }) => {
                parts[largest] = Part::open(left, at);
                parts.insert(largest + 1, Part::open(right, part.count - at));
            }
        }
    }
    parts
}

fn largest_open(parts: &[Part]) -> Option<usize> {
    let area = |i: usize| parts[i].bounds.half_area();
    (0..parts.len()).filter(|&i| !parts[i].closed).max_by(|&a, &b| area(a).total_cmp(&area(b)))
}

fn cut(items: &mut [Item], bounds: &Bounds, level: usize) -> Option<Cut> {
    if level < SHAPED_LEVELS {
        split::cut(items, bounds)
    } else {
        (items.len() > LEAF_SIZE).then(|| split::halve(items))
    }
}

impl Grown {
    /// Moves a subtree behind what is here; returns the new reference to its root.
    fn append(&mut self, mut subtree: Self, root: Child) -> Child {
        let (nodes, leaves) = (self.nodes.len(), self.leaves.len());
        for child in subtree.nodes.iter_mut().flat_map(|node| &mut node.children) {
            *child = child.moved_by(nodes, leaves);
        }
        if nodes == 0 && leaves == 0 {
            *self = subtree;
        } else {
            self.nodes.append(&mut subtree.nodes);
            self.leaves.append(&mut subtree.leaves);
        }
        root.moved_by(nodes, leaves)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::native::tree::LEVELS;

    fn scattered(count: u32) -> Vec<[f32; 4]> {
        let wave = |i: u32, k: u32| (i.wrapping_mul(k) % 100_003) as f32 / 100_003.0;
        let sphere =
            |i| [wave(i, 48_271), wave(i, 69_621), wave(i, 39_373), 1e-3 * wave(i, 16_807)];
        (0..count).map(sphere).collect()
    }

    fn tree_on(threads: usize, spheres: &[[f32; 4]]) -> Tree {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| Tree::build(spheres, &Cancel::default())).expect("not cancelled")
    }

    /// Levels of nodes below and with this child.
    fn depth(tree: &Tree, child: Child) -> usize {
        if child.is_leaf() {
            return 0;
        }
        let node = &tree.nodes()[child.index()];
        let used = (0..WIDTH).filter(|&lane| node.planes[0][lane] < f32::INFINITY);
        1 + used.map(|lane| depth(tree, node.children[lane])).max().unwrap_or(0)
    }

    fn sorted_ids(tree: &Tree) -> Vec<u32> {
        let mut ids: Vec<u32> =
            tree.ids().iter().flatten().copied().filter(|&id| id != u32::MAX).collect();
        ids.sort_unstable();
        ids
    }

    #[test]
    fn the_tree_is_the_same_for_any_number_of_threads() {
        let spheres = scattered(200_000);
        let one = tree_on(1, &spheres);
        for threads in [2, 7] {
            let other = tree_on(threads, &spheres);
            assert_eq!(one.nodes(), other.nodes());
            assert_eq!(one.ids(), other.ids());
            assert_eq!(one.root, other.root);
        }
    }

    #[test]
    fn every_sphere_is_in_one_leaf() {
        for count in [0, 1, 4, 5, 8, 9, 63, 1000, 20_000] {
            let tree = tree_on(2, &scattered(count));
            assert_eq!(sorted_ids(&tree), (0..count).collect::<Vec<_>>());
        }
    }

    #[test]
    fn the_stack_bound_holds_for_hostile_scenes() {
        let concentric = |i: u32| [0.0, 0.0, 0.0, 1.0 + i as f32];
        let geometric = |i: u32| [0.875f32.powi(i as i32 % 640), 0.0, 0.0, 1e-3];
        let halving = |i: u32| [0.5f32.powi(i as i32 % 120), 0.0, 0.0, 1e-30];
        for scene in [concentric as fn(u32) -> [f32; 4], geometric, halving] {
            let spheres: Vec<_> = (0..30_000).map(scene).collect();
            let tree = tree_on(2, &spheres);
            let depth = depth(&tree, tree.root.expect("not empty"));
            assert!(depth <= LEVELS, "{depth} levels");
            assert_eq!(sorted_ids(&tree).len(), spheres.len());
        }
    }

    #[test]
    fn below_the_shaped_levels_items_are_halved() {
        let spheres = scattered(3000);
        let mut items: Vec<_> =
            (0..3000).map(|id| Item { sphere: spheres[id as usize], id }).collect();
        let whole = Part::open(split::bounds_of(&items), items.len());
        let parts = cut_up(&mut items, whole, SHAPED_LEVELS);
        assert_eq!(parts.len(), WIDTH);
        assert!(parts.iter().all(|part| part.count <= 1500));
    }

    #[test]
    fn a_build_can_be_cancelled() {
        let cancel = Cancel::default();
        cancel.cancel();
        assert!(Tree::build(&scattered(10_000), &cancel).is_err());
    }
}
