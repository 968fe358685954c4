//! Addressable random numbers.
//!
//! Every number is a pure function of (seed, pixel, sample, dimension): threads, tiles, batches and
//! restarts cannot change it. There are three kinds; `docs/sampling.md` compares them.

use crate::names::named_enum;

use super::independent::Independent;
use super::sobol::{Sobol, SobolLanes};
use super::stratified::Stratified;

/// The kind of random numbers for a pixel's samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SamplerKind {
    /// Sobol sequence, scrambled per pixel: well distributed after any number of samples.
    #[default]
    Sobol,
    /// Independent numbers.
    Independent,
    /// Stratified: one number in each of as many cells as there are samples.
    Stratified,
}

named_enum! { SamplerKind { Sobol = "sobol", Independent = "independent", Stratified = "stratified" } }

impl SamplerKind {
    /// Returns true if all numbers depend on the pixel's total sample count.
    pub fn depends_on_sample_count(self) -> bool {
        match self {
            Self::Sobol | Self::Independent => false,
            Self::Stratified => true,
        }
    }
}

/// The random numbers of one sample of one pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sampler(SamplerState);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum SamplerState {
    Independent(Independent),
    Sobol(Sobol),
    Stratified(Stratified),
}

/// The largest f64 below 1.
const BELOW_ONE: f64 = 1.0 - f64::EPSILON / 2.0;

impl Sampler {
    /// Creates independent numbers at an address; `pixel` counts row by row in the full picture.
    pub fn independent(seed: u64, pixel: u64, sample: u32) -> Self {
        Self(SamplerState::Independent(Independent::new(seed, pixel, sample)))
    }

    /// Creates numbers of any kind at an address. Only stratified ones depend on `samples`, the
    /// pixel's total sample count; they are best if exactly that many samples are taken.
    pub fn with_kind(kind: SamplerKind, seed: u64, pixel: u64, sample: u32, samples: u32) -> Self {
        match kind {
            SamplerKind::Sobol => Self(SamplerState::Sobol(Sobol::new(seed, pixel, sample))),
            SamplerKind::Independent => Self::independent(seed, pixel, sample),
            SamplerKind::Stratified => {
                Self(SamplerState::Stratified(Stratified::new(seed, pixel, sample, samples)))
            }
        }
    }

    /// Returns the sampler of a lane.
    #[inline(always)]
    pub fn from_lane(lanes: &SobolLanes, lane: usize) -> Self {
        Self(SamplerState::Sobol(lanes.lane(lane)))
    }

    /// Stores this sampler in a lane; returns false if it is not a Sobol sampler.
    #[inline(always)]
    pub fn store_in_lane(self, lanes: &mut SobolLanes, lane: usize) -> bool {
        match self.0 {
            SamplerState::Sobol(sampler) => {
                lanes.set_lane(lane, sampler);
                true
            }
            _ => false,
        }
    }

    /// Returns the number of one dimension, in `[0, 1)`.
    pub fn get(self, dimension: u32) -> f64 {
        match self.0 {
            SamplerState::Independent(sampler) => sampler.get(dimension),
            SamplerState::Sobol(sampler) => sampler.get(dimension),
            SamplerState::Stratified(sampler) => {
                sampler.pair(dimension / 2)[dimension as usize % 2].min(BELOW_ONE)
            }
        }
    }

    /// Returns the numbers of two consecutive dimensions. If the first one is even, they are
    /// jointly stratified over the square.
    pub fn get_2d(self, dimension: u32) -> [f64; 2] {
        match self.0 {
            SamplerState::Sobol(sampler) if dimension % 2 == 0 => sampler.get_2d(dimension),
            SamplerState::Stratified(sampler) if dimension % 2 == 0 => {
                sampler.pair(dimension / 2).map(|u| u.min(BELOW_ONE))
            }
            _ => [self.get(dimension), self.get(dimension + 1)],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const KINDS: [SamplerKind; 3] =
        [SamplerKind::Sobol, SamplerKind::Independent, SamplerKind::Stratified];

    #[test]
    fn between_the_largest_number_and_one_there_is_none() {
        assert_eq!(BELOW_ONE.to_bits() + 1, 1f64.to_bits());
    }

    #[test]
    fn the_kinds_whose_numbers_depend_on_their_count_say_so() {
        for kind in KINDS {
            let differ =
                Sampler::with_kind(kind, 1, 2, 3, 16) != Sampler::with_kind(kind, 1, 2, 3, 40);
            assert_eq!(kind.depends_on_sample_count(), differ, "{kind:?}");
        }
    }

    #[test]
    fn only_numbers_of_sobol_go_into_lanes_and_they_come_back() {
        for kind in KINDS {
            let mut lanes = SobolLanes::default();
            let sampler = Sampler::with_kind(kind, 1, 2, 3, 16);
            assert_eq!(sampler.store_in_lane(&mut lanes, 5), kind == SamplerKind::Sobol);
            assert_eq!(Sampler::from_lane(&lanes, 5) == sampler, kind == SamplerKind::Sobol);
        }
    }
}
