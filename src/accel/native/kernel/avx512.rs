//! Eight lanes in the AVX-512VL instructions of x86-64: comparisons return eight-bit masks, and one
//! instruction compresses the selected lanes.

use std::arch::x86_64::*;

use super::simd::Simd8;
use super::x86::{shared_operations, smallest};

/// AVX-512VL.
pub(super) struct Avx512;

/// Moves the larger of each pair of lanes to where `LARGER` has a bit, and the smaller to its
/// partner.
macro_rules! compare_and_swap {
    ($keys:expr, $partners:expr, $larger:literal) => {{
        let (keys, partners) = ($keys, $partners);
        let low = _mm256_min_epu32(keys, partners);
        _mm256_mask_max_epu32(low, $larger, keys, partners)
    }};
}

macro_rules! swapped {
    ($keys:expr, $order:literal) => {
        _mm256_shuffle_epi32::<$order>($keys)
    };
}

/// Sorts eight unsigned numbers in descending order with Batcher's bitonic network.
///
/// # Safety
/// Needs AVX-512VL.
#[inline(always)]
unsafe fn sort_descending(keys: __m256i) -> __m256i {
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

impl Simd8 for Avx512 {
    type F = __m256;
    type M = __mmask8;

    shared_operations!();

    #[inline(always)]
    unsafe fn le(a: Self::F, b: Self::F) -> Self::M {
        // SAFETY: upheld by the caller, here and below.
        unsafe { _mm256_cmp_ps_mask::<_CMP_LE_OQ>(a, b) }
    }

    #[inline(always)]
    unsafe fn lt(a: Self::F, b: Self::F) -> Self::M {
        // SAFETY: as above.
        unsafe { _mm256_cmp_ps_mask::<_CMP_LT_OQ>(a, b) }
    }

    #[inline(always)]
    unsafe fn and(a: Self::M, b: Self::M) -> Self::M {
        a & b
    }

    #[inline(always)]
    unsafe fn select(m: Self::M, a: Self::F, b: Self::F) -> Self::F {
        // SAFETY: as above.
        unsafe { _mm256_mask_blend_ps(m, b, a) }
    }

    #[inline(always)]
    unsafe fn mask_bits(m: Self::M) -> u32 {
        u32::from(m)
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
            // (t & ~7) | lanes, where m is set.
            let t = _mm256_castps_si256(t);
            let keys_at = _mm256_ternarylogic_epi32::<0xba>(t, _mm256_set1_epi32(7), lanes);
            let sorted = sort_descending(_mm256_maskz_mov_epi32(m, keys_at));
            let from = _mm256_load_si256(from.cast());
            _mm256_storeu_si256(keys.cast(), sorted);
            _mm256_storeu_si256(children.cast(), _mm256_permutevar8x32_epi32(from, sorted));
        }
    }

    #[inline(always)]
    unsafe fn compress(children: *mut u32, m: Self::M, from: *const u32) {
        // SAFETY: as above.
        unsafe {
            let from = _mm256_load_si256(from.cast());
            _mm256_storeu_si256(children.cast(), _mm256_maskz_compress_epi32(m, from));
        }
    }
}
