//! Numbers of many paths side by side, field by field, for loops that become vector instructions.

use super::DVec3;

/// So many paths go through a stage together.
pub const LANES: usize = 32;

/// A number of every lane.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct Lanes<T>(pub [T; LANES]);

/// A vector of every lane.
#[derive(Clone, Copy, Debug, Default)]
pub struct Lanes3 {
    x: Lanes<f64>,
    y: Lanes<f64>,
    z: Lanes<f64>,
}

impl<T: Copy> Lanes<T> {
    /// The same in all lanes.
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
    /// The vector of a lane.
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
