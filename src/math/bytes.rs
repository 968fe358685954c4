//! Operations on many bytes of a text at once: which of them are separators, and the number that
//! digits make.
//!
//! Portable code and AVX2 give the same; a processor with AVX-512 uses AVX2. A [`ByteKernel`] runs
//! with those of an [`Isa`], compiled for it.
//!
//! The `unsafe` here, and its argument: AVX2's operations belong to a value that only [`run`]
//! makes, for an [`Isa`] that has them, and the loads are from arrays of the size that they read.

use super::isa::Isa;

/// Bytes that are looked at together, one bit for each.
pub(crate) const WORD: usize = 64;

/// The digits of a number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Digits {
    /// The number without its point.
    pub(crate) mantissa: u64,
    /// How many digits follow the point.
    pub(crate) decimals: u32,
    /// True if there is anything else, or not one point. What is above has then no meaning.
    pub(crate) is_wrong: bool,
}

/// The operations.
pub(crate) trait ByteOps: Copy {
    /// A bit for each byte that is at most `limit`, the lowest one for the first.
    fn at_most(self, bytes: &[u8; WORD], limit: u8) -> u64;

    /// A bit for each byte that is equal to `byte`.
    fn equal(self, bytes: &[u8; WORD], byte: u8) -> u64;

    /// The digits in the last bytes, at most 20, with one point among them.
    fn long_digits(self, bytes: &[u8; 32], length: usize) -> Digits;
}

/// What runs with operations on bytes.
pub(crate) trait ByteKernel {
    /// Runs the kernel. Must always be inlined, and so must the functions that take the operations.
    fn run(self, ops: impl ByteOps);
}

/// Runs a kernel with the operations of an instruction set.
#[inline]
pub(crate) fn run(isa: Isa, kernel: impl ByteKernel) {
    #[cfg(target_arch = "x86_64")]
    if isa.has_avx2() {
        // SAFETY: this processor has AVX2, and what `Isa` asks for with it.
        return unsafe { avx2::run(kernel) };
    }
    let _ = isa;
    kernel.run(Portable);
}

/// Byte by byte.
#[derive(Clone, Copy)]
struct Portable;

impl ByteOps for Portable {
    #[inline(always)]
    fn at_most(self, bytes: &[u8; WORD], limit: u8) -> u64 {
        bits(bytes, |byte| byte <= limit)
    }

    #[inline(always)]
    fn equal(self, bytes: &[u8; WORD], byte: u8) -> u64 {
        bits(bytes, |other| other == byte)
    }

    #[inline(always)]
    fn long_digits(self, bytes: &[u8; 32], length: usize) -> Digits {
        digits(&bytes[32 - length.min(32)..])
    }
}

/// A bit for each byte with a property, the lowest one for the first.
#[inline(always)]
fn bits(bytes: &[u8; WORD], is_such: impl Fn(u8) -> bool) -> u64 {
    /// Moves the lowest bit of each byte into the highest byte.
    const GATHER: u64 = 0x0102_0408_1020_4080;
    let mut flags = [0; WORD];
    for (flag, byte) in flags.iter_mut().zip(bytes) {
        *flag = u8::from(is_such(*byte));
    }
    let mut bits = 0;
    for at in 0..WORD / 8 {
        let mut word = [0; 8];
        word.copy_from_slice(&flags[8 * at..8 * at + 8]);
        bits |= u64::from_le_bytes(word).wrapping_mul(GATHER) >> 56 << (8 * at);
    }
    bits
}

fn digits(text: &[u8]) -> Digits {
    let points = text.iter().filter(|byte| **byte == b'.').count();
    let mut all = Digits { is_wrong: points != 1, ..Digits::default() };
    let mut is_after = false;
    for byte in text.iter().filter(|byte| **byte != b'.') {
        all.is_wrong |= !byte.is_ascii_digit();
        let digit = u64::from(byte.wrapping_sub(b'0'));
        all.mantissa = all.mantissa.wrapping_mul(10).wrapping_add(digit);
    }
    for byte in text {
        all.decimals += u32::from(is_after);
        is_after |= *byte == b'.';
    }
    all
}

#[cfg(target_arch = "x86_64")]
mod avx2 {
    use std::arch::x86_64::*;
    use std::hint::black_box;

    use super::{ByteKernel, ByteOps, Digits, WORD};

