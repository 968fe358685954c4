//! Operations on many bytes of a text at once: which of them are separators, and the numbers that
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

/// A text that ends with digits.
pub(crate) type Tail<'t> = &'t [u8; 16];

/// The operations.
pub(crate) trait ByteOps: Copy {
    /// A bit for each byte that is at most `limit`, the lowest one for the first.
    fn at_most(self, bytes: &[u8; WORD], limit: u8) -> u64;

    /// A bit for each byte that is equal to `byte`.
    fn equal(self, bytes: &[u8; WORD], byte: u8) -> u64;

    /// The numbers with up to eight digits: a digit from 0 to 9 in each byte, the first one in the
    /// lowest, after zeros. `None` if a byte is more than that.
    fn eights(self, digits: &[u64; 8]) -> Option<[u32; 8]>;

    /// The whole parts and the fractions of decimal numbers at the end of texts: up to seven digits
    /// as `wholes` says, a point, and up to eight digits. `None` if one is something else.
    fn pointed(self, texts: [Tail<'_>; 4], wholes: [usize; 4], decimals: usize)
    -> Option<[u32; 8]>;

    /// The numbers that the last bytes of texts make, as many digits of each as `counts` says, at
    /// most 16. `None` if one of them is no digit.
    fn sixteens(self, texts: [Tail<'_>; 4], counts: [usize; 4]) -> Option<[u64; 4]>;
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
    fn eights(self, digits: &[u64; 8]) -> Option<[u32; 8]> {
        let number = |word: u64| number(word.to_le_bytes().into_iter()).map(|number| number as u32);
        let mut numbers = [0; 8];
        for (to, word) in numbers.iter_mut().zip(digits) {
            *to = number(*word)?;
        }
        Some(numbers)
    }

    #[inline(always)]
    fn pointed(
        self,
        texts: [Tail<'_>; 4],
        wholes: [usize; 4],
        decimals: usize,
    ) -> Option<[u32; 8]> {
        let digits = |text: &[u8]| Some(number(text.iter().map(|byte| byte ^ b'0'))? as u32);
        let mut numbers = [0; 8];
        for ((to, text), whole) in numbers.chunks_exact_mut(2).zip(texts).zip(wholes) {
            let (before, fraction) = text.split_at(16 - decimals.min(8));
            let (b'.', before) = before.split_last()? else { return None };
            to[0] = digits(&before[before.len() - whole.min(7)..])?;
            to[1] = digits(fraction)?;
        }
        Some(numbers)
    }

    #[inline(always)]
    fn sixteens(self, texts: [Tail<'_>; 4], counts: [usize; 4]) -> Option<[u64; 4]> {
        let mut numbers = [0; 4];
        for ((to, text), count) in numbers.iter_mut().zip(texts).zip(counts) {
            *to = number(text[16 - count.min(16)..].iter().map(|byte| byte ^ b'0'))?;
        }
        Some(numbers)
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

/// The number that digits make.
fn number(digits: impl Iterator<Item = u8>) -> Option<u64> {
    let mut number = 0;
    for digit in digits {
        number = 10 * number + Some(u64::from(digit)).filter(|digit| *digit < 10)?;
    }
    Some(number)
}

#[cfg(target_arch = "x86_64")]
mod avx2 {
    use std::arch::x86_64::*;
    use std::hint::black_box;

    use super::{ByteKernel, ByteOps, Tail, WORD};

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

    /// Sixteen bytes without any bit, and sixteen with all.
    static RISING: [u8; 32] = rising();

    const fn rising() -> [u8; 32] {
        let mut all = [0; 32];
        let mut at = 16;
        while at < 32 {
            all[at] = 0xff;
            at += 1;
        }
        all
    }

    /// How a number is taken apart that has so many digits after its point.
    struct Form {
        /// Makes 0 of the point, and a number of each digit.
        zeros: [u8; 16],
        /// Moves the point to the front, seven digits before it after that, and those after it to
        /// the end.
        places: [u8; 16],
    }

    static FORMS: [Form; 9] = forms();

    const fn forms() -> [Form; 9] {
        let mut all = [const { Form { zeros: [b'0'; 16], places: [0x80; 16] } }; 9];
        let mut decimals = 0;
        while decimals < 9 {
            all[decimals].zeros[15 - decimals] = b'.';
            all[decimals].places[0] = 15 - decimals as u8;
            let mut at = 1;
            while at < 16 {
                if at < 8 {
                    all[decimals].places[at] = (7 + at - decimals) as u8;
                } else if at + decimals >= 16 {
                    all[decimals].places[at] = at as u8;
                }
                at += 1;
            }
            decimals += 1;
        }
        all
    }

    /// The bytes of a point, of up to seven digits, and of those after the point.
    static WHOLES: [[u8; 16]; 8] = wholes();

    const fn wholes() -> [[u8; 16]; 8] {
        let mut all = [[0xff; 16]; 8];
        let mut count = 0;
        while count < 8 {
            let mut at = 1;
            while at + count < 8 {
                all[count][at] = 0;
                at += 1;
            }
            count += 1;
        }
        all
    }

    #[inline(always)]
    fn load(bytes: &[u8; 16]) -> __m128i {
        // SAFETY: the array has 16 bytes, and needs no alignment.
        unsafe { _mm_loadu_si128(bytes.as_ptr().cast()) }
    }

    /// All bits of the last bytes of sixteen.
    #[inline(always)]
    fn last(count: usize) -> __m128i {
        load(RISING[count.min(16)..].first_chunk().unwrap_or(&[0; 16]))
    }

    impl Avx2 {
        /// The numbers that each eight digits make, those of both vectors in turns of two; `None`
        /// if a byte is more than 9.
        #[inline(always)]
        fn numbers(self, a: __m256i, b: __m256i) -> Option<__m256i> {
            // SAFETY: `self` says that AVX2 is there, here and below.
            self.numbers_below(a, b, unsafe { _mm256_set1_epi8(0x76) })
        }

        /// Those with bytes that exceed 0x7f with none of `more`.
        #[inline(always)]
        fn numbers_below(self, a: __m256i, b: __m256i, more: __m256i) -> Option<__m256i> {
            // SAFETY: as above.
            unsafe {
                let others = _mm256_or_si256(_mm256_adds_epu8(a, more), _mm256_adds_epu8(b, more));
                if _mm256_movemask_epi8(others) != 0 {
                    return None;
                }
                let narrow = _mm256_packus_epi32(self.fours(a), self.fours(b));
                Some(_mm256_madd_epi16(narrow, _mm256_set1_epi32(0x0001_2710)))
            }
        }

        /// Two words.
        #[inline(always)]
        fn pair(self, low: u64, high: u64) -> __m128i {
            // SAFETY: as above.
            unsafe {
                _mm_unpacklo_epi64(_mm_cvtsi64_si128(low as i64), _mm_cvtsi64_si128(high as i64))
            }
        }

        /// The numbers that each four digits make.
        #[inline(always)]
        fn fours(self, digits: __m256i) -> __m256i {
            // SAFETY: as above.
            unsafe {
                let pairs = _mm256_maddubs_epi16(digits, _mm256_set1_epi16(0x010a));
                _mm256_madd_epi16(pairs, _mm256_set1_epi32(0x0001_0064))
            }
        }

        /// The digits at the end of two texts.
        #[inline(always)]
        fn tails(self, texts: [Tail<'_>; 2], counts: [usize; 2]) -> __m256i {
            let [low, high] = texts.map(load);
            let [low_mask, high_mask] = counts.map(last);
            // SAFETY: as above.
            unsafe {
                let digits = _mm256_xor_si256(_mm256_set_m128i(high, low), _mm256_set1_epi8(0x30));
                _mm256_and_si256(digits, _mm256_set_m128i(high_mask, low_mask))
            }
        }
    }

    impl ByteOps for Avx2 {
        #[inline(always)]
        fn at_most(self, bytes: &[u8; WORD], limit: u8) -> u64 {
            // SAFETY: as above.
            unsafe { at_most(bytes, limit) }
        }

        #[inline(always)]
        fn equal(self, bytes: &[u8; WORD], byte: u8) -> u64 {
            // SAFETY: as above.
            unsafe { equal(bytes, byte) }
        }

        #[inline(always)]
        fn eights(self, digits: &[u64; 8]) -> Option<[u32; 8]> {
            let pair = |at: usize| self.pair(digits[at], digits[at + 1]);
            let mut numbers = [0; 8];
            // SAFETY: as above; the array has the 32 bytes that are stored, and needs no alignment.
            unsafe {
                let [a, b] =
                    [_mm256_set_m128i(pair(4), pair(0)), _mm256_set_m128i(pair(6), pair(2))];
                let all = self.numbers(a, b)?;
                _mm256_storeu_si256(numbers.as_mut_ptr().cast(), all);
            }
            Some(numbers)
        }

        #[inline(always)]
        fn pointed(
            self,
            texts: [Tail<'_>; 4],
            wholes: [usize; 4],
            decimals: usize,
        ) -> Option<[u32; 8]> {
            let form = &FORMS[decimals.min(8)];
            let whole = |lane: usize| load(&WHOLES[wholes[lane].min(7)]);
            let mut numbers = [0; 8];
            // SAFETY: as above.
            unsafe {
                let [zeros, places] =
                    [&form.zeros, &form.places].map(|form| _mm256_broadcastsi128_si256(load(form)));
                let parts = |a: usize, b: usize| {
                    let both = _mm256_set_m128i(load(texts[b]), load(texts[a]));
                    let digits = _mm256_shuffle_epi8(_mm256_xor_si256(both, zeros), places);
                    _mm256_and_si256(digits, _mm256_set_m128i(whole(b), whole(a)))
                };
                // A point has become 0.
                let more = _mm256_insert_epi8::<16>(
                    _mm256_insert_epi8::<0>(_mm256_set1_epi8(0x76), 0x7f),
                    0x7f,
                );
                let all = self.numbers_below(parts(0, 2), parts(1, 3), more)?;
                _mm256_storeu_si256(numbers.as_mut_ptr().cast(), all);
            }
            Some(numbers)
        }

        #[inline(always)]
        fn sixteens(self, texts: [Tail<'_>; 4], counts: [usize; 4]) -> Option<[u64; 4]> {
            let tails =
                |a: usize, b: usize| self.tails([texts[a], texts[b]], [counts[a], counts[b]]);
            let eights = self.numbers(tails(0, 2), tails(1, 3))?;
            let mut numbers = [0; 4];
            // SAFETY: as above.
            unsafe {
                let high = _mm256_mul_epu32(eights, _mm256_set1_epi64x(100_000_000));
                let all = _mm256_add_epi64(high, _mm256_srli_epi64::<32>(eights));
                _mm256_storeu_si256(numbers.as_mut_ptr().cast(), all);
            }
            Some(numbers)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What the operations say of 64 bytes.
    #[derive(Debug, Default, PartialEq)]
    struct Answers(Vec<u64>, Vec<Option<[u32; 8]>>, Vec<Option<[u64; 4]>>);

    const PLACES: [usize; 4] = [0, 16, 31, 48];

    struct Asking<'a>(&'a [u8; WORD], &'a mut Answers);

    impl ByteKernel for Asking<'_> {
        #[inline(always)]
        fn run(self, ops: impl ByteOps) {
            let Self(bytes, Answers(places, eights, sixteens)) = self;
            for byte in [b' ', b'\n', b'7', 0, 0x80, 0xff] {
                places.extend([ops.at_most(bytes, byte), ops.equal(bytes, byte)]);
            }
            let word =
                |at: usize| bytes[8 * at..].first_chunk().map_or(0, |w| u64::from_le_bytes(*w));
            let mut words = [0, 1, 2, 3, 4, 5, 6, 7].map(|at| word(at) ^ 0x3030_3030_3030_3030);
            eights.push(ops.eights(&words));
            for (at, word) in words.iter_mut().enumerate() {
                *word <<= 8 * at;
            }
            eights.push(ops.eights(&words));
            let text = |at: usize| bytes[at..].first_chunk().expect("16 bytes");
            for count in 0..=16 {
                let counts = [count, 16 - count, 16, count / 2];
                sixteens.push(ops.sixteens(PLACES.map(text), counts));
            }
            for decimals in 0..=8 {
                let mut bytes = *bytes;
                for at in PLACES {
                    bytes[at + 15 - decimals] = b'.';
                }
                let text = |at: usize| bytes[at..].first_chunk().expect("16 bytes");
                eights.push(ops.pointed(PLACES.map(text), [7, decimals.min(7), 0, 3], decimals));
            }
        }
    }

    fn answers(bytes: &[u8; WORD], isa: Isa) -> Answers {
        let mut answers = Answers::default();
        run(isa, Asking(bytes, &mut answers));
        answers
    }

    #[test]
    fn numbers_are_those_of_their_digits() {
        let mut bytes = [b'0'; WORD];
        bytes[..32].copy_from_slice(b"12345678000000099999999987654321");
        for isa in Isa::available() {
            let Answers(_, eights, sixteens) = answers(&bytes, isa);
            let first = [12_345_678, 9, 99_999_999, 87_654_321, 0, 0, 0, 0];
            assert_eq!(eights[0], Some(first));
            let last = [1_234_567_800_000_009, 9_999_999_987_654_321, 1_000_000_000_000_000, 0];
            assert_eq!(sixteens[16], Some([last[0], 0, last[2], 0]));
            assert_eq!(sixteens[0], Some([0, last[1], last[2], 0]));
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
            let mut bytes = [0; WORD];
            bytes.fill_with(|| b'0' + random(10) as u8);
            if round % 3 > 0 {
                bytes[random(64) as usize] = random(256) as u8;
            }
            let expected = answers(&bytes, Isa::PORTABLE);
            for isa in Isa::available() {
                assert_eq!(answers(&bytes, isa), expected, "{bytes:?}");
            }
            right += expected.1.iter().flatten().count() + expected.2.iter().flatten().count();
        }
        assert!(right > 100_000, "{right}");
    }
}
