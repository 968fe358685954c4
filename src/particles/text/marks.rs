//! Where the values of a text begin, found before any of them is parsed.
//!
//! A parser that learns where a value begins from the end of the one before waits for each. With
//! all beginnings known, a processor works on several values at once (as in Langdale and Lemire,
//! "Parsing gigabytes of JSON per second", 2019).

use crate::math::Isa;
use crate::math::bytes::{self, ByteKernel, ByteOps, WORD};

/// What separates values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::particles) enum Separator {
    /// White space, any number of bytes. A value begins with another byte after it.
    Blanks,
    /// This byte, or the end of a line. A value begins with the byte after it, whatever that is.
    Delimiter(u8),
}

/// Where the values of a text begin. The memory is used again for the next text.
#[derive(Debug, Default)]
pub(in crate::particles) struct Marks {
    starts: Vec<u32>,
    count: usize,
    /// As many pairs as any word of the text has had. Most words have about as many, so these are
    /// stored without asking how many there are.
    pairs: usize,
}

/// A line within a text, with the beginnings of values.
#[derive(Clone, Copy)]
pub(in crate::particles) struct MarkedRow<'t> {
    /// Whole lines.
    pub(in crate::particles) text: &'t [u8],
    /// Where the line begins.
    pub(in crate::particles) start: usize,
    /// Where its values and those of the lines after it begin.
    pub(in crate::particles) marks: &'t [u32],
}

impl<'t> MarkedRow<'t> {
    /// The line, and those after it.
    pub(in crate::particles) fn lines(&self) -> &'t [u8] {
        &self.text[self.start..]
    }
}

impl Marks {
    /// Marks the values of a text below 4 GiB, which begins with a line.
    pub(in crate::particles) fn mark(&mut self, text: &[u8], separator: Separator, isa: Isa) {
        bytes::run(isa, Marking { to: self, text, separator });
    }

    /// The beginnings, in order. A delimiter at the end of the text has one after it.
    pub(in crate::particles) fn starts(&self) -> &[u32] {
        &self.starts[..self.count]
    }

    #[inline(always)]
    fn mark_all(&mut self, text: &[u8], separator: Separator, ops: impl ByteOps) {
        (self.count, self.pairs) = (0, 0);
        // A line begins like what follows a separator.
        let mut carry = 1;
        let words = text.chunks_exact(WORD);
        let rest = words.remainder();
        let mut base = 0;
        for word in words {
            let Some(word) = word.first_chunk() else { break };
            let separators = separator.places(word, ops);
            self.push(base, separator.beginnings(separators, separators << 1 | carry));
            carry = separators >> (WORD - 1);
            base += WORD as u32;
        }
        // Zeros are blanks.
        let mut last = [0; WORD];
        last[..rest.len()].copy_from_slice(rest);
        let separators = separator.places(&last, ops);
        // With the end of the text, where a value may begin that has no bytes.
        let is_inside = (2u64 << rest.len()).wrapping_sub(1);
        let beginnings = separator.beginnings(separators, separators << 1 | carry);
        self.push(base, beginnings & is_inside);
    }

    /// Adds the beginnings in a word.
    #[inline(always)]
    fn push(&mut self, base: u32, bits: u64) {
        if self.starts.len() < self.count + WORD {
            self.starts.resize((2 * self.starts.len()).max(1 << 10), 0);
        }
        let Some(to) = self.starts[self.count..].first_chunk_mut::<WORD>() else { return };
        let count = bits.count_ones() as usize;
        self.pairs = self.pairs.max(count.div_ceil(2));
        // Those after the last one are overwritten.
        match self.pairs {
            0..=2 => store::<4>(to, base, bits),
            3 => store::<6>(to, base, bits),
            4 => store::<8>(to, base, bits),
            5 => store::<10>(to, base, bits),
            6 => store::<12>(to, base, bits),
            _ => store::<WORD>(to, base, bits),
        }
        self.count += count;
    }
}

/// Stores the first beginnings in a word, and some that are none.
#[inline(always)]
fn store<const MOST: usize>(to: &mut [u32; WORD], base: u32, mut bits: u64) {
    for start in &mut to[..MOST] {
        *start = base + bits.trailing_zeros();
        bits &= bits.wrapping_sub(1);
    }
}

impl Separator {
    /// The bits of separators in a word.
    #[inline(always)]
    fn places(self, word: &[u8; WORD], ops: impl ByteOps) -> u64 {
        match self {
            Self::Blanks => ops.at_most(word, b' '),
            Self::Delimiter(byte) => ops.equal(word, byte) | ops.equal(word, b'\n'),
        }
    }

    /// The bits of beginnings, from those of separators and of what follows them.
    #[inline(always)]
    fn beginnings(self, separators: u64, follows: u64) -> u64 {
        match self {
            Self::Blanks => follows & !separators,
            Self::Delimiter(_) => follows,
        }
    }
}

/// Marks a text with vector instructions.
struct Marking<'a> {
    to: &'a mut Marks,
    text: &'a [u8],
    separator: Separator,
}

impl ByteKernel for Marking<'_> {
    #[inline(always)]
    fn run(self, ops: impl ByteOps) {
        self.to.mark_all(self.text, self.separator, ops);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn starts(text: &str, separator: Separator) -> Vec<u32> {
        let mut marks = Marks::default();
        marks.mark(text.as_bytes(), separator, Isa::best());
        marks.starts().to_vec()
    }

    /// What [`Marks`] should find, byte by byte.
    fn expected(text: &str, separator: Separator) -> Vec<u32> {
        let bytes = text.as_bytes();
        let is_separator = |at: usize| match separator {
            Separator::Blanks => bytes[at] <= b' ',
            Separator::Delimiter(delimiter) => bytes[at] == delimiter || bytes[at] == b'\n',
        };
        let begins = |at: &usize| {
            let follows = *at == 0 || is_separator(at - 1);
            let is_blank =
                separator == Separator::Blanks && (*at == bytes.len() || is_separator(*at));
            follows && !is_blank
        };
        (0..=bytes.len()).filter(begins).map(|at| at as u32).collect()
    }

    #[test]
    fn values_begin_after_separators() {
        assert_eq!(starts(" a  bc\r\nd\n", Separator::Blanks), [1, 4, 8]);
        assert_eq!(starts("a,,b c\nd,\n", Separator::Delimiter(b',')), [0, 2, 3, 7, 9, 10]);
    }

    #[test]
    fn texts_of_any_length_have_their_marks() {
        let mut state = 1u32;
        for length in 0..400 {
            let text: String = (0..length)
                .map(|_| {
                    state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                    [' ', ',', '\n', '\t', '7', '7', 'x', '.'][(state >> 29) as usize]
                })
                .collect();
            for text in [&text, &text.replace([' ', '\n', '\t'], "8"), &",".repeat(length)] {
                for separator in [Separator::Blanks, Separator::Delimiter(b',')] {
                    assert_eq!(starts(text, separator), expected(text, separator), "{text:?}");
                }
            }
        }
    }
}
