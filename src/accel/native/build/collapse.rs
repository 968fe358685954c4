//! From a binary tree to one of eight children a node: which nodes of the binary tree stay.
//!
//! There are two ways. *Greedy* opens the child with the largest box until there are eight (Wald et
//! al. 2008, "Getting Rid of Packets"); it may leave nodes half empty. *Optimal* finds, by dynamic
//! programming from the leaves up, the cheapest of all ways to cut the binary tree (Ylitie et al.
//! 2017, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs"). What is cheap
//! is here the product of the time to trace, as the surface area heuristic has it, and of the
//! memory: near the greedy tree, with its time `T` and bytes `B`, a change of `T B` is one of
//! `t / T + b / B`, which is a sum over nodes and leaves. Of the two, the tree with the smaller product is
//! taken, so that the optimal way is never worse than the greedy one.

use crate::accel::native::node::{LEAF_SIZE, Leaf, LeafIds, Node, WIDTH};

use super::binary::{Binary, Part};

/// What a step through a node costs, for each ray that meets its box.
const NODE_TIME: f32 = 1.0;
/// What a step through a leaf costs.
const LEAF_TIME: f32 = 0.8;
const NODE_BYTES: f32 = size_of::<Node>() as f32;
const LEAF_BYTES: f32 = (size_of::<Leaf>() + size_of::<LeafIds>()) as f32;

/// What the leaves of the binary tree are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Leaves {
    /// Groups of spheres: nodes of up to eight may become leaves, which take time and memory.
    Spheres,
    /// Trees that are there already and cost what they cost.
    Trees,
}

/// How the binary tree is cut.
pub(super) struct Collapse<'a> {
    binary: &'a Binary,
    leaves: Leaves,
    /// Of the optimal way; empty for the greedy one.
    choices: Vec<Choice>,
}

/// The best way to cut a node into at most `n + 1` parts, for every `n`.
#[derive(Clone, Copy, Default)]
struct Choice {
    cost: [f32; WIDTH],
    /// How many of the parts are the left half's; 0 for the node as a whole. The last is how the
    /// node is cut into the children of a wide node.
    left: [u8; WIDTH],
}

/// Time and memory of a tree.
#[derive(Clone, Copy, Debug, Default)]
struct Price {
    time: f32,
    bytes: f32,
}

impl<'a> Collapse<'a> {
    /// The greedy way, or the optimal one where its product of time and memory is smaller.
    pub(super) fn best(binary: &'a Binary, leaves: Leaves) -> Self {
        let greedy = Self::greedy(binary, leaves);
        let price = greedy.price();
        let optimal = Self::optimal(binary, leaves, price);
        if optimal.price().product() < price.product() { optimal } else { greedy }
    }

    fn greedy(binary: &'a Binary, leaves: Leaves) -> Self {
        Self { binary, leaves, choices: Vec::new() }
    }

    fn optimal(binary: &'a Binary, leaves: Leaves, near: Price) -> Self {
        let mut collapse = Self { binary, leaves, choices: Vec::with_capacity(binary.nodes.len()) };
        for part in &binary.nodes {
            let choice = collapse.choice(part, near);
            collapse.choices.push(choice);
        }
        collapse
    }

    /// Whether the optimal way was taken.
    pub(super) fn is_optimal(&self) -> bool {
        !self.choices.is_empty()
    }

    /// Whether a node of the binary tree becomes a leaf.
    pub(super) fn is_leaf(&self, part: u32) -> bool {
        let node = &self.binary.nodes[part as usize];
        match (node.halves, self.choices.get(part as usize)) {
            (None, _) => true,
            (_, Some(choice)) => choice.left[WIDTH - 1] == 0,
            (Some(halves), None) => {
                self.may_be_leaf(node) && {
                    let [a, b] = halves.map(|half| self.area(half));
                    // Two leaves are better if most rays that meet the whole miss both.
                    2.0 * (a + b) >= node.bounds.half_area()
                }
            }
        }
    }

    /// The parts that are children of a node that is no leaf.
    pub(super) fn children(&self, part: u32) -> Children {
        let mut children = Children { parts: [0; WIDTH], count: 0 };
        if self.is_optimal() {
            let halves = self.binary.nodes[part as usize].halves.expect("no leaf");
            let left = self.choices[part as usize].left[WIDTH - 1];
            self.gather(halves[0], left, &mut children);
            self.gather(halves[1], WIDTH as u8 - left, &mut children);
        } else {
            children.open(0, self.binary.nodes[part as usize].halves.expect("no leaf"));
            while children.count < WIDTH {
                let inner = (0..children.count).filter(|&i| !self.is_leaf(children.parts[i]));
                let area = |i: &usize| self.area(children.parts[*i]);
                let Some(largest) = inner.max_by(|a, b| area(a).total_cmp(&area(b))) else { break };
                let halves = self.binary.nodes[children.parts[largest] as usize].halves;
                children.open(largest, halves.expect("no leaf"));
            }
        }
        children
    }

