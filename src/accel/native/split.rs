//! Where to cut a group of spheres in two: the surface area heuristic over bins.
//!
//! Wald 2007, "On fast Construction of SAH-based Bounding Volume Hierarchies": the centres fall
//! into 16 equal bins along each axis, and the cheapest of the 45 planes between bins is taken.
//! Bins hold only counts and boxes, so any order of filling them gives the same bits.

use rayon::prelude::*;

use super::bounds::Bounds;
use super::node::LEAF_SIZE;

/// A sphere on its way into a leaf.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Item {
    /// `[x, y, z, radius]`.
    pub(super) sphere: [f32; 4],
    pub(super) id: u32,
}

/// The two sides of a cut: the first `at` items, and the rest.
pub(super) struct Cut {
    pub(super) at: usize,
    pub(super) bounds: [Bounds; 2],
}

const BINS: usize = 16;
/// Spheres of a leaf are tested in groups, which the heuristic counts.
const GROUP: usize = 4;
/// From here on a group of items is surveyed by several threads.
const PARALLEL: usize = 1 << 16;

/// The box around the items.
pub(super) fn bounds_of(items: &[Item]) -> Bounds {
    survey(items, |item| Bounds::of_sphere(&item.sphere))
}

/// Cuts the items where the heuristic says so, and reorders them; `None` where they had better be
/// one leaf. More than [`LEAF_SIZE`] items are always cut.
pub(super) fn cut(items: &mut [Item], bounds: &Bounds) -> Option<Cut> {
    if items.len() <= GROUP {
        return None;
    }
    let centers = survey(items, |item| Bounds::of_point(&item.sphere));
    let binning = Binning::new(&centers);
    let best = Bins::of(items, &binning).best_plane();
    let must = items.len() > LEAF_SIZE;
    match best {
        Some(plane) if must || plane.saves(bounds) => {
            let at = partition(items, |item| binning.bin(item, plane.axis) < plane.bin);
            Some(Cut { at, bounds: plane.bounds })
        }
        None if must => Some(halve(items)),
        _ => None,
    }
}

/// Cuts the items into halves along the longest extent of their centres, or by radius where the
/// centres coincide.
pub(super) fn halve(items: &mut [Item]) -> Cut {
    let centers = survey(items, |item| Bounds::of_point(&item.sphere));
    let extent = |axis: usize| centers.high[axis] - centers.low[axis];
    let longest = (0..4).rev().filter(|&axis| axis < 3).fold(3, |best, axis| {
        if extent(axis) > 0.0 && (best == 3 || extent(axis) >= extent(best)) { axis } else { best }
    });
    let at = items.len() / 2;
    items.select_nth_unstable_by(at, |a, b| {
        a.sphere[longest].total_cmp(&b.sphere[longest]).then(a.id.cmp(&b.id))
    });
    let (left, right) = items.split_at(at);
    Cut { at, bounds: [bounds_of(left), bounds_of(right)] }
}

fn survey(items: &[Item], bounds: impl Fn(&Item) -> Bounds + Sync) -> Bounds {
    let serial =
        |items: &[Item]| items.iter().fold(Bounds::EMPTY, |sum, item| sum.join(&bounds(item)));
    if items.len() < PARALLEL {
        return serial(items);
    }
    items.par_chunks(PARALLEL / 4).map(serial).reduce(|| Bounds::EMPTY, |a, b| a.join(&b))
}

/// The heuristic's cost of testing `count` spheres in a box, in units of area.
fn cost(count: usize, bounds: &Bounds) -> f64 {
    count.div_ceil(GROUP) as f64 * bounds.half_area()
}

/// Which bin a centre falls into.
struct Binning {
    low: [f32; 4],
    scale: [f32; 4],
}

impl Binning {
    fn new(centers: &Bounds) -> Self {
        let mut scale = [0.0; 4];
        for (axis, scale) in scale.iter_mut().enumerate() {
            *scale = BINS as f32 / (centers.high[axis] - centers.low[axis]);
        }
        Self { low: centers.low, scale }
    }

    /// The bin along an axis. Without extent along it, the position is undefined, and the
    /// saturating cast puts NaN into bin 0.
    #[inline(always)]
    fn bin(&self, item: &Item, axis: usize) -> usize {
        let position = (item.sphere[axis] - self.low[axis]) * self.scale[axis];
        (position as usize).min(BINS - 1)
    }
}

/// Counts and boxes of the bins along the three axes.
struct Bins {
    count: [[u32; BINS]; 3],
    bounds: [[Bounds; BINS]; 3],
}

/// A plane between two bins.
struct Plane {
    axis: usize,
    /// The first bin of the right side.
    bin: usize,
    cost: f64,
    bounds: [Bounds; 2],
}

