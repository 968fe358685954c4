//! Which random number of a sample serves what.

/// The place in the pixel: two dimensions.
pub(super) const PIXEL: u32 = 0;

/// The place in the pixel when a camera ray is drawn again, for the n-th time.
pub(super) fn redraw(n: u32) -> u32 {
    (1 << 31) + 2 * n
}

/// The dimensions of the vertex at the end of a path's edge number `depth`, counted from 1.
#[derive(Clone, Copy)]
pub(super) struct Vertex {
    base: u32,
}

impl Vertex {
    /// Dimensions set aside for each vertex.
    const COUNT: u32 = 8;
    /// The camera takes what lies below.
    const FIRST: u32 = 4;

    pub(super) fn at(depth: u32) -> Self {
        Self { base: Self::FIRST + Self::COUNT * (depth - 1) }
    }

    /// Which lobe of the BSDF.
    pub(super) fn lobe(self) -> u32 {
        self.base
    }

    /// The direction from the BSDF: two dimensions.
    pub(super) fn direction(self) -> u32 {
        self.base + 1
    }

    /// Which lamp.
    pub(super) fn lamp(self) -> u32 {
        self.base + 3
    }

    /// The direction towards the lamp: two dimensions.
    pub(super) fn towards_lamp(self) -> u32 {
        self.base + 4
    }

    /// Whether the path goes on.
    pub(super) fn roulette(self) -> u32 {
        self.base + 6
    }
}
