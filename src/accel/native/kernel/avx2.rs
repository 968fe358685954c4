//! Eight lanes in the AVX2 and FMA instructions of x86-64.

use std::arch::x86_64::*;

use super::simd::Simd8;
use super::x86::{shared_operations, smallest};

/// AVX2 with FMA.
pub(super) struct Avx2;

/// For each set of lanes, their indices in order, one per byte.
static COMPRESS_TABLE: [u64; 256] = {
    let mut places = [0; 256];
    let mut bits = 0;
    while bits < 256 {
        let (mut lane, mut count) = (0, 0);
        while lane < 8 {
            if bits >> lane & 1 == 1 {
                places[bits] |= (lane as u64) << (8 * count);
                count += 1;
            }
            lane += 1;
        }
        bits += 1;
    }
    places
};

/// Permutes the lanes of each half by `ORDER`, two bits per lane.
macro_rules! swapped {
    ($keys:expr, $order:literal) => {
        _mm256_shuffle_epi32::<$order>($keys)
    };
}

/// Moves the larger of each pair of lanes to where `BLEND` has a bit, and the smaller to its
/// partner. `partners` holds the swapped lanes.
macro_rules! compare_and_swap {
    ($keys:expr, $partners:expr, $blend:literal) => {{
        let (keys, partners) = ($keys, $partners);
        let (low, high) = (_mm256_min_epu32(keys, partners), _mm256_max_epu32(keys, partners));
        _mm256_blend_epi32::<$blend>(low, high)
    }};
}

/// Sorts eight unsigned numbers in descending order with Batcher's bitonic network.
///
/// # Safety
/// Needs AVX2.
#[inline(always)]
pub(super) unsafe fn sort_descending(keys: __m256i) -> __m256i {
    // SAFETY: upheld by the caller.
    unsafe {
        let keys = compare_and_swap!(keys, swapped!(keys, 0b10_11_00_01), 0b0101_0101);
        let keys = compare_and_swap!(keys, swapped!(keys, 0b00_01_10_11), 0b0011_0011);
        let keys = compare_and_swap!(keys, swapped!(keys, 0b10_11_00_01), 0b0101_0101);
        let reversed = _mm256_permute4x64_epi64::<0b01_00_11_10>(swapped!(keys, 0b00_01_10_11));
        let keys = compare_and_swap!(keys, reversed, 0b0000_1111);
        let keys = compare_and_swap!(keys, swapped!(keys, 0b01_00_11_10), 0b0011_0011);
        compare_and_swap!(keys, swapped!(keys, 0b10_11_00_01), 0b0101_0101)
    }
}

impl Simd8 for Avx2 {
    type F = __m256;
    type M = __m256;

    shared_operations!();

    #[inline(always)]
    unsafe fn le(a: Self::F, b: Self::F) -> Self::M {
        // SAFETY: upheld by the caller, here and below.
        unsafe { _mm256_cmp_ps::<_CMP_LE_OQ>(a, b) }
    }

    #[inline(always)]
    unsafe fn lt(a: Self::F, b: Self::F) -> Self::M {
        // SAFETY: as above.
        unsafe { _mm256_cmp_ps::<_CMP_LT_OQ>(a, b) }
    }

    #[inline(always)]
    unsafe fn and(a: Self::M, b: Self::M) -> Self::M {
        // SAFETY: as above.
        unsafe { _mm256_and_ps(a, b) }
    }

    #[inline(always)]
    unsafe fn select(m: Self::M, a: Self::F, b: Self::F) -> Self::F {
        // SAFETY: as above.
        unsafe { _mm256_blendv_ps(b, a, m) }
    }

    #[inline(always)]
    unsafe fn mask_bits(m: Self::M) -> u32 {
        // SAFETY: as above.
        unsafe { _mm256_movemask_ps(m) as u32 }
    }

    #[inline(always)]
    unsafe fn compress_sorted(
        keys: *mut u32,
        children: *mut u32,
        t: Self::F,
        m: Self::M,
        from: *const u32,
    ) {
        // SAFETY: as above.
        unsafe {
            let lanes = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
            let rounded = _mm256_andnot_si256(_mm256_set1_epi32(7), _mm256_castps_si256(t));
            let key = _mm256_or_si256(rounded, lanes);
            let sorted = sort_descending(_mm256_and_si256(key, _mm256_castps_si256(m)));
            let from = _mm256_load_si256(from.cast());
            _mm256_storeu_si256(keys.cast(), sorted);
            _mm256_storeu_si256(children.cast(), _mm256_permutevar8x32_epi32(from, sorted));
        }
    }

    #[inline(always)]
    unsafe fn compress(children: *mut u32, m: Self::M, from: *const u32) {
        // SAFETY: as above; eight bits are an index of `COMPRESS_TABLE`.
        unsafe {
            let places = COMPRESS_TABLE.as_ptr().add(Self::mask_bits(m) as usize);
            let places = _mm256_cvtepu8_epi32(_mm_loadl_epi64(places.cast()));
            let from = _mm256_load_si256(from.cast());
            _mm256_storeu_si256(children.cast(), _mm256_permutevar8x32_epi32(from, places));
        }
    }
}
