//! Lanes: data of many paths, stored field by field, for loops that compile to vector instructions.

use super::DVec3;

/// Number of paths that go through a stage together.
pub const LANES: usize = 32;

/// A scalar for every lane.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct Lanes<T>(pub [T; LANES]);

/// A vector for every lane.
#[derive(Clone, Copy, Debug, Default)]
pub struct Lanes3 {
    x: Lanes<f64>,
    y: Lanes<f64>,
    z: Lanes<f64>,
}

impl<T: Copy> Lanes<T> {
    /// Sets all lanes to the same value.
    pub fn splat(value: T) -> Self {
        Self([value; LANES])
    }
}

impl<T: Copy + Default> Default for Lanes<T> {
    fn default() -> Self {
        Self::splat(T::default())
    }
}

impl Lanes3 {
    /// Returns the vector of a lane.
    #[inline(always)]
    pub fn get(&self, lane: usize) -> DVec3 {
        DVec3::new(self.x.0[lane], self.y.0[lane], self.z.0[lane])
    }

    /// Sets the vector of a lane.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, v: DVec3) {
        self.x.0[lane] = v.x;
        self.y.0[lane] = v.y;
        self.z.0[lane] = v.z;
    }
}
