//! Numbers of a column in many rows at once.
//!
//! The end of each is known, so its digits before and after the point are loaded into words without
//! asking how many there are, and those of several numbers are made numbers by vector instructions.
//! Values are those of [`super::decimal`], to the bit.

use crate::math::bytes::ByteOps;

use super::decimal::{POWERS, POWERS_OF_TEN, ZEROS, nearest_quotient, short_float};
use super::number::integer;

/// Rows at once.
pub(super) const LANES: usize = 16;

/// Numbers at once.
const FOUR: usize = 4;

/// A byte in each place of a word.
const ONES: u64 = 0x0101_0101_0101_0101;

/// A value for each lane.
pub(super) type Lanes<T> = [T; LANES];

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

/// Decimal numbers whose points were found, except the odd ones.
#[derive(Default)]
struct Pointed {
    /// Digits before the points, of which there are one to seven.
    wholes: [u64; FOUR],
    /// Where those after them begin, and where they end.
    starts: [usize; FOUR],
    ends: [usize; FOUR],
    /// How many digits are after the points, one to sixteen.
    decimals: [usize; FOUR],
    has_long: bool,
    /// The bits of minus signs.
    signs: [u64; FOUR],
    /// A bit for each number of another form, which has no digits here.
    odd: u32,
}

impl Places<'_> {
    /// Where the value of a row begins and ends.
    #[inline(always)]
    pub(super) fn of(&self, row: usize) -> (usize, usize) {
        let mark = row * self.stride + self.at;
        (self.marks[mark] as usize, self.marks[mark + 1] as usize - 1)
    }

    /// Decimal numbers without an exponent; `None` if one is something else.
    #[inline(always)]
    pub(super) fn floats(&self, ops: impl ByteOps) -> Option<Lanes<f64>> {
        match self.alike(ops) {
            Some(values) => Some(values),
            None => self.different(ops),
        }
    }

    /// Numbers that all have as many decimals as the first, at most eight.
    #[inline(always)]
    fn alike(&self, ops: impl ByteOps) -> Option<Lanes<f64>> {
        let (_, end) = self.of(0);
        let decimals = self.text[..end].iter().rev().take(9).position(|byte| *byte == b'.')?;
        let power = *POWERS.get(decimals)?;
        // A number has a digit.
        let least = usize::from(decimals == 0);
        let mut values = [0.0; LANES];
        for (group, values) in values.chunks_exact_mut(FOUR).enumerate() {
            let (mut texts, mut wholes, mut signs) = ([&[0; 16]; FOUR], [0; FOUR], [0; FOUR]);
            for lane in 0..FOUR {
                let (start, end) = self.of(FOUR * group + lane);
                let is_negative = self.text[start] == b'-';
                signs[lane] = u64::from(is_negative) << 63;
                let from = start + usize::from(is_negative);
                wholes[lane] = end.wrapping_sub(1 + decimals + from);
                if wholes[lane].wrapping_sub(least) > 7 - least {
                    return None;
                }
                texts[lane] = self.text.get(..end)?.last_chunk()?;
            }
            let numbers = ops.pointed(texts, wholes, decimals)?;
            for lane in 0..FOUR {
                let [whole, fraction] = [numbers[2 * lane], numbers[2 * lane + 1]];
                let value = (f64::from(whole as i32) * power + f64::from(fraction as i32)) / power;
                values[lane] = f64::from_bits(value.to_bits() | signs[lane]);
            }
        }
        Some(values)
    }

    /// Numbers of any length.
    #[inline(always)]
    fn different(&self, ops: impl ByteOps) -> Option<Lanes<f64>> {
        let mut values = [0.0; LANES];
        for (group, to) in values.chunks_exact_mut(FOUR).enumerate() {
            let first = FOUR * group;
            let numbers = self.pointed(first)?;
            let magnitudes = match numbers.has_long {
                true => self.long(&numbers, ops)?,
                false => self.short(&numbers, ops)?,
            };
            for lane in 0..FOUR {
                to[lane] = f64::from_bits(magnitudes[lane].to_bits() | numbers.signs[lane]);
            }
            if numbers.odd != 0 {
                self.replace_odd(first, numbers.odd, to)?;
            }
        }
        Some(values)
    }

    /// Finds the points of the numbers from a row on.
    #[inline(always)]
    fn pointed(&self, first: usize) -> Option<Pointed> {
        let mut all = Pointed::default();
        for lane in 0..FOUR {
            let (start, end) = self.of(first + lane);
            let is_negative = self.text[start] == b'-';
            let from = start + usize::from(is_negative);
            let word = self.word(from)?;
            let others = word ^ (u64::from(b'.') * ONES);
            // The lowest bit found is that of the first byte that became 0.
            let point = (others.wrapping_sub(ONES) & !others & (0x80 * ONES)).trailing_zeros();
            let whole = point as usize / 8;
            let decimals = end.wrapping_sub(from + whole + 1);
            all.ends[lane] = end;
            if whole.wrapping_sub(1) > 6 || decimals.wrapping_sub(1) > 15 {
                all.odd |= 1 << lane;
                continue;
            }
            all.wholes[lane] = (word ^ ZEROS).wrapping_shl(71 - point);
            all.starts[lane] = from + whole + 1;
            all.decimals[lane] = decimals;
            all.has_long |= decimals > 8;
            all.signs[lane] = u64::from(is_negative) << 63;
        }
        Some(all)
    }

    /// Values without their signs, of at most 15 digits, which are exact.
    #[inline(always)]
    fn short(&self, of: &Pointed, ops: impl ByteOps) -> Option<[f64; FOUR]> {
        let mut words = [0; 2 * FOUR];
        for lane in 0..FOUR {
            words[2 * lane] = of.wholes[lane];
            words[2 * lane + 1] = first_digits(self.word(of.starts[lane])?, of.decimals[lane]);
        }
        let numbers = ops.eights(&words)?;
        let mut values = [0.0; FOUR];
        for lane in 0..FOUR {
            let power = POWERS[of.decimals[lane] & 15];
            let [whole, fraction] = [numbers[2 * lane], numbers[2 * lane + 1]];
            values[lane] = (f64::from(whole as i32) * power + f64::from(fraction as i32)) / power;
        }
        Some(values)
    }

    /// Values of more digits without their signs.
    #[inline(always)]
    fn long(&self, of: &Pointed, ops: impl ByteOps) -> Option<[f64; FOUR]> {
        let [a, b, c, d] = of.ends;
        let text = |end: usize| self.text.get(..end)?.last_chunk();
        let fractions = ops.sixteens([text(a)?, text(b)?, text(c)?, text(d)?], of.decimals)?;
        let [a, b, c, d] = of.wholes;
        let wholes = ops.eights(&[a, b, c, d, 0, 0, 0, 0])?;
        let mut values = [0.0; FOUR];
        for lane in 0..FOUR {
            let (whole, decimals) = (u64::from(wholes[lane]), of.decimals[lane]);
            let mantissa = whole.checked_mul(*POWERS_OF_TEN.get(decimals)?)?;
            let mantissa = mantissa.checked_add(fractions[lane])?;
            values[lane] = match mantissa {
                0 => 0.0,
                _ => nearest_quotient(mantissa, decimals),
            };
        }
        Some(values)
    }

    /// Parses the odd ones of decimal numbers.
    #[cold]
    #[inline(never)]
    fn replace_odd(self, first: usize, odd: u32, to: &mut [f64]) -> Option<()> {
        for (lane, to) in to.iter_mut().enumerate().filter(|(lane, _)| odd >> lane & 1 == 1) {
            let (start, end) = self.of(first + lane);
            let (value, length) = short_float(&self.text[start..])?;
            *to = Some(value).filter(|_| start + length == end)?;
        }
        Some(())
    }

    /// Integers that fit into 64 bits; `None` if one is something else.
    #[inline(always)]
    pub(super) fn integers(&self, ops: impl ByteOps) -> Option<Lanes<i64>> {
        let mut values = [0; LANES];
        for (group, to) in values.chunks_exact_mut(2 * FOUR).enumerate() {
            let first = 2 * FOUR * group;
            let (mut words, mut signs, mut odd) = ([0; 2 * FOUR], [0; 2 * FOUR], 0);
            for lane in 0..2 * FOUR {
                let (start, end) = self.of(first + lane);
                let is_negative = self.text[start] == b'-';
                let from = start + usize::from(is_negative);
                let digits = end.wrapping_sub(from);
                if digits.wrapping_sub(1) >= 8 {
                    odd |= 1 << lane;
                    continue;
                }
                words[lane] = first_digits(self.word(from)?, digits);
                signs[lane] = -i64::from(is_negative);
            }
            let numbers = ops.eights(&words)?;
            for lane in 0..2 * FOUR {
                to[lane] = (i64::from(numbers[lane]) ^ signs[lane]) - signs[lane];
            }
            if odd != 0 {
                self.replace_odd_integers(first, odd, to)?;
            }
        }
        Some(values)
    }

    /// Parses the odd ones of the integers from a row on.
    #[cold]
    #[inline(never)]
    fn replace_odd_integers(self, first: usize, odd: u32, to: &mut [i64]) -> Option<()> {
        for (lane, to) in to.iter_mut().enumerate().filter(|(lane, _)| odd >> lane & 1 == 1) {
            let (start, end) = self.of(first + lane);
            *to = integer(self.text.get(start..end)?)?;
        }
        Some(())
    }

    /// Eight bytes of the text.
    #[inline(always)]
    fn word(&self, at: usize) -> Option<u64> {
        Some(u64::from_le_bytes(*self.text.get(at..)?.first_chunk()?))
    }
}

