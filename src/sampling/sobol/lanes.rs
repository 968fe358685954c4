//! Sobol numbers of many samples in lanes, as loops that compile to vector instructions.

use super::directions::direction_number;
use super::{SET_SIZE, Sobol, point_index, scrambled_coordinate};
use crate::math::{LANES, Lanes};

/// Sobol samplers in lanes.
#[derive(Clone, Copy, Debug, Default)]
pub struct SobolLanes {
    key: Lanes<u64>,
    /// Sample index, bit-reversed.
    sample: Lanes<u32>,
    /// The selected set; the bit-reversed index of its point follows.
    set: Lanes<u32>,
    index: Lanes<u32>,
}

impl SobolLanes {
    /// Number of dimensions in a set.
    pub const SET_SIZE: u32 = SET_SIZE;

    /// Starts a sample of a pixel in every lane.
    #[inline(always)]
    pub fn start_pixel_samples(
        &mut self,
        seed: u64,
        pixel: impl Fn(usize) -> u64,
        sample: impl Fn(usize) -> u32,
    ) {
        for lane in 0..LANES {
            let Sobol { key, sample } = Sobol::new(seed, pixel(lane), sample(lane));
            self.key.0[lane] = key;
            self.sample.0[lane] = sample;
        }
    }

    /// Returns the sampler of a lane.
    #[inline(always)]
    pub(in crate::sampling) fn lane(&self, lane: usize) -> Sobol {
        Sobol { key: self.key.0[lane], sample: self.sample.0[lane] }
    }

    /// Stores a sampler in a lane.
    #[inline(always)]
    pub(in crate::sampling) fn set_lane(&mut self, lane: usize, Sobol { key, sample }: Sobol) {
        self.key.0[lane] = key;
        self.sample.0[lane] = sample;
    }

    /// Selects a set of four dimensions in every lane, beginning with dimension `4 set`.
    #[inline(always)]
    pub fn select_set(&mut self, set: impl Fn(usize) -> u32) {
        for lane in 0..LANES {
            self.set.0[lane] = set(lane);
            self.index.0[lane] =
                point_index(self.key.0[lane], self.sample.0[lane], self.set.0[lane]);
        }
    }

    /// Writes the numbers of one dimension of the set, 0 to 3, to `numbers`.
    #[inline(always)]
    pub fn get(&self, dimension: u32, numbers: &mut Lanes<f64>) {
        let points = self.points(dimension);
        for lane in 0..LANES {
            let dimension = 4 * self.set.0[lane] + dimension;
            numbers.0[lane] = scrambled_coordinate(points.0[lane], self.key.0[lane], dimension);
        }
    }

    /// Returns a dimension of the sequence's points: the contributions of each index bit that is
    /// set in any lane.
    #[inline(always)]
    fn points(&self, dimension: u32) -> Lanes<u32> {
        let mut points = Lanes::default();
        let mut used = self.index.0.iter().fold(0, |used, index| used | index);
        while used != 0 {
            let bit = 31 - used.leading_zeros();
            used ^= 1 << bit;
            let direction = direction_number(dimension, bit);
            for lane in 0..LANES {
                points.0[lane] ^= direction & 0u32.wrapping_sub(self.index.0[lane] >> bit & 1);
            }
        }
        points
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_lane_reads_the_numbers_of_its_own_sample() {
        let pixel = |lane: usize| 1000 + 7 * lane as u64;
        // Indices of few bits and of many.
        for samples in [[0u32; LANES], std::array::from_fn(|lane| 1 << (4 * lane as u32 % 32))] {
            let mut lanes = SobolLanes::default();
            lanes.start_pixel_samples(5, pixel, |lane| samples[lane] + lane as u32);
            let one = |lane: usize| Sobol::new(5, pixel(lane), samples[lane] + lane as u32);
            let set = |lane: usize| 3 * (lane as u32 % 3);
            lanes.select_set(set);
            for dimension in 0..SET_SIZE {
                let mut numbers = Lanes::default();
                lanes.get(dimension, &mut numbers);
                for (lane, number) in numbers.0.into_iter().enumerate() {
                    assert_eq!(
                        number,
                        one(lane).get(SET_SIZE * set(lane) + dimension),
                        "lane {lane}"
                    );
                    assert_eq!(lanes.lane(lane), one(lane));
                }
            }
            lanes.set_lane(1, one(2));
            assert_eq!([0, 1, 2].map(|lane| lanes.lane(lane)), [0, 2, 2].map(one));
        }
    }
}
