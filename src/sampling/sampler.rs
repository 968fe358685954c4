//! Random numbers with addresses.
//!
//! Every number is a pure function of (seed, pixel, sample, dimension): threads, tiles, batches and
//! restarts cannot change it. A sample's address is hashed to a 64-bit key, and the dimensions are
//! the outputs of a SplitMix64 generator (Steele, Lea and Flood 2014, "Fast Splittable Pseudorandom
//! Number Generators", OOPSLA) started at that key, which can be read at any place.

/// The increment of SplitMix64: 2^64 divided by the golden ratio, made odd.
const GAMMA: u64 = 0x9e37_79b9_7f4a_7c15;

/// All the random numbers of one sample of one pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sampler {
    key: u64,
}

impl Sampler {
    /// The numbers at an address; `pixel` counts along the rows of the full picture.
    pub fn new(seed: u64, pixel: u64, sample: u32) -> Self {
        let key = mix(mix(mix(seed.wrapping_add(GAMMA)) ^ pixel) ^ u64::from(sample));
        Self { key }
    }

    /// The number of one dimension, in `[0, 1)`, a multiple of 2^-53.
    pub fn get(self, dimension: u32) -> f64 {
        let step = GAMMA.wrapping_mul(u64::from(dimension) + 1);
        (mix(self.key.wrapping_add(step)) >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
    }

    /// The numbers of two dimensions in a row.
    pub fn get_2d(self, dimension: u32) -> [f64; 2] {
        [self.get(dimension), self.get(dimension + 1)]
    }
}

/// The output function of SplitMix64: a bijection in which every input bit reaches every output bit
/// (Stafford's variant 13 of the MurmurHash3 finaliser).
fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_generator_is_splitmix64() {
        // The published first outputs for state 0.
        let sampler = Sampler { key: 0 };
        let expected = [0xe220_a839_7b1d_cdaf_u64, 0x6e78_9e6a_a1b9_65f4];
        for (dimension, bits) in expected.into_iter().enumerate() {
            let value = (bits >> 11) as f64 / (1u64 << 53) as f64;
            assert_eq!(sampler.get(dimension as u32), value);
        }
    }

    #[test]
    fn neighbouring_addresses_are_uncorrelated() {
        // Correlation of two independent uniform series of n numbers has standard deviation
        // 1 / sqrt(n); five of them are allowed (significance 6e-7 each).
        let n = 100_000u32;
        let series: [fn(u32) -> Sampler; 4] = [
            |i| Sampler::new(0, u64::from(i), 0),
            |i| Sampler::new(0, u64::from(i) + 1, 0),
            |i| Sampler::new(0, u64::from(i), 1),
            |i| Sampler::new(1, u64::from(i), 0),
        ];
        for other in &series[1..] {
            let dot: f64 =
                (0..n).map(|i| (series[0](i).get(0) - 0.5) * (other(i).get(0) - 0.5)).sum();
            assert!((12.0 * dot / f64::from(n)).abs() < 5.0 / f64::from(n).sqrt());
        }
        let dot: f64 =
            (0..n).map(|i| (series[0](i).get(0) - 0.5) * (series[0](i).get(1) - 0.5)).sum();
        assert!((12.0 * dot / f64::from(n)).abs() < 5.0 / f64::from(n).sqrt());
    }
}
