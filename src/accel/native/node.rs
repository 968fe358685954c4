//! Nodes with the boxes of eight children, and leaves of eight spheres. Both are stored lane by
//! lane so that the compiler vectorises loops over them.

use crate::geometry::Sphere;
use crate::math::{DVec3, NO_SPHERE};

use super::build::{Aabb, PrimRef};

/// Children of a node.
pub(super) const WIDTH: usize = 8;
/// Maximum number of spheres in a leaf.
pub(super) const LEAF_SIZE: usize = 8;

/// How far f64 arithmetic may move a surface, relative to the operands: 4 times the bound derived
/// in [`BvhNode::set_child`].
pub(super) const F64_BOX_SLACK: f64 = 1.0 / (1u64 << 44) as f64;
/// Relative enlargement of a box: 8 roundings to f32.
const F32_BOX_SLACK: f64 = 1.0 / (1u32 << 21) as f64;
/// Absolute slack, 2^-90, for numbers that underflow and so have no relative bound.
pub(super) const ABSOLUTE_SLACK: f64 = f32::from_bits((127 - 90) << 23) as f64;

/// A reference to a node or a leaf.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct NodeRef(pub(super) u32);

/// Up to eight boxes and their contents, 256 bytes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub(super) struct BvhNode {
    /// Planes of the boxes: low x, y, z, then high x, y, z; an unused lane has an inverted box.
    pub(super) planes: [[f32; WIDTH]; 6],
    pub(super) children: [NodeRef; WIDTH],
}

/// Up to eight spheres. The radius of an unused lane is NaN, so comparisons with it are false.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct SphereLeaf {
    pub(super) x: [f32; LEAF_SIZE],
    pub(super) y: [f32; LEAF_SIZE],
    pub(super) z: [f32; LEAF_SIZE],
    pub(super) radius: [f32; LEAF_SIZE],
}

/// The ids of a leaf's spheres, stored apart because few are ever read.
pub(super) type LeafIds = [u32; LEAF_SIZE];

impl NodeRef {
    const LEAF_BIT: u32 = 1 << 31;
    /// Neither a node nor a leaf.
    pub(super) const NONE: Self = Self(u32::MAX);
    /// The maximum index of a node or leaf.
    pub(super) const MAX_INDEX: usize = Self::LEAF_BIT as usize - 1;

    pub(super) fn node(index: usize) -> Self {
        Self(index as u32)
    }

    pub(super) fn leaf(index: usize) -> Self {
        Self(index as u32 | Self::LEAF_BIT)
    }

    /// The reference after this many nodes and leaves are inserted before it.
    pub(super) fn offset_by(self, nodes: usize, leaves: usize) -> Self {
        let places = if self.is_leaf() { leaves } else { nodes };
        Self(self.0.wrapping_add(places as u32))
    }

    #[inline(always)]
    pub(super) fn is_leaf(self) -> bool {
        self.0 & Self::LEAF_BIT != 0
    }

    #[inline(always)]
    pub(super) fn index(self) -> usize {
        (self.0 & !Self::LEAF_BIT) as usize
    }
}

impl BvhNode {
    pub(super) const EMPTY: Self = Self {
        planes: {
            let (low, high) = ([f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]);
            [low, low, low, high, high, high]
        },
        children: [NodeRef(0); WIDTH],
    };

    /// Sets one child and its box, enlarged so that no hit is lost.
    ///
    /// Let `t` be a root that [`Sphere::first_root`] returns for a sphere `(c, R)` of this child.
    /// The test rounds `o - c`, the closest approach and the squared distances, each to 2^-53 of
    /// its value, so `|o + t d - c|` exceeds `R` by at most `2^-48 (|o - c| + R)` (this holds at
    /// grazing incidence too: there the error of `t` runs along the surface). With `|v|` for the
    /// largest coordinate of `v`, and `B` for the largest of the box, `|c| + R <= B` and this is
    /// less than `2^-46 (|o| + B)`. The part with `B` is added here, 4 times over, and the part
    /// with `|o|` is added to the ray's origin (`kernel::ray_state`). `bounds` was rounded to f32
    /// once and is rounded again here: of the 8 roundings added, the ray's arithmetic needs less
    /// than 4, see there.
    pub(super) fn set_child(&mut self, lane: usize, bounds: &Aabb, child: NodeRef) {
        let everywhere = F64_BOX_SLACK * f64::from(bounds.max_abs()) + ABSOLUTE_SLACK;
        let slack = |plane: f32| F32_BOX_SLACK * f64::from(plane.abs()) + everywhere;
        for axis in 0..3 {
            let (low, high) = (bounds.low[axis], bounds.high[axis]);
            self.planes[axis][lane] = (f64::from(low) - slack(low)) as f32;
            self.planes[axis + 3][lane] = (f64::from(high) + slack(high)) as f32;
        }
        self.children[lane] = child;
    }
}

impl SphereLeaf {
    /// The leaf of up to eight spheres.
    pub(super) fn from_prims(items: &[PrimRef]) -> Self {
        let lanes = |lane: usize, unused: f32| {
            let mut values = [unused; LEAF_SIZE];
            values.iter_mut().zip(items).for_each(|(value, item)| *value = item.sphere[lane]);
            values
        };
        Self { x: lanes(0, 0.0), y: lanes(1, 0.0), z: lanes(2, 0.0), radius: lanes(3, f32::NAN) }
    }

    /// The ids for [`Self::from_prims`].
    pub(super) fn prim_ids(items: &[PrimRef]) -> LeafIds {
        let mut ids = [NO_SPHERE; LEAF_SIZE];
        ids.iter_mut().zip(items).for_each(|(id, item)| *id = item.id);
        ids
    }

    #[inline(always)]
    pub(super) fn sphere(&self, lane: usize) -> Sphere {
        let center = DVec3::new(self.x[lane].into(), self.y[lane].into(), self.z[lane].into());
        Sphere { center, radius: self.radius[lane].into() }
    }
}

/// The indices of the bits that are set.
#[inline(always)]
pub(super) fn mask_lanes(mut lanes: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = lanes.trailing_zeros() as usize;
        lanes &= lanes.wrapping_sub(1);
        (lane < u32::BITS as usize).then_some(lane)
    })
}
