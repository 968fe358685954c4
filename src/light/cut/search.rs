//! The search for the opaque spheres that cut emitters.

use std::cmp::Ordering;
use std::ops::ControlFlow;

use rayon::prelude::*;

use crate::geometry::{Side, Sphere, SphereCut, SphereSet};

use super::super::emitter::Emitter;
use super::super::sphere_tree::{PendingRange, SphereBounds, SphereTree};

/// Emitters of which a wall leaves more than this share of the surface are treated as whole.
const MAX_EXPOSED: f64 = 0.75;
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
    fn key(&self) -> (u32, u8) {
        (self.emitter, self.side as u8)
    }

    /// Cuts of one emitter from one side are adjacent, and the one that hides most comes first.
    fn order(a: &Self, b: &Self) -> Ordering {
        a.key().cmp(&b.key()).then(a.height.total_cmp(&b.height)).then(a.id.cmp(&b.id))
    }
}

/// Finds the cut that hides most of each emitter from each side, sorted by emitter and side. The
/// result does not depend on the thread count.
pub(super) fn largest_cuts(
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
                    let cut = SphereCut::new(sphere, &opaque).filter(|_| is_opaque(id));
                    found.extend(cut.into_iter().flat_map(|cut| by_side(emitter, id, &cut)));
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

/// Calls `test` with every emitter whose surface `opaque` may cut and that is not larger, until the
/// budget of tests is used up.
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
            if sphere.radius <= opaque.radius {
                test(emitter, sphere);
            }
            ControlFlow::Continue(())
        },
    );
}

/// Returns false if `opaque` cuts no emitter within the bounds: `|d - R| < r` for none of them, or
/// all are larger.
#[inline]
fn may_be_cut(bounds: &SphereBounds, opaque: &Sphere) -> bool {
    let [smallest, largest] = bounds.radii;
    let [nearest, farthest] = bounds.distances_squared(opaque.center);
    let reach = opaque.radius + largest;
    let hollow = (opaque.radius - largest).max(0.0);
    nearest <= reach * reach && farthest >= hollow * hollow && smallest <= opaque.radius
}

/// The cut as seen from each side from which it hides enough.
fn by_side(emitter: u32, id: u32, cut: &SphereCut) -> impl Iterator<Item = FoundCut> + use<> {
    let found = [Side::Outside, Side::Inside].map(|side| FoundCut {
        emitter,
        side,
        height: cut.height(side),
        id,
    });
    found.into_iter().filter(|found| found.height <= 2.0 * MAX_EXPOSED)
}

fn keep_first(mut found: Vec<FoundCut>) -> Vec<FoundCut> {
    found.sort_unstable_by(FoundCut::order);
    found.dedup_by_key(|found| found.key());
    found
}
