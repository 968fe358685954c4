//! One ray through the tree.

use crate::fault::fault;
use crate::geometry::Sphere;
use crate::math::{DVec3, Hit, NO_SPHERE, Ray};

use super::build::{STACK_SIZE, Tree};
use super::node::{Child, each_lane};
use super::slabs::Slabs;

/// One ray in f64, and the best hit so far.
pub(super) struct Query {
    pub(super) origin: DVec3,
    pub(super) direction: DVec3,
    pub(super) t_min: f64,
    exclude: [u32; 2],
    /// Distance of the best hit so far; at first, the ray's end.
    pub(super) t: f64,
    /// The sphere hit, or [`NO_SPHERE`].
    id: u32,
}

/// What a query is about.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Goal {
    /// The first hit along the ray.
    Closest,
    /// Whatever hit is found first.
    Any,
}

/// The parts of the tree that a ray has yet to visit, the nearest on top; used again for each ray
/// of a batch.
pub(super) struct Stack {
    /// The bits of the distance, which order as it does since it is not negative; and the child.
    entries: [(u32, Child); STACK_SIZE],
    len: usize,
}

impl Query {
    /// `None` for a ray that is not valid, and so hits nothing.
    pub(super) fn new(ray: &Ray) -> Option<Self> {
        let (origin, direction) = (ray.origin_f64(), ray.direction_f64());
        let (t_min, t) = (f64::from(ray.t_min), f64::from(ray.t_max));
        let query = Self { origin, direction, t_min, exclude: ray.exclude, t, id: NO_SPHERE };
        ray.is_valid().then_some(query)
    }

    /// Takes the sphere's hit if it is better: nearer, or as near and of a smaller id.
    #[inline(always)]
    pub(super) fn offer(&mut self, id: u32, sphere: &Sphere) {
        let root = sphere.first_root(self.origin, self.direction, self.t_min, f64::INFINITY);
        let Some(t) = root else { return };
        let better = t < self.t
            || fault!(NotTheNearest)
            || (t == self.t && id < self.id && self.id != NO_SPHERE);
        if better && !self.exclude.contains(&id) {
            self.t = t;
            self.id = id;
        }
    }

    pub(super) fn has_hit(&self) -> bool {
        self.id != NO_SPHERE
    }

    pub(super) fn hit(&self) -> Hit {
        if self.has_hit() { Hit { t: self.t as f32, id: self.id } } else { Hit::MISS }
    }

    pub(super) fn reaches(&self, goal: Goal) -> bool {
        goal == Goal::Any && self.has_hit()
    }
}

impl Stack {
    pub(super) fn new() -> Self {
        Self { entries: [(0, Child::node(0)); STACK_SIZE], len: 0 }
    }

    fn push(&mut self, t: f32, child: Child) {
        self.entries[self.len] = (t.to_bits(), child);
        self.len += 1;
    }

    /// Sorts the last `count` entries so that the nearest is on top.
    fn sort_top(&mut self, count: usize) {
        let top = &mut self.entries[self.len - count..self.len];
        for sorted in 1..top.len() {
            let entry = top[sorted];
            let mut place = sorted;
            while place > 0 && top[place - 1].0 < entry.0 {
                top[place] = top[place - 1];
                place -= 1;
            }
            top[place] = entry;
        }
    }

    /// The next child that is entered before `limit`.
    fn pop(&mut self, limit: f32) -> Option<Child> {
        while self.len > 0 {
            self.len -= 1;
            let (t, child) = self.entries[self.len];
            let limit = if fault!(PrunedTooEarly) { 0.9 * limit } else { limit };
            if f32::from_bits(t) <= limit {
                return Some(child);
            }
        }
        None
    }
}

impl Tree {
    /// Offers the query every sphere that may be better than what it has.
    pub(super) fn trace(&self, query: &mut Query, goal: Goal, stack: &mut Stack) {
        let length = query.direction.length();
        let Some(root) = self.root.filter(|_| length > 0.0) else { return };
        let unit = query.direction / length;
        let slabs = Slabs::new(query.origin, unit, length, query.t_min);
        let mut limit = slabs.limit(query.t);
        stack.len = 0;
        stack.push(0.0, root);
        while let Some(child) = stack.pop(limit) {
            if child.is_leaf() {
                self.offer_leaf(child.index(), unit, query);
                if query.reaches(goal) {
                    return;
                }
                limit = slabs.limit(query.t);
                continue;
            }
            let node = &self.nodes[child.index()];
            let met = slabs.meet(node, limit);
            each_lane(met.lanes).for_each(|lane| stack.push(met.t[lane], node.children[lane]));
            stack.sort_top(met.lanes.count_ones() as usize);
        }
    }

    #[inline(always)]
    fn offer_leaf(&self, index: usize, unit: DVec3, query: &mut Query) {
        let (leaf, ids) = (&self.leaves[index], &self.ids[index]);
        for lane in each_lane(leaf.candidates(query.origin, unit)) {
            query.offer(ids[lane], &leaf.sphere(lane));
        }
    }
}
