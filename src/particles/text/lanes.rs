//! Numbers of a column in many rows at once.
//!
//! The end of each is known, so its digits are loaded aligned to the right, and no step depends on
//! how many there are: the same steps for all lanes, which the compiler turns into vector
//! instructions. Values are those of [`super::decimal`], to the bit.

use crate::math::bytes::{ByteOps, Digits};

use super::decimal::{POWERS, quotient};
use super::lane_digits::{LANES, Lanes, digits};

/// Most bytes of a number, without its sign: 19 digits and a point.
const MAX_BYTES: usize = 20;

/// Where values are in a text.
#[derive(Clone, Copy)]
pub(super) struct Places<'t> {
    pub(super) text: &'t [u8],
    /// Where the values of all rows begin.
    pub(super) marks: &'t [u32],
    /// Values of a row.
    pub(super) stride: usize,
    /// Which of them is meant.
    pub(super) at: usize,
}

/// Numbers without their signs.
struct Unsigned<const WORDS: usize> {
    /// The last bytes of each number and what is before it, the earliest word first.
    words: [Lanes<u64>; WORDS],
    /// Bytes without the sign.
    lengths: Lanes<u64>,
    /// All bits for a minus.
    signs: Lanes<u64>,
    most: u64,
}

impl Places<'_> {
    /// Where the value of a row begins and ends.
    #[inline(always)]
    pub(super) fn of(&self, row: usize) -> (usize, usize) {
        let mark = row * self.stride + self.at;
        (self.marks[mark] as usize, self.marks[mark + 1] as usize - 1)
    }

    /// Decimal numbers with a point and without an exponent; `None` if one is something else.
    #[inline(always)]
    pub(super) fn floats(&self, ops: impl ByteOps) -> Option<Lanes<f64>> {
        // Numbers of a column have similar lengths.
        let (start, end) = self.of(0);
        if end.saturating_sub(start) > 15 {
            return self.long_floats(ops);
        }
        let short: Unsigned<2> = self.unsigned()?;
        if short.most > 16 {
            return self.long_floats(ops);
        }
        // At most 15 digits, which are exact.
        let digits = digits(&short.words, &short.lengths, true)?;
        let mut values = [0.0; LANES];
        for (lane, value) in values.iter_mut().enumerate() {
            let power = POWERS[(digits.decimals[lane] & 15) as usize];
            let number = digits.mantissa[lane] as i64 as f64 / power;
            *value = f64::from_bits(number.to_bits() | short.signs[lane] << 63);
        }
        Some(values)
    }

    /// Those with up to 19 digits, whose vectors are too long to be several at once.
    #[inline(always)]
    fn long_floats(&self, ops: impl ByteOps) -> Option<Lanes<f64>> {
        let mut values = [0.0; LANES];
        for (lane, value) in values.iter_mut().enumerate() {
            let (start, end) = self.of(lane);
            let is_negative = self.text[start] == b'-';
            let length = end.wrapping_sub(start + usize::from(is_negative));
            let Digits { mantissa, decimals, is_wrong } =
                ops.long_digits(self.text[..end].last_chunk()?, length);
            if is_wrong | !(2..=MAX_BYTES).contains(&length) {
                return None;
            }
            let number = quotient(mantissa, decimals as usize, length - 1)?;
            *value = f64::from_bits(number.to_bits() | u64::from(is_negative) << 63);
        }
        Some(values)
    }

    /// Integers of at most 16 digits; `None` if one is something else.
    #[inline(always)]
    pub(super) fn integers(&self) -> Option<Lanes<i64>> {
        let short: Unsigned<1> = self.unsigned()?;
        let (digits, signs) = if short.most <= 8 {
            (digits(&short.words, &short.lengths, false)?, short.signs)
        } else {
            let long: Unsigned<2> = self.unsigned()?;
            if long.most > 16 {
                return None;
            }
            (digits(&long.words, &long.lengths, false)?, long.signs)
        };
        let mut values = [0; LANES];
        for (lane, value) in values.iter_mut().enumerate() {
            let sign = signs[lane] as i64;
            *value = (digits.mantissa[lane] as i64 ^ sign) - sign;
        }
        Some(values)
    }

    #[inline(always)]
    fn unsigned<const WORDS: usize>(&self) -> Option<Unsigned<WORDS>> {
        let mut all = Unsigned {
            words: [[0; LANES]; WORDS],
            lengths: [0; LANES],
            signs: [0; LANES],
            most: 0,
        };
        for lane in 0..LANES {
            let (start, end) = self.of(lane);
            let is_negative = self.text[start] == b'-';
            let length = end.wrapping_sub(start + usize::from(is_negative)) as u64;
            all.lengths[lane] = length;
            all.signs[lane] = 0u64.wrapping_sub(u64::from(is_negative));
            all.most = all.most.max(length);
            let bytes = &self.text[end.checked_sub(8 * WORDS)?..end];
            for at in 0..WORDS {
                let word = bytes[8 * at..].first_chunk()?;
                all.words[at][lane] = u64::from_le_bytes(*word);
            }
        }
        Some(all)
    }
}