impl Plane {
    /// Whether two leaves are better than one: most rays that meet the whole must miss both.
    fn saves(&self, whole: &Bounds) -> bool {
        let [left, right] = &self.bounds;
        2.0 * (left.half_area() + right.half_area()) < whole.half_area()
    }
}

impl Bins {
    const EMPTY: Self = Self { count: [[0; BINS]; 3], bounds: [[Bounds::EMPTY; BINS]; 3] };

    fn of(items: &[Item], binning: &Binning) -> Self {
        if items.len() < PARALLEL {
            return Self::serially(items, binning);
        }
        let chunks = items.par_chunks(PARALLEL / 4);
        chunks.map(|chunk| Self::serially(chunk, binning)).reduce(|| Self::EMPTY, Self::join)
    }

    fn serially(items: &[Item], binning: &Binning) -> Self {
        let mut filled = Self::EMPTY;
        for item in items {
            let bounds = Bounds::of_sphere(&item.sphere);
            for axis in 0..3 {
                let bin = binning.bin(item, axis);
                filled.count[axis][bin] += 1;
                filled.bounds[axis][bin] = filled.bounds[axis][bin].join(&bounds);
            }
        }
        filled
    }

    fn join(mut self, other: Self) -> Self {
        for axis in 0..3 {
            for bin in 0..BINS {
                self.count[axis][bin] += other.count[axis][bin];
                self.bounds[axis][bin] = self.bounds[axis][bin].join(&other.bounds[axis][bin]);
            }
        }
        self
    }

    /// The cheapest plane with something on both sides.
    fn best_plane(&self) -> Option<Plane> {
        let mut best: Option<Plane> = None;
        for axis in 0..3 {
            let from_right = self.sums_from_right(axis);
            let (mut count, mut bounds) = (0, Bounds::EMPTY);
            for (bin, &(right_count, right)) in from_right.iter().enumerate() {
                if bin > 0 {
                    count += self.count[axis][bin - 1] as usize;
                    bounds = bounds.join(&self.bounds[axis][bin - 1]);
                }
                if count == 0 || right_count == 0 {
                    continue;
                }
                let cost = cost(count, &bounds) + cost(right_count, &right);
                if best.as_ref().is_none_or(|best| cost < best.cost) {
                    best = Some(Plane { axis, bin, cost, bounds: [bounds, right] });
                }
            }
        }
        best
    }

    /// Count and box of all bins from each one on.
    fn sums_from_right(&self, axis: usize) -> [(usize, Bounds); BINS] {
        let mut sums = [(0, Bounds::EMPTY); BINS];
        let (mut count, mut bounds) = (0, Bounds::EMPTY);
        for bin in (0..BINS).rev() {
            count += self.count[axis][bin] as usize;
            bounds = bounds.join(&self.bounds[axis][bin]);
            sums[bin] = (count, bounds);
        }
        sums
    }
}

/// Moves the items of the left side to the front; returns how many there are.
fn partition(items: &mut [Item], is_left: impl Fn(&Item) -> bool) -> usize {
    let (mut at, mut end) = (0, items.len());
    while at < end {
        if is_left(&items[at]) {
            at += 1;
        } else {
            end -= 1;
            items.swap(at, end);
        }
    }
    at
}

#[cfg(test)]
mod tests {
    use super::*;

    fn item(x: f32, radius: f32, id: u32) -> Item {
        Item { sphere: [x, 0.0, 0.0, radius], id }
    }

    #[test]
    fn two_distant_groups_are_cut_apart() {
        let mut items: Vec<_> = (0..20)
            .map(|id| item(if id % 2 == 0 { 0.0 } else { 100.0 } + id as f32 * 0.1, 0.1, id))
            .collect();
        let cut = cut(&mut items, &Bounds::EMPTY).expect("too many for a leaf");
        assert_eq!(cut.at, 10);
        assert!(items[..10].iter().all(|item| item.id % 2 == 0));
        assert_eq!(cut.bounds, [bounds_of(&items[..10]), bounds_of(&items[10..])]);
    }

    #[test]
    fn equal_centres_are_halved_by_radius() {
        let mut items: Vec<_> =
            (0..12).map(|id| item(7.0, 1.0 + (id * 5 % 12) as f32, id)).collect();
        let bounds = bounds_of(&items);
        let cut = cut(&mut items, &bounds).expect("too many for a leaf");
        assert_eq!(cut.at, 6);
        assert!(items[..6].iter().all(|item| item.sphere[3] <= 6.0));
    }

    #[test]
    fn a_few_spheres_in_one_place_are_one_leaf() {
        let mut items: Vec<_> = (0..8).map(|id| item(id as f32 * 0.1, 10.0, id)).collect();
        let bounds = bounds_of(&items);
        assert!(cut(&mut items, &bounds).is_none());
    }
}
