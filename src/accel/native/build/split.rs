//! Splits a group of spheres with the binned surface area heuristic.
//!
//! Wald 2007, "On fast Construction of SAH-based Bounding Volume Hierarchies": the centres are
//! sorted into equal bins along each axis, and the cheapest plane between bins is chosen.

use super::aabb::Aabb;

/// A sphere during the build.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::accel::native) struct PrimRef {
    /// `[x, y, z, radius]`.
    pub(in crate::accel::native) sphere: [f32; 4],
    pub(in crate::accel::native) id: u32,
}

/// A split: the first `index` primitives, and the rest.
pub(super) struct Split {
    pub(super) index: usize,
    pub(super) bounds: [Aabb; 2],
}

/// Groups of this size are not split further, and the heuristic counts spheres in such groups.
pub(super) const SAH_BLOCK_SIZE: usize = 4;
/// Maximum number of bins along an axis; fewer for few primitives.
const MAX_BINS: usize = 16;

/// The bounds of the primitives.
pub(super) fn bounds_of(items: &[PrimRef]) -> Aabb {
    let around = |sum: Aabb, item: &PrimRef| sum.union(&Aabb::from_sphere(&item.sphere));
    items.iter().fold(Aabb::EMPTY, around)
}

fn center_bounds(items: &[PrimRef]) -> Aabb {
    let around = |sum: Aabb, item: &PrimRef| sum.union(&Aabb::from_point(&item.sphere));
    items.iter().fold(Aabb::EMPTY, around)
}

/// Splits two or more primitives with the heuristic, and reorders them.
pub(super) fn split_sah(items: &mut [PrimRef]) -> Split {
    let bins = if items.len() <= 2 * MAX_BINS { MAX_BINS / 2 } else { MAX_BINS };
    let binning = BinMapping::new(&center_bounds(items), bins);
    match Bins::new(items, &binning).best_split(bins) {
        Some(plane) => {
            let mid = partition(items, |item| binning.bin(item, plane.axis) < plane.bin);
            Split { index: mid, bounds: plane.bounds }
        }
        None => split_median(items),
    }
}

/// Splits the primitives in halves along the longest extent of their centres, or by radius if the
/// centres coincide.
pub(super) fn split_median(items: &mut [PrimRef]) -> Split {
    let centers = center_bounds(items);
    let extent = |axis: usize| centers.high[axis] - centers.low[axis];
    let longest = (0..4).rev().filter(|&axis| axis < 3).fold(3, |best, axis| {
        if extent(axis) > 0.0 && (best == 3 || extent(axis) >= extent(best)) { axis } else { best }
    });
    let mid = items.len() / 2;
    items.select_nth_unstable_by(mid, |a, b| {
        a.sphere[longest].total_cmp(&b.sphere[longest]).then(a.id.cmp(&b.id))
    });
    let (left, right) = items.split_at(mid);
    Split { index: mid, bounds: [bounds_of(left), bounds_of(right)] }
}

/// Returns the index of the first Morton code that has the highest differing bit set; the middle if
/// all codes are equal. The codes are sorted.
pub(super) fn morton_split(codes: &[u64]) -> usize {
    let (first, last) = (codes[0], codes[codes.len() - 1]);
    let differing = first ^ last;
    if differing == 0 {
        return codes.len() / 2;
    }
    let bit = 1u64 << differing.ilog2();
    codes.partition_point(|code| code & bit == 0)
}

/// The heuristic's cost of testing `count` spheres in a box, in units of area.
fn sah_cost(count: u32, bounds: &Aabb) -> f32 {
    count.div_ceil(SAH_BLOCK_SIZE as u32) as f32 * bounds.half_area()
}

/// Maps centres to bins.
struct BinMapping {
    low: [f32; 4],
    scale: [f32; 4],
    last: u32,
}

impl BinMapping {
    fn new(centers: &Aabb, bins: usize) -> Self {
        let mut scale = [0.0; 4];
        for (axis, scale) in scale.iter_mut().enumerate() {
            *scale = bins as f32 / (centers.high[axis] - centers.low[axis]);
        }
        Self { low: centers.low, scale, last: bins as u32 - 1 }
    }

