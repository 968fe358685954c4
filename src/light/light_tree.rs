//! The light tree: selects one of very many emitters in logarithmic time.
//!
//! A binary tree of clusters. From the root down, each step picks one of two children with
//! probabilities proportional to their importance at the shading point. A single random number
//! serves all steps and is remapped to a uniform number after each. The probability of an emitter
//! is the product along its path; it is recomputed for emitters found by BSDF sampling.
//!
//! The build splits along the axis and plane with the least `power x surface area` of the two
//! boxes, weighted by the flatness of the box (Conty Estevez and Kulla 2018, section 4.4, without
//! the orientation term, which is equal for all spheres). The result does not depend on the thread
//! count.

use crate::fault::fault;
use crate::math::DVec3;

use super::context::LightSampleContext;
use super::light_bounds::{LightBounds, LightItem};

/// Number of bins along each axis: one more than the planes tried.
const BINS: usize = 16;
/// Ranges with fewer emitters are built without a task of their own.
const PARALLEL_MIN_LIGHTS: usize = 4096;
/// Marks a leaf node.
const LEAF: u32 = 1 << 31;
/// Maximum number of emitters in a tree.
pub(super) const MAX_LIGHTS: usize = 1 << 29;

/// A cluster, and its children or emitter.
#[derive(Clone, Copy, Debug, Default)]
struct LightNode {
    bounds: LightBounds,
    /// Index of the first of two adjacent children, or an emitter index and `LEAF`.
    child_or_emitter: u32,
}

/// The light tree.
#[derive(Debug)]
pub(super) struct LightTree {
    /// The root; then, for every inner node, its two children, all descendants of the first and all
    /// descendants of the second.
    nodes: Vec<LightNode>,
    /// Leaf node of every emitter.
    leaves: Vec<u32>,
}

impl LightTree {
    /// Builds a tree over at least one emitter; emitter indices count from 0.
    pub(super) fn new(mut items: Vec<LightItem>) -> Self {
        let mut nodes = vec![LightNode::default(); 2 * items.len() - 1];
        let (root, descendants) = nodes.split_at_mut(1);
        root[0] = build_node(&mut items, 1, descendants);
        let mut leaves = vec![0; items.len()];
        for (index, node) in nodes.iter().enumerate() {
            if node.child_or_emitter & LEAF != 0 {
                leaves[(node.child_or_emitter ^ LEAF) as usize] = index as u32;
            }
        }
        Self { nodes, leaves }
    }

    /// Expected irradiance from all emitters.
    pub(super) fn importance(&self, ctx: &LightSampleContext) -> f64 {
        self.nodes[0].bounds.importance(ctx)
    }

    /// Sums `f` over clusters that cover all emitters, opening those that are not `small`.
    pub(super) fn sum_over(
        &self,
        small: impl Fn(&LightBounds) -> bool,
        f: impl Fn(&LightBounds) -> f64,
    ) -> f64 {
        let (mut pending, mut sum) = (vec![self.nodes[0]], 0.0);
        while let Some(node) = pending.pop() {
            if node.child_or_emitter & LEAF != 0 || small(&node.bounds) {
                sum += f(&node.bounds);
            } else {
                let first = node.child_or_emitter as usize;
                pending.extend_from_slice(&self.nodes[first..first + 2]);
            }
        }
        sum
    }

    /// Selects an emitter by `u` in `[0, 1)`; returns its index and probability.
    pub(super) fn sample(&self, ctx: &LightSampleContext, u: f64) -> Option<(u32, f64)> {
        self.sample_by(|bounds| bounds.importance(ctx), u)
    }

    /// Selects an emitter by the importance of clusters.
    pub(super) fn sample_by(
        &self,
        importance: impl Fn(&LightBounds) -> f64,
        mut u: f64,
    ) -> Option<(u32, f64)> {
        let mut next = self.nodes[0].child_or_emitter;
        let mut pmf = 1.0;
        while next & LEAF == 0 {
            let first = self.first_child_probability(&importance, next)?;
            if u < first {
                u /= first;
                pmf *= first;
                next = self.nodes[next as usize].child_or_emitter;
            } else {
                u = ((u - first) / (1.0 - first)).min(1.0 - f64::EPSILON);
                pmf *= 1.0 - first;
                next = self.nodes[next as usize + 1].child_or_emitter;
            }
        }
        Some((next ^ LEAF, pmf))
    }

    /// Returns the probability with which [`Self::sample`] selects an emitter.
    pub(super) fn pmf(&self, ctx: &LightSampleContext, emitter: u32) -> f64 {
        self.pmf_by(|bounds| bounds.importance(ctx), emitter)
    }

