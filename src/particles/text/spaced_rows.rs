//! Rows of values between white space.

use super::batch::Batch;
use super::decimal::{leading_digits, short_float};
use super::fields::{FieldUse, Fields};
use super::line_parser::LineParser;
use super::marks::{MarkedRow, Separator};
use super::number::{float, tokens};
use super::row_values::RowValues;
use super::values::Values;

/// Parses rows of values between white space.
pub(in crate::particles) struct SpacedRows {
    values: RowValues,
    /// Values up to here are parsed.
    last: usize,
    allows_more: bool,
    has_quotes: bool,
}

impl SpacedRows {
    /// Parses these values; a row may have more if `allows_more`.
    pub(in crate::particles) fn new(fields: &Fields, allows_more: bool) -> Self {
        let values = RowValues::new(fields);
        let is_used = |is: &FieldUse| *is != FieldUse::Skipped;
        let last = values.uses.iter().rposition(is_used).map_or(0, |last| last + 1);
        Self { values, last, allows_more, has_quotes: false }
    }

    /// A value may be in single or double quotes, which end before white space.
    #[must_use]
    pub(in crate::particles) fn with_quotes(self) -> Self {
        Self { has_quotes: true, ..self }
    }

    #[inline]
    fn next<'l>(&self, rest: &mut &'l [u8]) -> &'l [u8] {
        if self.has_quotes {
            let start = rest.trim_ascii_start();
            if let Some(quote @ (b'\'' | b'"')) = start.first() {
                return quoted(&start[1..], *quote, rest);
            }
        }
        next_token(rest)
    }

    /// The value that should have been a number, after an error.
    pub(in crate::particles) fn wrong_field(&self) -> Option<usize> {
        self.values.wrong_field()
    }

    #[cold]
    fn wrong_count(&self, line: &[u8]) -> String {
        self.values.wrong_count(tokens(line).count())
    }
}

impl LineParser for SpacedRows {
    fn parse(&self, line: &[u8], to: &mut Batch) -> Result<(), String> {
        let mut rest = line;
        let mut position = [0.0; 3];
        let mut columns = to.columns.iter_mut();
        for (at, is) in self.values.uses[..self.last].iter().enumerate() {
            let token = self.next(&mut rest);
            if token.is_empty() {
                return Err(self.wrong_count(line));
            }
            let is_right = match is {
                FieldUse::Skipped => true,
                FieldUse::Position(axis) => {
                    position[*axis] = float(token).unwrap_or(f64::NAN);
                    position[*axis].is_finite()
                }
                FieldUse::Column(_) => columns.next().is_some_and(|column| column.push(token)),
            };
            if !is_right {
                return Err(self.values.wrong_value(at, token));
            }
        }
        for _ in self.last..self.values.uses.len() {
            if self.next(&mut rest).is_empty() {
                return Err(self.wrong_count(line));
            }
        }
        if !self.allows_more && !self.next(&mut rest).is_empty() {
            return Err(self.wrong_count(line));
        }
        to.positions.push(position);
        Ok(())
    }

    fn separator(&self) -> Option<Separator> {
        (!self.has_quotes).then_some(Separator::Blanks)
    }

    fn values(&self) -> Option<&[FieldUse]> {
        (!self.has_quotes).then_some(&self.values.uses)
    }

