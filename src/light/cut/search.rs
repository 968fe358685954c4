//! The search for the opaque spheres that cut emitters.

use std::cmp::Ordering;
use std::ops::ControlFlow;

use rayon::prelude::*;

use crate::geometry::{Side, Sphere, SphereCut, SphereSet};

use super::super::emitter::Emitter;
use super::super::sphere_tree::{PendingRange, SphereBounds, SphereTree};
use super::enclosure::Enclosure;

/// Emitters of which a wall leaves more than this share of the surface are treated as whole.
const MAX_EXPOSED: f64 = 0.75;
/// A sphere hides a quarter of an emitter from outside only if its radius is at least this many
/// times that of the emitter: half the square root of 3, rounded down.
const MIN_RADIUS: f64 = 0.866;
/// The maximum number of enclosures that are searched: the smallest ones, which hide most.
const MAX_ENCLOSURES: usize = 64;
/// Number of spheres that are searched in one go.
const CHUNK: u32 = 4096;
/// In one go, the maximum number of emitters tested for each sphere on average. What a chunk would
/// find beyond that is not found: where so many spheres overlap, this only costs variance.
const MAX_TESTS_PER_SPHERE: usize = 256;

/// The cut that hides most of an emitter from one side.
#[derive(Clone, Copy, Debug)]
pub(super) struct FoundCut {
    /// Index of the emitter.
    pub(super) emitter: u32,
    /// The side of the opaque sphere.
    pub(super) side: Side,
    /// Height of the cap that is exposed on that side, in radii.
    height: f64,
    /// Id of the opaque sphere.
    pub(super) id: u32,
}

impl FoundCut {
    /// Returns the cut by an opaque sphere with its id, as seen from one side; `None` if it hides
    /// little.
    fn new(
        emitter: u32,
        sphere: &Sphere,
        (id, opaque): (u32, &Sphere),
        side: Side,
    ) -> Option<Self> {
        let height = SphereCut::new(sphere, opaque)?.height(side);
        (height <= 2.0 * MAX_EXPOSED).then_some(Self { emitter, side, height, id })
    }

    fn key(&self) -> (u32, u8) {
        (self.emitter, self.side as u8)
    }

    /// Cuts of one emitter from one side are adjacent, and the one that hides most comes first.
    fn order(a: &Self, b: &Self) -> Ordering {
        a.key().cmp(&b.key()).then(a.height.total_cmp(&b.height)).then(a.id.cmp(&b.id))
    }
}

/// Finds the cut that hides most of each emitter from outside the opaque spheres, sorted by
/// emitter. The result does not depend on the thread count.
pub(super) fn outside_cuts(
    emitters: &[Emitter],
    spheres: &SphereSet,
    is_opaque: &(impl Fn(u32) -> bool + Sync),
) -> Vec<FoundCut> {
    if emitters.is_empty() {
        return Vec::new();
    }
    let tree = SphereTree::new(emitters.iter().map(|emitter| spheres.sphere(emitter.id)));
    let count = spheres.len() as u32;
    let chunk = |index: u32| {
        let first = index * CHUNK;
        let ids = first..(first + CHUNK).min(count);
        let mut budget = MAX_TESTS_PER_SPHERE * CHUNK as usize + 4 * emitters.len();
        let (mut found, mut pending) = (Vec::new(), Vec::new());
        for id in ids {
            let opaque = spheres.sphere(id);
            for_each_cut(&tree, &opaque, &mut budget, &mut pending, |emitter, sphere| {
                if emitters[emitter as usize].id != id {
                    let cut = FoundCut::new(emitter, sphere, (id, &opaque), Side::Outside);
                    found.extend(cut.filter(|_| is_opaque(id)));
                }
            });
        }
        keep_first(found)
    };
    let merge = |mut a: Vec<FoundCut>, b: Vec<FoundCut>| {
        if b.is_empty() {
            return a;
        }
        a.extend(b);
        keep_first(a)
    };
    (0..count.div_ceil(CHUNK)).into_par_iter().map(chunk).reduce(Vec::new, merge)
}

/// Finds the cut that hides most of each emitter from inside the enclosures, sorted by emitter.
///
/// Spheres of any size count: from inside, one that is smaller than an emitter hides more of it
/// than a large one. Only the few spheres that points can be inside of are searched, so the time is
/// proportional to the number of emitters.
pub(super) fn inside_cuts(
    emitters: &[Emitter],
    spheres: &SphereSet,
    enclosures: &[Enclosure],
) -> Vec<FoundCut> {
    let mut walls: Vec<(u32, Sphere)> =
        enclosures.iter().map(|enclosure| (enclosure.id, spheres.sphere(enclosure.id))).collect();
    walls.sort_by(|(_, a), (_, b)| a.radius.total_cmp(&b.radius));
    walls.truncate(MAX_ENCLOSURES);
    if walls.is_empty() {
        return Vec::new();
    }
    let largest = |(emitter, &Emitter { id, .. }): (usize, &Emitter)| {
        let sphere = spheres.sphere(id);
        let others = walls.iter().filter(|(wall, _)| *wall != id);
        let cut = |(wall, opaque): &(u32, Sphere)| {
            FoundCut::new(emitter as u32, &sphere, (*wall, opaque), Side::Inside)
        };
        others.filter_map(cut).min_by(FoundCut::order)
    };
    emitters.par_iter().enumerate().filter_map(largest).collect()
}

/// Calls `test` with every emitter whose surface `opaque` may cut so that much of it is hidden from
/// outside, until the budget of tests is used up.
#[inline]
fn for_each_cut(
    tree: &SphereTree,
    opaque: &Sphere,
    budget: &mut usize,
    pending: &mut Vec<PendingRange>,
    mut test: impl FnMut(u32, &Sphere),
) {
    tree.visit(
        pending,
        |bounds| may_be_cut(bounds, opaque),
        |emitter, sphere| {
            if *budget == 0 {
                return ControlFlow::Break(());
            }
            *budget -= 1;
            if MIN_RADIUS * sphere.radius <= opaque.radius {
                test(emitter, sphere);
            }
            ControlFlow::Continue(())
        },
    );
}

/// Returns false if `opaque` cuts no emitter within the bounds: `|d - R| < r` for none of them, or
/// all are too large for it to hide much.
#[inline]
fn may_be_cut(bounds: &SphereBounds, opaque: &Sphere) -> bool {
    let [smallest, largest] = bounds.radii;
    let [nearest, farthest] = bounds.distances_squared(opaque.center);
    let reach = opaque.radius + largest;
    let hollow = (opaque.radius - largest).max(0.0);
    nearest <= reach * reach
        && farthest >= hollow * hollow
        && MIN_RADIUS * smallest <= opaque.radius
}

fn keep_first(mut found: Vec<FoundCut>) -> Vec<FoundCut> {
    found.sort_unstable_by(FoundCut::order);
    found.dedup_by_key(|found| found.key());
    found
}
