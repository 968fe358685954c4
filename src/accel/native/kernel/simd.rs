//! Eight SIMD lanes: the few operations that the kernel needs, and their portable implementation.

/// Eight numbers at once, in one of the instruction sets that processors offer.
///
/// Implementations may differ in the last bits (some use fused multiply-add, some do not). The
/// kernel's error bounds hold for all of them, and every candidate is tested again in f64.
///
/// # Safety
/// Every function requires that the processor supports the instructions of the implementation.
/// Pointers must be valid for eight numbers, and aligned to 32 bytes for [`Self::load`].
pub(super) trait Simd8 {
    /// Eight f32.
    type F: Copy;
    /// Eight booleans.
    type M: Copy;

    unsafe fn load(from: *const f32) -> Self::F;
    unsafe fn store(to: *mut f32, a: Self::F);
    unsafe fn splat(x: f32) -> Self::F;
    unsafe fn add(a: Self::F, b: Self::F) -> Self::F;
    unsafe fn sub(a: Self::F, b: Self::F) -> Self::F;
    unsafe fn mul(a: Self::F, b: Self::F) -> Self::F;
    /// `a b + c`, rounded once or twice.
    unsafe fn mul_add(a: Self::F, b: Self::F, c: Self::F) -> Self::F;
    /// `a b - c`, rounded once or twice.
    unsafe fn mul_sub(a: Self::F, b: Self::F, c: Self::F) -> Self::F;
    /// `c - a b`, rounded once or twice.
    unsafe fn neg_mul_add(a: Self::F, b: Self::F, c: Self::F) -> Self::F;
    /// The smaller numbers; `b` if they are equal or either is NaN.
    unsafe fn min(a: Self::F, b: Self::F) -> Self::F;
    /// The larger numbers; `b` if they are equal or either is NaN.
    unsafe fn max(a: Self::F, b: Self::F) -> Self::F;
    unsafe fn sqrt(a: Self::F) -> Self::F;
    unsafe fn abs(a: Self::F) -> Self::F;
    /// `a <= b`; false for NaN.
    unsafe fn le(a: Self::F, b: Self::F) -> Self::M;
    /// `a < b`; false for NaN.
    unsafe fn lt(a: Self::F, b: Self::F) -> Self::M;
    unsafe fn and(a: Self::M, b: Self::M) -> Self::M;
    /// `a` where `m` is set, else `b`.
    unsafe fn select(m: Self::M, a: Self::F, b: Self::F) -> Self::F;
    /// The lanes that are set, as bits.
    unsafe fn mask_bits(m: Self::M) -> u32;
    /// The smallest lane; none may be NaN.
    unsafe fn reduce_min(a: Self::F) -> f32;

    /// Writes eight keys and eight children: first those where `m` is set, in order of decreasing
    /// distance; the rest is garbage. A key is the bits of `t`, which is not negative, with the
    /// lane in its three lowest bits.
    unsafe fn compress_sorted(
        keys: *mut u32,
        children: *mut u32,
        t: Self::F,
        m: Self::M,
        from: *const u32,
    );

    /// Writes eight children: first those where `m` is set; the rest is garbage.
    unsafe fn compress(children: *mut u32, m: Self::M, from: *const u32);

    /// Prefetches the cache line at an address, which need not be valid.
    unsafe fn prefetch(at: *const u8);
}

/// Arrays, whose loops the compiler vectorises for the target processor.
pub(super) struct Portable;

macro_rules! each {
    (|$lane:ident| $value:expr) => {
        std::array::from_fn(
            #[inline(always)]
            |$lane| $value,
        )
    };
}

impl Simd8 for Portable {
    type F = [f32; 8];
    type M = [bool; 8];

    #[inline(always)]
    unsafe fn load(from: *const f32) -> Self::F {
        // SAFETY: upheld by the caller.
        unsafe { from.cast::<[f32; 8]>().read() }
    }

    #[inline(always)]
    unsafe fn store(to: *mut f32, a: Self::F) {
        // SAFETY: upheld by the caller.
        unsafe { to.cast::<[f32; 8]>().write(a) }
    }

