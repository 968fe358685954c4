//! Which random number of a sample serves what.
//!
//! Numbers come in sets of four that are spread evenly together, and what decides together how bright
//! a sample is shares a set: the place in the pixel with the direction from there to a light, and
//! the direction of a path's next edge with the direction to a light at its end.
//! `docs/sampling.md` has the table, and the measurements behind it.

/// The place in the pixel: two dimensions.
pub(super) const PIXEL: u32 = 0;

/// The place on the lens: two dimensions.
pub(super) const LENS: u32 = 4;

/// The place in the pixel, and then that on the lens, when a camera ray is drawn again for the n-th
/// time: four dimensions.
pub(super) fn camera_retry(n: u32) -> u32 {
    (1 << 31) + 4 * n
}

/// The direction from the BSDF at the end of edge number `depth`, where the first numbers for it are
/// used up: two dimensions. They lie far away, since most surfaces never ask for them.
pub(super) fn bsdf_extra(depth: u32) -> u32 {
    (3 << 30) + 4 * depth
}

/// Whether a surface is there that a path meets at the end of edge number `depth`, after it went
/// straight through `passthroughs` others in all.
pub(super) fn opacity(depth: u32, passthroughs: u32) -> u32 {
    if passthroughs == 0 {
        return VertexDimensions::at(depth).opacity();
    }
    // Both are below 10 000.
    (1 << 30) + 10_000 * depth + passthroughs
}

/// The dimensions of the vertex at the end of a path's edge number `depth`, counted from 1.
#[derive(Clone, Copy)]
pub(super) struct VertexDimensions {
    base: u32,
}

impl VertexDimensions {
    /// Dimensions set aside for each vertex.
    const STRIDE: u32 = 8;

    /// `depth` counts from 1. Lanes that nobody uses may have any; their numbers are of no account.
    pub(super) fn at(depth: u32) -> Self {
        Self { base: Self::STRIDE.wrapping_mul(depth) }
    }

    /// The direction towards a light: two dimensions, in one set with the direction of the edge that
    /// ends here, or with the place in the pixel.
    pub(super) fn light_direction(self) -> u32 {
        self.base.wrapping_sub(Self::STRIDE - 2)
    }

    /// The direction from the BSDF: two dimensions.
    pub(super) fn bsdf_direction(self) -> u32 {
        self.base
    }

    /// Which lobe of the BSDF.
    pub(super) fn lobe(self) -> u32 {
        self.base + 4
    }

    /// Whether the path goes on.
    pub(super) fn roulette(self) -> u32 {
        self.base + 5
    }

    /// Which light.
    pub(super) fn light_selection(self) -> u32 {
        self.base + 6
    }

    /// Whether the surface is there.
    fn opacity(self) -> u32 {
        self.base + 7
    }
}
