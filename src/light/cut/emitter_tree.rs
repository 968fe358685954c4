//! A tree over the emitters: finds those whose surface a sphere cuts.

use crate::geometry::Sphere;
use crate::math::DVec3;

/// Maximum number of emitters in a leaf.
const MAX_LEAF: usize = 4;

/// A bounding-box tree over the centres of emitters, without pointers: a range of the sorted
/// emitters is split in the middle.
pub(super) struct EmitterTree {
    /// Emitters with their index, sorted along the tree.
    emitters: Vec<(Sphere, u32)>,
    /// In depth-first order; the second child of a node follows all nodes of the first.
    nodes: Vec<Node>,
}

/// A range still to be visited: its node, its first emitter and their number.
pub(super) type PendingRange = (usize, usize, usize);

/// The bounds of a range of emitters.
#[derive(Clone, Copy)]
struct Node {
    /// Bounds of the centres.
    min: DVec3,
    max: DVec3,
    /// Bounds of the radii.
    radii: [f64; 2],
    /// Number of nodes in this subtree.
    size: u32,
}

impl EmitterTree {
    /// Builds the tree over emitters, whose indices count from 0.
    pub(super) fn new(emitters: impl Iterator<Item = Sphere>) -> Self {
        let mut emitters: Vec<_> = emitters.zip(0..).collect();
        let mut nodes = Vec::new();
        build(&mut emitters, &mut nodes);
        Self { emitters, nodes }
    }

    /// Calls `test` with every emitter whose surface `opaque` may cut and that is not larger, until
    /// the budget of tests is used up. `pending` is scratch space.
    #[inline]
    pub(super) fn for_each_cut(
        &self,
        opaque: &Sphere,
        budget: &mut usize,
        pending: &mut Vec<PendingRange>,
        mut test: impl FnMut(u32, &Sphere),
    ) {
        let (mut node, mut first, mut count) = (0, 0, self.emitters.len());
        pending.clear();
        loop {
            if count > 0 && self.nodes[node].may_be_cut_by(opaque) {
                if count > MAX_LEAF {
                    let half = count / 2;
                    let second = node + 1 + self.nodes[node + 1].size as usize;
                    pending.push((second, first + half, count - half));
                    (node, count) = (node + 1, half);
                    continue;
                }
                for (emitter, index) in &self.emitters[first..first + count] {
                    if *budget == 0 {
                        return;
                    }
                    *budget -= 1;
                    if emitter.radius <= opaque.radius {
                        test(*index, emitter);
                    }
                }
            }
            let Some(next) = pending.pop() else { return };
            (node, first, count) = next;
        }
    }
}

impl Node {
    /// Returns false if `opaque` cuts no emitter in the node: `|d - R| < r` for none of them, or
    /// all are larger.
    #[inline]
    fn may_be_cut_by(&self, opaque: &Sphere) -> bool {
        let Self { min, max, radii: [smallest, largest], .. } = *self;
        let center = opaque.center;
        let nearest = (min - center).max(center - max).max(DVec3::ZERO).length_squared();
        let farthest = (max - center).max(center - min).length_squared();
        let reach = opaque.radius + largest;
        let hollow = (opaque.radius - largest).max(0.0);
        nearest <= reach * reach && farthest >= hollow * hollow && smallest <= opaque.radius
    }
}

/// Sorts a range of emitters into a subtree and returns its number of nodes.
fn build(emitters: &mut [(Sphere, u32)], nodes: &mut Vec<Node>) -> u32 {
    let mut node = Node {
        min: DVec3::INFINITY,
        max: DVec3::NEG_INFINITY,
        radii: [f64::INFINITY, 0.0],
        size: 1,
    };
    for (Sphere { center, radius }, _) in emitters.iter() {
        (node.min, node.max) = (node.min.min(*center), node.max.max(*center));
        node.radii = [node.radii[0].min(*radius), node.radii[1].max(*radius)];
    }
    let index = nodes.len();
    nodes.push(node);
    if emitters.len() > MAX_LEAF {
        let extent = node.max - node.min;
        let axis = (0..3).max_by(|&a, &b| extent[a].total_cmp(&extent[b])).unwrap_or(0);
        let half = emitters.len() / 2;
        let key = |(sphere, index): &(Sphere, u32)| (sphere.center[axis], *index);
        emitters.select_nth_unstable_by(half, |a, b| {
            let ((a, i), (b, j)) = (key(a), key(b));
            a.total_cmp(&b).then(i.cmp(&j))
        });
        let (first, second) = emitters.split_at_mut(half);
        nodes[index].size += build(first, nodes) + build(second, nodes);
    }
    nodes[index].size
}
