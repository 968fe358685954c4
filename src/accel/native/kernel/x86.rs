//! Operations shared by the x86-64 implementations.

use std::arch::x86_64::*;

/// The operations of [`super::simd::Simd8`] that all share.
macro_rules! shared_operations {
    () => {
        #[inline(always)]
        unsafe fn load(from: *const f32) -> Self::F {
            // SAFETY: upheld by the caller, here and below.
            unsafe { _mm256_load_ps(from) }
        }

        #[inline(always)]
        unsafe fn store(to: *mut f32, a: Self::F) {
            // SAFETY: as above.
            unsafe { _mm256_storeu_ps(to, a) }
        }

        #[inline(always)]
        unsafe fn splat(x: f32) -> Self::F {
            // SAFETY: as above.
            unsafe { _mm256_set1_ps(x) }
        }

        #[inline(always)]
        unsafe fn add(a: Self::F, b: Self::F) -> Self::F {
            // SAFETY: as above.
            unsafe { _mm256_add_ps(a, b) }
        }

        #[inline(always)]
        unsafe fn sub(a: Self::F, b: Self::F) -> Self::F {
            // SAFETY: as above.
            unsafe { _mm256_sub_ps(a, b) }
        }

        #[inline(always)]
        unsafe fn mul(a: Self::F, b: Self::F) -> Self::F {
            // SAFETY: as above.
            unsafe { _mm256_mul_ps(a, b) }
        }

        #[inline(always)]
        unsafe fn mul_add(a: Self::F, b: Self::F, c: Self::F) -> Self::F {
            // SAFETY: as above.
            unsafe { _mm256_fmadd_ps(a, b, c) }
        }

        #[inline(always)]
        unsafe fn mul_sub(a: Self::F, b: Self::F, c: Self::F) -> Self::F {
            // SAFETY: as above.
            unsafe { _mm256_fmsub_ps(a, b, c) }
        }

        #[inline(always)]
        unsafe fn neg_mul_add(a: Self::F, b: Self::F, c: Self::F) -> Self::F {
            // SAFETY: as above.
            unsafe { _mm256_fnmadd_ps(a, b, c) }
        }

        #[inline(always)]
        unsafe fn min(a: Self::F, b: Self::F) -> Self::F {
            // SAFETY: as above.
            unsafe { _mm256_min_ps(a, b) }
        }

        #[inline(always)]
        unsafe fn max(a: Self::F, b: Self::F) -> Self::F {
            // SAFETY: as above.
            unsafe { _mm256_max_ps(a, b) }
        }

        #[inline(always)]
        unsafe fn sqrt(a: Self::F) -> Self::F {
            // SAFETY: as above.
            unsafe { _mm256_sqrt_ps(a) }
        }

        #[inline(always)]
        unsafe fn abs(a: Self::F) -> Self::F {
            // SAFETY: as above.
            unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), a) }
        }

        #[inline(always)]
        unsafe fn reduce_min(a: Self::F) -> f32 {
            // SAFETY: as above.
            unsafe { smallest(a) }
        }

        #[inline(always)]
        unsafe fn prefetch(at: *const u8) {
            // SAFETY: as above.
            unsafe { _mm_prefetch::<_MM_HINT_T0>(at.cast()) }
        }
    };
}
pub(super) use shared_operations;

/// The smallest of eight numbers.
///
/// # Safety
/// Needs AVX2.
#[inline(always)]
pub(super) unsafe fn smallest(a: __m256) -> f32 {
    // SAFETY: upheld by the caller.
    unsafe {
        let a = _mm_min_ps(_mm256_castps256_ps128(a), _mm256_extractf128_ps::<1>(a));
        let a = _mm_min_ps(a, _mm_movehl_ps(a, a));
        _mm_cvtss_f32(_mm_min_ss(a, _mm_movehdup_ps(a)))
    }
}