    /// A processor with AVX2.
    #[derive(Clone, Copy)]
    struct Avx2(());

    #[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt")]
    pub(super) unsafe fn run(kernel: impl ByteKernel) {
        kernel.run(Avx2(()));
    }

    #[target_feature(enable = "avx2")]
    #[inline]
    unsafe fn at_most(bytes: &[u8; WORD], limit: u8) -> u64 {
        let [low, high] = halves(bytes);
        // SAFETY: upheld by the caller.
        unsafe {
            let limit = _mm256_set1_epi8(limit as i8);
            let low = _mm256_cmpeq_epi8(_mm256_max_epu8(low, limit), limit);
            let high = _mm256_cmpeq_epi8(_mm256_max_epu8(high, limit), limit);
            highest(low, high)
        }
    }

    #[target_feature(enable = "avx2")]
    #[inline]
    unsafe fn equal(bytes: &[u8; WORD], byte: u8) -> u64 {
        let [low, high] = halves(bytes);
        // SAFETY: upheld by the caller.
        unsafe {
            let byte = _mm256_set1_epi8(byte as i8);
            highest(_mm256_cmpeq_epi8(low, byte), _mm256_cmpeq_epi8(high, byte))
        }
    }

    #[inline(always)]
    fn halves(bytes: &[u8; WORD]) -> [__m256i; 2] {
        let at = bytes.as_ptr().cast::<__m256i>();
        // SAFETY: 32 bytes from 0 and from 32 on are in the array, which needs no alignment.
        unsafe { [_mm256_loadu_si256(at), _mm256_loadu_si256(at.add(1))] }
    }

    /// A bit for each byte, its highest one.
    ///
    /// # Safety
    /// Needs AVX2.
    #[inline(always)]
    unsafe fn highest(low: __m256i, high: __m256i) -> u64 {
        // SAFETY: upheld by the caller.
        let [low, high] = unsafe { [_mm256_movemask_epi8(low), _mm256_movemask_epi8(high)] };
        // LLVM would take the bits apart and shift each of them.
        let [low, high] = black_box([low, high]);
        u64::from(low as u32) | u64::from(high as u32) << 32
    }

    /// All bits of the first 32 bytes, and none of those after them.
    static FALLING: [u8; 64] = steps(true);
    static RISING: [u8; 64] = steps(false);

    const fn steps(is_falling: bool) -> [u8; 64] {
        let mut all = [0; 64];
        let mut at = if is_falling { 0 } else { 32 };
        let end = at + 32;
        while at < end {
            all[at] = 0xff;
            at += 1;
        }
        all
    }

    /// Sixteen bytes of a table.
    #[inline(always)]
    fn part(of: &[u8; 64], at: usize) -> __m128i {
        load(of[at..].first_chunk().unwrap_or(&[0; 16]))
    }

    #[inline(always)]
    fn load(bytes: &[u8; 16]) -> __m128i {
        // SAFETY: the array has 16 bytes, and needs no alignment.
        unsafe { _mm_loadu_si128(bytes.as_ptr().cast()) }
    }

    impl Avx2 {
        /// Digits from 0 to 9 and 0x1e for a point, in the last `length` bytes.
        #[inline(always)]
        fn last(self, bytes: &[u8; 16], length: usize) -> __m128i {
            let mask = part(&RISING, 16 + length.min(16));
            // SAFETY: as above.
            unsafe { _mm_and_si128(_mm_xor_si128(load(bytes), _mm_set1_epi8(0x30)), mask) }
        }

        /// A bit for each byte that was a point.
        #[inline(always)]
        fn points(self, digits: __m128i) -> u32 {
            // SAFETY: as above.
            unsafe { _mm_movemask_epi8(_mm_cmpeq_epi8(digits, _mm_set1_epi8(0x1e))) as u32 }
        }

        /// Returns true if a byte is more than 9.
        #[inline(always)]
        fn has_others(self, digits: __m128i) -> bool {
            // SAFETY: as above.
            unsafe { _mm_movemask_epi8(_mm_adds_epu8(digits, _mm_set1_epi8(0x76))) != 0 }
        }

        /// Four numbers of four digits each.
        #[inline(always)]
        fn fours(self, digits: __m128i) -> __m128i {
            // SAFETY: as above.
            unsafe {
                let pairs = _mm_maddubs_epi16(digits, _mm_set1_epi16(0x010a));
                _mm_madd_epi16(pairs, _mm_set1_epi32(0x0001_0064))
            }
        }