    /// Returns the probability with which [`Self::sample_by`] selects an emitter.
    pub(super) fn pmf_by(&self, importance: impl Fn(&LightBounds) -> f64, emitter: u32) -> f64 {
        let leaf = self.leaves[emitter as usize];
        let mut next = self.nodes[0].child_or_emitter;
        let mut pmf = 1.0;
        while next & LEAF == 0 {
            let Some(first) = self.first_child_probability(&importance, next) else {
                return 0.0;
            };
            let first = if fault!(LightTreePmfHalf) { 0.5 } else { first };
            let second = self.nodes[next as usize + 1];
            let is_in_second =
                second.child_or_emitter & LEAF == 0 && leaf >= second.child_or_emitter;
            if leaf == next + 1 || is_in_second {
                pmf *= 1.0 - first;
                next = second.child_or_emitter;
            } else {
                pmf *= first;
                next = self.nodes[next as usize].child_or_emitter;
            }
        }
        pmf
    }

    /// Returns the probability of the first of two children; `None` if neither can illuminate the
    /// shading point.
    fn first_child_probability(
        &self,
        importance: &impl Fn(&LightBounds) -> f64,
        children: u32,
    ) -> Option<f64> {
        let [first, second] = [0, 1].map(|i| importance(&self.nodes[children as usize + i].bounds));
        let total = first + second;
        (total > 0.0).then(|| first / total)
    }
}

/// Builds the node over some emitters. The nodes below it go into `descendants`, which begins at
/// index `start`.
fn build_node(items: &mut [LightItem], start: u32, descendants: &mut [LightNode]) -> LightNode {
    let cluster = LightBounds::enclosing(LightAabb::of_spheres(items).center(), items);
    if let [item] = items {
        return LightNode { bounds: cluster, child_or_emitter: item.emitter_index | LEAF };
    }
    let split = partition(items);
    let (first, second) = items.split_at_mut(split);
    let (children, descendants) = descendants.split_at_mut(2);
    let second_start = start + 2 * first.len() as u32;
    let (first_descendants, second_descendants) = descendants.split_at_mut(2 * first.len() - 2);
    let is_large = first.len() + second.len() > PARALLEL_MIN_LIGHTS;
    let mut build_first = || build_node(first, start + 2, first_descendants);
    let mut build_second = || build_node(second, second_start, second_descendants);
    let nodes = match is_large {
        true => rayon::join(build_first, build_second),
        false => (build_first(), build_second()),
    };
    children.copy_from_slice(&[nodes.0, nodes.1]);
    LightNode { bounds: cluster, child_or_emitter: start }
}

/// Moves the emitters of the first child to the front and returns their number: at least one, and
/// not all.
fn partition(items: &mut [LightItem]) -> usize {
    let centers = LightAabb::of_centers(items);
    let splits = (0..3).filter_map(|axis| best_split(items, axis, &centers));
    let Some(LightSplit { axis, bin, .. }) = splits.min_by(|a, b| a.cost.total_cmp(&b.cost)) else {
        return items.len() / 2; // all at the same position
    };
    let mut count = 0;
    for i in 0..items.len() {
        if centers.bin(axis, &items[i]) <= bin {
            items.swap(i, count);
            count += 1;
        }
    }
    count
}

/// A split plane, behind one of the bins.
struct LightSplit {
    axis: usize,
    bin: usize,
    cost: f64,
}

/// Finds the best split plane across an axis; `None` if all emitters are in one bin along it.
fn best_split(items: &[LightItem], axis: usize, centers: &LightAabb) -> Option<LightSplit> {
    let extent = centers.extent();
    if extent[axis] <= 0.0 {
        return None;
    }
    let mut bins = [Bin::EMPTY; BINS];
    for item in items {
        bins[centers.bin(axis, item)].add(item);
    }
    // Sweep from the right for the cost behind each plane, then from the left for the total cost.
    let mut right_costs = [0.0; BINS];
    let mut sum = Bin::EMPTY;
    for bin in (1..BINS).rev() {
        sum.merge(&bins[bin]);
        right_costs[bin - 1] = sum.cost();
    }
    let flatness = extent.max_element() / extent[axis];
    let mut sum = Bin::EMPTY;
    let costs = (0..BINS - 1).map(|bin| {
        sum.merge(&bins[bin]);
        LightSplit { axis, bin, cost: flatness * (sum.cost() + right_costs[bin]) }
    });
    costs.min_by(|a, b| a.cost.total_cmp(&b.cost))
}