    fn parse_quickly(&self, row: MarkedRow<'_>, to: &mut Batch) -> Option<usize> {
        let MarkedRow { text, start, marks } = row;
        let uses = &self.values.uses[..];
        let marks = marks.get(..uses.len())?;
        // Where the last value ends that was parsed.
        let mut end = start;
        let mut position = [0.0; 3];
        let mut columns = to.columns.iter_mut();
        for (is, &at) in uses[..self.last].iter().zip(marks) {
            let at = at as usize;
            let length = match is {
                FieldUse::Skipped => continue,
                FieldUse::Position(axis) => {
                    let (value, length) = short_float(&text[at..])?;
                    position[*axis] = value;
                    length
                }
                FieldUse::Column(_) => push_quickly(columns.next()?, &text[at..], token_length)?,
            };
            if has_line_end(&text[end..at]) {
                return None;
            }
            end = at + length;
            if *text.get(end)? > b' ' {
                return None;
            }
        }
        if self.last < uses.len() {
            let at = *marks.last()? as usize;
            if has_line_end(&text[end..at]) {
                return None;
            }
            end = at + token_length(&text[at..]);
        }
        end = skip_blanks(text, end);
        if self.allows_more && end < text.len() && text[end] > b' ' {
            end += memchr::memchr(b'\n', &text[end..])?;
        }
        if text.get(end)? != &b'\n' {
            return None;
        }
        to.positions.push(position);
        Some(end + 1)
    }
}

/// Appends the value at the beginning of a text, if it is a common one for the column; returns its
/// length. A word has the length that a function finds.
#[inline(always)]
pub(in crate::particles) fn push_quickly(
    column: &mut Values,
    text: &[u8],
    word_length: impl Fn(&[u8]) -> usize,
) -> Option<usize> {
    match column {
        Values::F64(values) => {
            let (value, length) = short_float(text)?;
            values.push(value);
            Some(length)
        }
        Values::I32(values) => {
            let (value, length) = short_integer(text)?;
            values.push(i32::try_from(value).ok()?);
            Some(length)
        }
        Values::I64(values) => {
            let (value, length) = short_integer(text)?;
            values.push(value);
            Some(length)
        }
        Values::Text(words) => {
            let length = word_length(text);
            words.push(&text[..length]);
            Some(length)
        }
    }
}

/// An integer of at most 18 digits at the beginning of a text, and its length.
#[inline(always)]
fn short_integer(text: &[u8]) -> Option<(i64, usize)> {
    const MAX_DIGITS: usize = 18;
    let start = usize::from(text.first() == Some(&b'-'));
    let (value, count) = leading_digits(&text[start..], 0);
    let value = (1..=MAX_DIGITS).contains(&count).then_some(value as i64)?;
    Some((if start == 1 { -value } else { value }, start + count))
}

/// Moves past white space within a line.
#[inline(always)]
fn skip_blanks(text: &[u8], mut at: usize) -> usize {
    while text.get(at).is_some_and(|&byte| byte <= b' ' && byte != b'\n') {
        at += 1;
    }
    at
}

/// Returns true if a line ends between two values.
#[inline(always)]
fn has_line_end(gap: &[u8]) -> bool {
    match gap {
        [] => false,
        [blank] => *blank == b'\n',
        _ => memchr::memchr(b'\n', gap).is_some(),
    }
}

/// Length of the token at the beginning of a text.
#[inline(always)]
fn token_length(text: &[u8]) -> usize {
    text.iter().position(|&byte| byte <= b' ').unwrap_or(text.len())
}

/// Takes the next token off a line; empty at its end.
#[inline]
fn next_token<'l>(rest: &mut &'l [u8]) -> &'l [u8] {
    let is_space = |byte: u8| byte <= b' ';
    let start = rest.iter().position(|&byte| !is_space(byte)).unwrap_or(rest.len());
    let text = &rest[start..];
    let end = text.iter().position(|&byte| is_space(byte)).unwrap_or(text.len());
    *rest = &text[end..];
    &text[..end]
}

/// A value after its opening quote, which ends at such a quote before white space.
#[cold]
fn quoted<'l>(text: &'l [u8], quote: u8, rest: &mut &'l [u8]) -> &'l [u8] {
    let is_close = |at: usize| text[at] == quote && text.get(at + 1).is_none_or(|&b| b <= b' ');
    let close = (0..text.len()).find(|&at| is_close(at)).unwrap_or(text.len());
    *rest = text.get(close + 1..).unwrap_or_default();
    &text[..close]
}
