//! Allocation of a sample's random dimensions.
//!
//! Dimensions come in sets of four that are jointly stratified. Decisions that jointly affect a
//! sample's brightness share a set: the pixel position with the light direction at the first hit,
//! and the direction of a path's next edge with the light direction at its end. `docs/sampling.md`
//! has the table and the measurements behind it.

/// Pixel position: two dimensions.
pub(super) const PIXEL: u32 = 0;

/// Lens position: two dimensions.
pub(super) const LENS: u32 = 4;

/// Pixel position, then lens position, of the n-th retry of a camera ray: four dimensions.
pub(super) fn camera_retry(n: u32) -> u32 {
    (1 << 31) + 4 * n
}

/// Extra dimensions for BSDF sampling at the end of edge `depth`, used when the first pair is
/// consumed: two dimensions. Placed far away, since most surfaces never need them.
pub(super) fn bsdf_extra(depth: u32) -> u32 {
    (3 << 30) + 4 * depth
}

/// What a shadow catcher needs for its candidates and to choose among them: four dimensions.
pub(super) const SHADOW_CATCHER: u32 = 6 << 29;

/// The opacity test at the end of edge `depth`, after `passthroughs` surfaces were passed straight
/// through.
pub(super) fn opacity(depth: u32, passthroughs: u32) -> u32 {
    if passthroughs == 0 {
        return VertexDimensions::at(depth).opacity();
    }
    // Both are below 10 000.
    (1 << 30) + 10_000 * depth + passthroughs
}

/// Connection to the n-th pair of a ball and a light from the vertex at the end of edge `depth`:
/// two dimensions for the point of the light. Those of the first pair also have two for the choice
/// of pairs, [`VertexDimensions::connection_choice`].
pub(super) fn connection(depth: u32, n: u32) -> u32 {
    // The depth is below 10 000, n below 8. Unused lanes may pass any depth.
    32u32.wrapping_mul(depth).wrapping_add((7 << 29) + 4 * n)
}

/// The choice of a light for a ball that was chosen from many, of the vertex at the end of edge
/// `depth`. One pair is connected then, so that the second one's dimensions are free.
pub(super) fn connection_light(depth: u32) -> u32 {
    connection(depth, 1)
}

/// The dimensions of the vertex at the end of edge `depth`, counted from 1.
#[derive(Clone, Copy)]
pub(super) struct VertexDimensions {
    base: u32,
}

impl VertexDimensions {
    /// Dimensions reserved per vertex.
    const STRIDE: u32 = 8;

    /// Returns the dimensions of the vertex at `depth`, counted from 1. Unused lanes may pass any
    /// value; their numbers are ignored.
    pub(super) fn at(depth: u32) -> Self {
        Self { base: Self::STRIDE.wrapping_mul(depth) }
    }

    /// Light direction: two dimensions, in one set with the direction of the edge that ends here,
    /// or with the pixel position.
    pub(super) fn light_direction(self) -> u32 {
        self.base.wrapping_sub(Self::STRIDE - 2)
    }

    /// BSDF direction: two dimensions.
    pub(super) fn bsdf_direction(self) -> u32 {
        self.base
    }

    /// Selection of the BSDF lobe.
    pub(super) fn lobe(self) -> u32 {
        self.base + 4
    }

    /// Russian roulette.
    pub(super) fn roulette(self) -> u32 {
        self.base + 5
    }

    /// Light selection.
    pub(super) fn light_selection(self) -> u32 {
        self.base + 6
    }

    /// Choice of the pairs of a ball and a light: two dimensions.
    pub(super) fn connection_choice(self) -> u32 {
        connection(self.base / Self::STRIDE, 0) + 2
    }

    /// Opacity test.
    fn opacity(self) -> u32 {
        self.base + 7
    }
}