    /// Adds the best cut of a node into at most `most` parts.
    fn gather(&self, part: u32, most: u8, children: &mut Children) {
        let left = if most < 2 { 0 } else { self.choices[part as usize].left[most as usize - 2] };
        match self.binary.nodes[part as usize].halves {
            Some(halves) if left > 0 => {
                self.gather(halves[0], left, children);
                self.gather(halves[1], most - left, children);
            }
            _ => children.push(part),
        }
    }

    fn area(&self, part: u32) -> f32 {
        self.binary.nodes[part as usize].bounds.half_area()
    }

    fn may_be_leaf(&self, part: &Part) -> bool {
        self.leaves == Leaves::Spheres && part.count as usize <= LEAF_SIZE
    }

    fn leaf_price(&self, area: f32) -> Price {
        match self.leaves {
            Leaves::Spheres => Price { time: LEAF_TIME * area, bytes: LEAF_BYTES },
            Leaves::Trees => Price::default(),
        }
    }

    fn choice(&self, part: &Part, near: Price) -> Choice {
        let area = part.bounds.half_area();
        let as_leaf = self.leaf_price(area).near(near);
        let Some(halves) = part.halves else {
            return Choice { cost: [as_leaf; WIDTH], left: [0; WIDTH] };
        };
        let [a, b] = halves.map(|half| &self.choices[half as usize]);
        // The cheapest cut into exactly two parts and more.
        let mut cut = [(f32::INFINITY, 0u8); WIDTH + 1];
        for (parts, cut) in cut.iter_mut().enumerate().skip(2) {
            for left in 1..parts {
                let cost = a.cost[left - 1] + b.cost[parts - left - 1];
                if cost < cut.0 {
                    *cut = (cost, left as u8);
                }
            }
        }
        let as_node = Price { time: NODE_TIME * area, bytes: NODE_BYTES }.near(near) + cut[WIDTH].0;
        let is_leaf = self.may_be_leaf(part) && as_leaf <= as_node;
        let mut choice = Choice::default();
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

    /// Time and memory of the tree as cut.
    fn price(&self) -> Price {
        let mut price = Price::default();
        let mut ahead = vec![self.binary.root()];
        while let Some(part) = ahead.pop() {
            let area = self.area(part);
            if self.is_leaf(part) {
                price.add(self.leaf_price(area));
            } else {
                price.add(Price { time: NODE_TIME * area, bytes: NODE_BYTES });
                ahead.extend(self.children(part).as_slice());
            }
        }
        price
    }
}

/// Up to eight parts.
pub(super) struct Children {
    parts: [u32; WIDTH],
    count: usize,
}

impl Children {
    pub(super) fn as_slice(&self) -> &[u32] {
        &self.parts[..self.count]
    }

    fn push(&mut self, part: u32) {
        self.parts[self.count] = part;
        self.count += 1;
    }

    /// Puts the halves of a part in its place; into an empty list, just the halves.
    fn open(&mut self, place: usize, halves: [u32; 2]) {
        let kept = place + usize::from(self.count > 0);
        self.parts.copy_within(kept..self.count.max(kept), place + 2);
        self.parts[place..place + 2].copy_from_slice(&halves);
        self.count += if self.count > 0 { 1 } else { 2 };
    }
}

impl Price {
    fn product(self) -> f32 {
        self.time * self.bytes
    }

    fn add(&mut self, other: Self) {
        self.time += other.time;
        self.bytes += other.bytes;
    }

    /// What it adds to the product, near a tree of another price.
    fn near(self, other: Self) -> f32 {
        let share = |part: f32, of: f32| if of > 0.0 { part / of } else { 0.0 };
        share(self.time, other.time) + share(self.bytes, other.bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::super::split::Item;
    use super::*;

    /// Spheres in a row, ever farther apart: greedy opens the long end again and again.
    fn row(count: u32) -> Vec<Item> {
        let sphere = |i: u32| [1.02f32.powi(i as i32), 0.3 * (i % 7) as f32, 0.0, 0.2];
        (0..count).map(|id| Item { sphere: sphere(id), id }).collect()
    }

    #[test]
    fn the_optimal_way_is_taken_where_it_is_better_and_never_where_it_is_worse() {
        for count in [9, 20, 100, 1000] {
            let binary = Binary::shaped(&mut row(count));
            let greedy = Collapse::greedy(&binary, Leaves::Spheres).price();
            let best = Collapse::best(&binary, Leaves::Spheres);
            assert!(best.price().product() <= greedy.product(), "{count} spheres");
            assert_eq!(best.is_optimal(), best.price().product() < greedy.product());
        }
        assert!(Collapse::best(&Binary::shaped(&mut row(1000)), Leaves::Spheres).is_optimal());
    }

    #[test]
    fn opening_a_part_puts_its_halves_in_its_place() {
        let mut children = Children { parts: [0; WIDTH], count: 0 };
        children.open(0, [1, 2]);
        children.open(0, [3, 4]);
        children.open(1, [5, 6]);
        assert_eq!(children.as_slice(), [3, 5, 6, 2]);
    }
}