/// An axis-aligned bounding box.
#[derive(Clone, Copy)]
struct LightAabb {
    min: DVec3,
    max: DVec3,
}

impl LightAabb {
    const EMPTY: Self =
        Self { min: DVec3::splat(f64::INFINITY), max: DVec3::splat(f64::NEG_INFINITY) };

    fn of_spheres(items: &[LightItem]) -> Self {
        items.iter().fold(Self::EMPTY, |bounds, item| bounds.extended(item, item.sphere.radius))
    }

    fn of_centers(items: &[LightItem]) -> Self {
        items.iter().fold(Self::EMPTY, |bounds, item| bounds.extended(item, 0.0))
    }

    fn extended(self, item: &LightItem, radius: f64) -> Self {
        let center = item.sphere.center;
        Self { min: self.min.min(center - radius), max: self.max.max(center + radius) }
    }

    fn center(&self) -> DVec3 {
        0.5 * (self.min + self.max)
    }

    fn extent(&self) -> DVec3 {
        self.max - self.min
    }

    /// Returns the bin along an axis that contains an emitter's centre.
    fn bin(&self, axis: usize, item: &LightItem) -> usize {
        let index = (item.sphere.center[axis] - self.min[axis]) / self.extent()[axis];
        ((index * BINS as f64) as usize).min(BINS - 1)
    }

    fn area(&self) -> f64 {
        let DVec3 { x, y, z } = self.extent();
        2.0 * (x * y + y * z + z * x)
    }
}

/// The emitters between two planes.
#[derive(Clone, Copy)]
struct Bin {
    bounds: LightAabb,
    power: f64,
}

impl Bin {
    const EMPTY: Self = Self { bounds: LightAabb::EMPTY, power: 0.0 };

    fn add(&mut self, item: &LightItem) {
        self.bounds = self.bounds.extended(item, item.sphere.radius);
        self.power += item.power;
    }

    fn merge(&mut self, other: &Self) {
        self.bounds.min = self.bounds.min.min(other.bounds.min);
        self.bounds.max = self.bounds.max.max(other.bounds.max);
        self.power += other.power;
    }

    /// Returns the cost of one side of a plane. The first and the last bin are never empty, so
    /// neither side is.
    fn cost(&self) -> f64 {
        self.power * self.bounds.area()
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{contexts, items};
    use super::*;

    #[test]
    fn the_probabilities_of_all_emitters_add_up_to_one() {
        for count in [1, 2, 3, 17, 1000] {
            let tree = LightTree::new(items(count));
            for ctx in contexts() {
                let sum: f64 = (0..count as u32).map(|emitter| tree.pmf(&ctx, emitter)).sum();
                // The sampling may end at a node whose emitters are all below the horizon.
                assert!(sum <= 1.0 + 1e-12);
                if ctx.is_two_sided {
                    assert!((sum - 1.0).abs() < 1e-12, "{count} emitters: {sum}");
                }
            }
        }
    }

    #[test]
    fn a_sample_says_the_probability_that_pmf_says() {
        let tree = LightTree::new(items(1000));
        for ctx in contexts() {
            for i in 0..1000 {
                let Some((emitter, pmf)) = tree.sample(&ctx, f64::from(i) / 1000.0) else {
                    continue;
                };
                assert_eq!(pmf, tree.pmf(&ctx, emitter));
                assert!(pmf > 0.0);
            }
        }
    }

    #[test]
    fn an_emitter_above_the_horizon_can_always_be_chosen() {
        let emitters = items(1000);
        let tree = LightTree::new(emitters.clone());
        for ctx in contexts() {
            for item in &emitters {
                let to_center = item.sphere.center - ctx.hit.point;
                let height = to_center.dot(ctx.hit.facing_normal()) + item.sphere.radius;
                if ctx.is_two_sided || height > 1e-9 {
                    assert!(tree.pmf(&ctx, item.emitter_index) > 0.0);
                }
            }
        }
    }

    #[test]
    fn the_tree_is_the_same_for_any_threads() {
        let build = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| format!("{:?}", LightTree::new(items(20_000))))
        };
        assert!(build(1) == build(3));
    }

    #[test]
    fn emitters_in_one_place_are_told_apart_by_number_alone() {
        let mut emitters = items(50);
        for item in &mut emitters {
            item.sphere.center = DVec3::ONE;
        }
        let tree = LightTree::new(emitters);
        let ctx = contexts().next().expect("some");
        assert!((0..50).all(|emitter| tree.pmf(&ctx, emitter) > 0.0));
    }
}