#[cfg(test)]
mod tests {
    use crate::math::Isa;
    use crate::math::bytes::{self, ByteKernel};

    use super::super::marks::{Marks, Separator};
    use super::*;

    /// Numbers in each row, by the widest vectors and without any.
    struct Asking<'a, 't> {
        places: Places<'t>,
        floats: &'a mut Option<Lanes<f64>>,
        integers: &'a mut Option<Lanes<i64>>,
    }

    impl ByteKernel for Asking<'_, '_> {
        #[inline(always)]
        fn run(self, ops: impl ByteOps) {
            *self.floats = self.places.floats(ops);
            *self.integers = self.places.integers();
        }
    }

    fn asked(places: Places<'_>) -> (Option<Lanes<f64>>, Option<Lanes<i64>>) {
        let ask = |isa: Isa| {
            let (mut floats, mut integers) = (None, None);
            bytes::run(isa, Asking { places, floats: &mut floats, integers: &mut integers });
            (floats, integers)
        };
        let (portable, best) = (ask(Isa::PORTABLE), ask(Isa::best()));
        assert_eq!(portable, best);
        best
    }

    /// One number in each row, after bytes that belong to none.
    fn with_places<T>(numbers: &[String], use_of: impl Fn(Places<'_>) -> T) -> T {
        let text = format!("{}\n{}\n", ".7".repeat(16), numbers.join("\n"));
        let mut marks = Marks::default();
        marks.mark(text.as_bytes(), Separator::Delimiter(b','), Isa::best());
        use_of(Places { text: text.as_bytes(), marks: &marks.starts()[1..], stride: 1, at: 0 })
    }

    fn floats(numbers: &[String]) -> Option<Vec<u64>> {
        let bits = |values: Lanes<f64>| values.map(f64::to_bits).to_vec();
        with_places(numbers, |places| asked(places).0.map(bits))
    }

    /// Numbers with a point somewhere, some of them negative.
    fn numbers(most_digits: u64, seed: u64) -> Vec<String> {
        let mut state = seed;
        let mut random = move || {
            state = state.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(0x1405_7b7e_f767_814f);
            (state ^ (state >> 29)).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 1
        };
        let number = |_| {
            let digits = (random() % 10u64.pow(1 + (random() % most_digits) as u32)).to_string();
            let point = random() as usize % (digits.len() + 1);
            let sign = if random() & 1 == 0 { "-" } else { "" };
            format!("{sign}{}.{}", &digits[..point], &digits[point..])
        };
        (0..LANES).map(number).collect()
    }

    #[test]
    fn floats_are_the_nearest_ones() {
        for seed in 0..4000 {
            let numbers = numbers([4, 15, 16, 19][seed % 4], seed as u64);
            let bits = |number: &String| number.parse::<f64>().map(f64::to_bits);
            let expected: Vec<u64> =
                numbers.iter().map(bits).map(|bits| bits.expect("a number")).collect();
            assert_eq!(floats(&numbers), Some(expected), "{numbers:?}");
        }
    }

    #[test]
    fn one_number_of_another_kind_is_enough_to_refuse_all() {
        for wrong in [
            "",
            "-",
            ".",
            "-.",
            "5",
            "1.2.3",
            "1..2",
            "+1.5",
            "1.5e3",
            "--1.5",
            "1,5",
            "1.5 ",
            " 1.5",
            "12345678901234567890.",
            "1.2345678901234567890",
            "x.5",
            "1.x",
            "1:5",
            "1.5\u{fa}",
            "1.123456789.2",
            ".12345678.",
            "nan",
        ] {
            for lane in [0, 7, LANES - 1] {
                let mut numbers = numbers(15, 5);
                numbers[lane] = wrong.to_owned();
                assert_eq!(floats(&numbers), None, "{wrong:?}");
            }
        }
    }

    #[test]
    fn integers_have_up_to_sixteen_digits() {
        let integers = |numbers: &[String]| with_places(numbers, |places| asked(places).1);
        let mut numbers: Vec<i64> = (0..LANES as i64).map(|n| (n - 5) * 1111).collect();
        for (lane, most) in [(3, 99_999_999), (4, -9_999_999_999_999_999)] {
            numbers[lane] = most;
            let texts: Vec<String> = numbers.iter().map(i64::to_string).collect();
            assert_eq!(integers(&texts).map(Vec::from), Some(numbers.clone()));
            for wrong in ["", "-", "1.5", "1e3", "x", "+1", "12345678901234567", "1 "] {
                let mut texts = texts.clone();
                texts[9] = wrong.to_owned();
                assert_eq!(integers(&texts), None, "{wrong:?}");
            }
        }
    }
}