    #[inline(always)]
    unsafe fn splat(x: f32) -> Self::F {
        [x; 8]
    }

    #[inline(always)]
    unsafe fn add(a: Self::F, b: Self::F) -> Self::F {
        each!(|i| a[i] + b[i])
    }

    #[inline(always)]
    unsafe fn sub(a: Self::F, b: Self::F) -> Self::F {
        each!(|i| a[i] - b[i])
    }

    #[inline(always)]
    unsafe fn mul(a: Self::F, b: Self::F) -> Self::F {
        each!(|i| a[i] * b[i])
    }

    #[inline(always)]
    unsafe fn mul_add(a: Self::F, b: Self::F, c: Self::F) -> Self::F {
        each!(|i| a[i] * b[i] + c[i])
    }

    #[inline(always)]
    unsafe fn mul_sub(a: Self::F, b: Self::F, c: Self::F) -> Self::F {
        each!(|i| a[i] * b[i] - c[i])
    }

    #[inline(always)]
    unsafe fn neg_mul_add(a: Self::F, b: Self::F, c: Self::F) -> Self::F {
        each!(|i| c[i] - a[i] * b[i])
    }

    #[inline(always)]
    unsafe fn min(a: Self::F, b: Self::F) -> Self::F {
        each!(|i| if a[i] < b[i] { a[i] } else { b[i] })
    }

    #[inline(always)]
    unsafe fn max(a: Self::F, b: Self::F) -> Self::F {
        each!(|i| if a[i] > b[i] { a[i] } else { b[i] })
    }

    #[inline(always)]
    unsafe fn sqrt(a: Self::F) -> Self::F {
        each!(|i| a[i].sqrt())
    }

    #[inline(always)]
    unsafe fn abs(a: Self::F) -> Self::F {
        each!(|i| a[i].abs())
    }

    #[inline(always)]
    unsafe fn le(a: Self::F, b: Self::F) -> Self::M {
        each!(|i| a[i] <= b[i])
    }

    #[inline(always)]
    unsafe fn lt(a: Self::F, b: Self::F) -> Self::M {
        each!(|i| a[i] < b[i])
    }

    #[inline(always)]
    unsafe fn and(a: Self::M, b: Self::M) -> Self::M {
        each!(|i| a[i] & b[i])
    }

    #[inline(always)]
    unsafe fn select(m: Self::M, a: Self::F, b: Self::F) -> Self::F {
        each!(|i| if m[i] { a[i] } else { b[i] })
    }

    #[inline(always)]
    unsafe fn mask_bits(m: Self::M) -> u32 {
        (0..8).fold(0, |bits, i| bits | u32::from(m[i]) << i)
    }

    #[inline(always)]
    unsafe fn reduce_min(a: Self::F) -> f32 {
        a.into_iter().fold(f32::INFINITY, |least, x| if x < least { x } else { least })
    }

    #[inline(always)]
    unsafe fn compress_sorted(
        keys: *mut u32,
        children: *mut u32,
        t: Self::F,
        m: Self::M,
        from: *const u32,
    ) {
        let mut sorted = [0u32; 8];
        for (count, lane) in (0..8).filter(|&lane| m[lane]).enumerate() {
            let key = t[lane].to_bits() & !7 | lane as u32;
            let mut slot = count;
            while slot > 0 && sorted[slot - 1] < key {
                sorted[slot] = sorted[slot - 1];
                slot -= 1;
            }
            sorted[slot] = key;
        }
        for (slot, key) in sorted.into_iter().enumerate() {
            // SAFETY: upheld by the caller; a lane's number is below 8.
            unsafe {
                keys.add(slot).write(key);
                children.add(slot).write(*from.add((key & 7) as usize));
            }
        }
    }

    #[inline(always)]
    unsafe fn compress(children: *mut u32, m: Self::M, from: *const u32) {
        for (count, lane) in (0..8).filter(|&lane| m[lane]).enumerate() {
            // SAFETY: upheld by the caller; both numbers are below 8.
            unsafe { children.add(count).write(*from.add(lane)) };
        }
    }

    #[inline(always)]
    unsafe fn prefetch(_: *const u8) {}
}