        /// The number with sixteen digits.
        #[inline(always)]
        fn sixteen(self, digits: __m128i) -> u64 {
            let fours = self.fours(digits);
            // SAFETY: as above.
            let eights = unsafe {
                let narrow = _mm_packus_epi32(fours, fours);
                _mm_cvtsi128_si64(_mm_madd_epi16(narrow, _mm_set1_epi32(0x0001_2710))) as u64
            };
            (eights & 0xffff_ffff) * 100_000_000 + (eights >> 32)
        }
    }

    impl ByteOps for Avx2 {
        #[inline(always)]
        fn at_most(self, bytes: &[u8; WORD], limit: u8) -> u64 {
            // SAFETY: `self` says that AVX2 is there, here and below.
            unsafe { at_most(bytes, limit) }
        }

        #[inline(always)]
        fn equal(self, bytes: &[u8; WORD], byte: u8) -> u64 {
            // SAFETY: as above.
            unsafe { equal(bytes, byte) }
        }

        #[inline(always)]
        fn long_digits(self, bytes: &[u8; 32], length: usize) -> Digits {
            let half = |at: usize| bytes[at..].first_chunk().unwrap_or(&[0; 16]);
            let high = self.last(half(0), length.saturating_sub(16));
            let low = self.last(half(16), length);
            let points = self.points(high) | self.points(low) << 16;
            let place = (points | 1 << 31).trailing_zeros();
            let before = |at: usize| part(&FALLING, at + 31 - place as usize);
            // SAFETY: as above.
            let (low, high) = unsafe {
                let moved = _mm_alignr_epi8::<15>(low, high);
                let low = _mm_blendv_epi8(low, moved, before(16));
                (low, _mm_blendv_epi8(high, _mm_slli_si128::<1>(high), before(0)))
            };
            let is_wrong =
                points.count_ones() != 1 || self.has_others(low) || self.has_others(high);
            // SAFETY: as above.
            let first = unsafe { _mm_extract_epi32::<3>(self.fours(high)) } as u64;
            let mantissa =
                first.wrapping_mul(10_000_000_000_000_000).wrapping_add(self.sixteen(low));
            Digits { mantissa, decimals: 31 - place, is_wrong }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What the operations say of 32 bytes, for all lengths.
    #[derive(Debug, Default, PartialEq)]
    struct Answers(Vec<u64>, Vec<Option<(u64, u32)>>);

    struct Asking<'a>(&'a [u8; 32], &'a mut Answers);

    impl ByteKernel for Asking<'_> {
        #[inline(always)]
        fn run(self, ops: impl ByteOps) {
            let Self(bytes, Answers(words, numbers)) = self;
            let mut word = [0; WORD];
            word[..32].copy_from_slice(bytes);
            word[32..].copy_from_slice(bytes);
            word[40] = word[40].wrapping_add(0x80);
            for byte in [b' ', b'\n', b'7', 0, 0x80, 0xff] {
                words.extend([ops.at_most(&word, byte), ops.equal(&word, byte)]);
            }
            let right =
                |digits: Digits| (!digits.is_wrong).then_some((digits.mantissa, digits.decimals));
            numbers.extend((0..=20).map(|length| right(ops.long_digits(bytes, length))));
        }
    }

    #[test]
    fn every_instruction_set_gives_the_same() {
        let mut state = 1u64;
        let mut random = |below: u64| {
            state = state.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(0x1405_7b7e_f767_814f);
            (state >> 33) % below
        };
        let mut right = 0;
        for round in 0..20_000 {
            let mut bytes = [0; 32];
            bytes.fill_with(|| b'0' + random(10) as u8);
            bytes[12 + random(20) as usize] = b'.';
            if round % 3 == 0 {
                bytes[12 + random(20) as usize] = random(256) as u8;
            }
            let all = [Isa::PORTABLE].into_iter().chain(Isa::available());
            let all: Vec<Answers> = all
                .map(|isa| {
                    let mut answers = Answers::default();
                    run(isa, Asking(&bytes, &mut answers));
                    answers
                })
                .collect();
            assert!(all.iter().all(|answers| *answers == all[0]), "{bytes:?}: {all:?}");
            right += all[0].1.iter().flatten().count();
        }
        assert!(right > 2_000);
    }
}