    /// The bin along an axis. If the extent is zero, the position is undefined, and the saturating
    /// cast puts NaN into bin 0.
    #[inline(always)]
    fn bin(&self, item: &PrimRef, axis: usize) -> usize {
        let position = (item.sphere[axis] - self.low[axis]) * self.scale[axis];
        (position as u32).min(self.last) as usize
    }
}

/// Counts and bounds of the bins along the three axes.
struct Bins {
    count: [[u32; MAX_BINS]; 3],
    bounds: [[Aabb; MAX_BINS]; 3],
}

/// A plane between two bins.
struct SplitPlane {
    axis: usize,
    /// The first bin of the right side.
    bin: usize,
    cost: f32,
    bounds: [Aabb; 2],
}

impl Bins {
    fn new(items: &[PrimRef], binning: &BinMapping) -> Self {
        let mut filled = Self { count: [[0; MAX_BINS]; 3], bounds: [[Aabb::EMPTY; MAX_BINS]; 3] };
        for item in items {
            let bounds = Aabb::from_sphere(&item.sphere);
            for axis in 0..3 {
                let bin = binning.bin(item, axis);
                filled.count[axis][bin] += 1;
                filled.bounds[axis][bin] = filled.bounds[axis][bin].union(&bounds);
            }
        }
        filled
    }

    /// The cheapest plane with primitives on both sides.
    fn best_split(&self, bins: usize) -> Option<SplitPlane> {
        let mut best: Option<SplitPlane> = None;
        for axis in 0..3 {
            let (counts, boxes) = (&self.count[axis][..bins], &self.bounds[axis][..bins]);
            let mut from_right = [(0, Aabb::EMPTY); MAX_BINS];
            let mut sum = (0, Aabb::EMPTY);
            for bin in (1..bins).rev() {
                sum = (sum.0 + counts[bin], sum.1.union(&boxes[bin]));
                from_right[bin] = sum;
            }
            let mut left = (0, Aabb::EMPTY);
            for bin in 1..bins {
                left = (left.0 + counts[bin - 1], left.1.union(&boxes[bin - 1]));
                let right = &from_right[bin];
                // Next to an empty bin, the next plane gives the same split.
                if left.0 == 0 || right.0 == 0 || counts[bin] == 0 {
                    continue;
                }
                let cost = sah_cost(left.0, &left.1) + sah_cost(right.0, &right.1);
                if best.as_ref().is_none_or(|best| cost < best.cost) {
                    best = Some(SplitPlane { axis, bin, cost, bounds: [left.1, right.1] });
                }
            }
        }
        best
    }
}

/// Moves the primitives of the left side to the front; returns their count.
fn partition(items: &mut [PrimRef], is_left: impl Fn(&PrimRef) -> bool) -> usize {
    let (mut mid, mut end) = (0, items.len());
    while mid < end {
        if is_left(&items[mid]) {
            mid += 1;
        } else {
            end -= 1;
            items.swap(mid, end);
        }
    }
    mid
}

#[cfg(test)]
mod tests {
    use super::*;

    fn item(x: f32, radius: f32, id: u32) -> PrimRef {
        PrimRef { sphere: [x, 0.0, 0.0, radius], id }
    }

    #[test]
    fn two_distant_groups_are_cut_apart() {
        let mut items: Vec<_> = (0..20)
            .map(|id| item(if id % 2 == 0 { 0.0 } else { 100.0 } + id as f32 * 0.1, 0.1, id))
            .collect();
        let cut = split_sah(&mut items);
        assert_eq!(cut.index, 10);
        assert!(items[..10].iter().all(|item| item.id % 2 == 0));
        assert_eq!(cut.bounds, [bounds_of(&items[..10]), bounds_of(&items[10..])]);
    }

    #[test]
    fn equal_centres_are_halved_by_radius() {
        let mut items: Vec<_> =
            (0..12).map(|id| item(7.0, 1.0 + (id * 5 % 12) as f32, id)).collect();
        let cut = split_sah(&mut items);
        assert_eq!(cut.index, 6);
        assert!(items[..6].iter().all(|item| item.sphere[3] <= 6.0));
    }

    #[test]
    fn a_curve_is_cut_where_its_highest_bit_changes() {
        assert_eq!(morton_split(&[0b0001, 0b0010, 0b0011, 0b1000]), 3);
        assert_eq!(morton_split(&[0b1001, 0b1010, 0b1011, 0b1011]), 1);
        assert_eq!(morton_split(&[5; 6]), 3);
    }
}
