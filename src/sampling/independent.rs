//! Independent random numbers: a sample's address is hashed to a 64-bit key, and the dimensions are
//! the outputs of a SplitMix64 generator (Steele, Lea and Flood 2014, "Fast Splittable Pseudorandom
//! Number Generators", OOPSLA) started at that key, which allows random access.

/// The increment of SplitMix64: 2^64 divided by the golden ratio, made odd.
pub(super) const GAMMA: u64 = 0x9e37_79b9_7f4a_7c15;

/// Independent random numbers of one sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Independent {
    key: u64,
}

impl Independent {
    pub(super) fn new(seed: u64, pixel: u64, sample: u32) -> Self {
        Self { key: mix_bits(pixel_key(seed, pixel) ^ u64::from(sample)) }
    }

    /// Returns a number in `[0, 1)`, a multiple of 2^-53.
    pub(super) fn get(self, dimension: u32) -> f64 {
        (split_mix(self.key, dimension) >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
    }
}

/// Hashes a seed and a pixel to a 64-bit key.
#[inline(always)]
pub(super) fn pixel_key(seed: u64, pixel: u64) -> u64 {
    mix_bits(mix_bits(seed.wrapping_add(GAMMA)) ^ pixel)
}

/// Returns output `index` of the generator that starts at `key`.
#[inline(always)]
pub(super) fn split_mix(key: u64, index: u32) -> u64 {
    mix_bits(key.wrapping_add(GAMMA.wrapping_mul(u64::from(index) + 1)))
}

/// The output function of SplitMix64: a bijection in which every input bit reaches every output bit
/// (Stafford's variant 13 of the MurmurHash3 finaliser).
#[inline(always)]
fn mix_bits(mut z: u64) -> u64 {
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
        let expected = [0xe220_a839_7b1d_cdaf_u64, 0x6e78_9e6a_a1b9_65f4];
        for (index, bits) in expected.into_iter().enumerate() {
            assert_eq!(split_mix(0, index as u32), bits);
        }
    }
}
