//! A digital sequence, scrambled independently for every pixel: Sobol's in construction, with
//! better matrices for four dimensions.
//!
//! Sample `i` of a pixel is point `i` of the sequence, so any aligned block of 2^k samples is well
//! distributed, and further samples continue the sequence, up to 2^32. Dimensions come in sets of
//! four. Every set uses the same four dimensions of the sequence, with the index shuffled and each
//! dimension scrambled anew (Burley 2020, section 4): dimensions of one set are jointly stratified,
//! and those of different sets are independent.

mod directions;
mod lanes;
mod scramble;

pub use lanes::SobolLanes;

use super::independent::{pixel_key, split_mix};
use directions::reversed_point;
use scramble::{scramble_reversed, shuffle_reversed};

/// Number of jointly stratified dimensions.
const SET_SIZE: u32 = 4;

/// The random numbers of one sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Sobol {
    key: u64,
    /// Sample index, bit-reversed.
    sample: u32,
}

impl Sobol {
    #[inline(always)]
    pub(super) fn new(seed: u64, pixel: u64, sample: u32) -> Self {
        Self { key: pixel_key(seed, pixel), sample: sample.reverse_bits() }
    }

    pub(super) fn get(self, dimension: u32) -> f64 {
        self.coordinate(self.index(dimension), dimension)
    }

    /// Returns the numbers of two dimensions of one set.
    pub(super) fn get_2d(self, dimension: u32) -> [f64; 2] {
        let index = self.index(dimension);
        [self.coordinate(index, dimension), self.coordinate(index, dimension + 1)]
    }

    /// Returns the bit-reversed index of the point for the set of a dimension.
    fn index(self, dimension: u32) -> u32 {
        point_index(self.key, self.sample, dimension / SET_SIZE)
    }

    fn coordinate(self, index: u32, dimension: u32) -> f64 {
        let point = reversed_point(index, (dimension % SET_SIZE) as usize);
        scrambled_coordinate(point, self.key, dimension)
    }
}

/// Returns the bit-reversed index of the point for a set.
#[inline(always)]
fn point_index(key: u64, reversed_sample: u32, set: u32) -> u32 {
    shuffle_reversed(reversed_sample, split_mix(!key, set))
}

/// Returns a scrambled coordinate of a point: the middle of a cell of 2^-32, so never 0 and never
/// 1.
#[inline(always)]
fn scrambled_coordinate(reversed_point: u32, key: u64, dimension: u32) -> f64 {
    let scrambled = scramble_reversed(reversed_point, split_mix(key, dimension)).reverse_bits();
    (f64::from(scrambled) + 0.5) * (1.0 / (1u64 << 32) as f64)
}