/// The first digits of a word, at most eight, behind zeros.
#[inline(always)]
fn first_digits(word: u64, count: usize) -> u64 {
    // Twice, because a shift by 64 bits is none.
    let half = 32 - 4 * count as u32;
    (word ^ ZEROS).wrapping_shl(half).wrapping_shl(half)
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
            *self.integers = self.places.integers(ops);
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

    /// One number in each row, between bytes that belong to none.
    fn with_places<T>(numbers: &[String], use_of: impl Fn(Places<'_>) -> T) -> T {
        let others = ".7".repeat(16);
        let text = format!("{others}\n{}\n{others}\n", numbers.join("\n"));
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
            let dot = if random() % 50 > 0 || point < digits.len() { "." } else { "" };
            format!("{sign}{}{dot}{}", &digits[..point], &digits[point..])
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
    fn floats_with_equal_decimals_are_the_nearest_ones() {
        for seed in 0..2000 {
            let decimals = seed % 9;
            let number = |number: &String| {
                let number: f64 = number.parse().expect("a number");
                let number = number % 10f64.powi(1 + (seed / 9 % 7) as i32);
                let dot = if decimals == 0 { "." } else { "" };
                format!("{number:.decimals$}{dot}")
            };
            let numbers: Vec<String> = numbers(15, seed as u64).iter().map(number).collect();
            let expected: Vec<u64> =
                numbers.iter().map(|n| n.parse::<f64>().expect("a number").to_bits()).collect();
            assert_eq!(floats(&numbers), Some(expected), "{numbers:?}");
            for wrong in [".", "-.", "-", "12", "1x.5", "1.x", "1..", "--1.5", "1234567.123456789x"]
            {
                let mut numbers = numbers.clone();
                numbers[seed % LANES] = wrong.to_owned();
                let expected = (wrong == "12").then_some(12f64.to_bits());
                assert_eq!(floats(&numbers).map(|all| all[seed % LANES]), expected, "{wrong:?}");
            }
        }
    }

    #[test]
    fn one_number_of_another_kind_is_enough_to_refuse_all() {
        for wrong in [
            "",
            "-",
            ".",
            "-.",
            "1.2.3",
            "1..2",
            "+1.5",
            "1.5e3",
            "--1.5",
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
    fn integers_fit_into_64_bits() {
        let integers = |numbers: &[String]| with_places(numbers, |places| asked(places).1);
        let mut numbers: Vec<i64> = (0..LANES as i64).map(|n| (n - 5) * 1111).collect();
        for (lane, most) in [(3, 99_999_999), (4, -9_999_999_999_999_999), (5, i64::MAX)] {
            numbers[lane] = most;
            let texts: Vec<String> = numbers.iter().map(i64::to_string).collect();
            assert_eq!(integers(&texts).map(Vec::from), Some(numbers.clone()));
            for wrong in ["", "-", "1.5", "1e3", "x", "+1", "9223372036854775808", "1 "] {
                let mut texts = texts.clone();
                texts[9] = wrong.to_owned();
                assert_eq!(integers(&texts), None, "{wrong:?}");
            }
        }
    }
}
