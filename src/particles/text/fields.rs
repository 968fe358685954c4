//! Rows of values between white space, where a header says what each value is.

use std::sync::atomic::{AtomicUsize, Ordering};

use crate::particles::request::{ColumnInfo, ColumnKind, Wanted};
use crate::particles::trouble::{Trouble, plural, shown};

use super::batch::{Batch, Kind};
use super::number::{float, short_float, tokens};
use super::rows::LineParser;

/// The values of a row.
#[derive(Clone, Debug, Default, PartialEq)]
pub(in crate::particles) struct Fields(pub(in crate::particles) Vec<Field>);

/// One value of a row.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::particles) struct Field {
    /// The name.
    pub(in crate::particles) name: String,
    /// What becomes of it.
    pub(in crate::particles) is: FieldUse,
}

/// What a value of a row is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::particles) enum FieldUse {
    /// A coordinate: 0 for x, 1 for y, 2 for z.
    Position(usize),
    /// A value of a column.
    Column(Kind),
    /// Left out.
    Skipped,
}

impl Field {
    /// A value of a column.
    pub(in crate::particles) fn column(name: impl Into<String>, kind: Kind) -> Self {
        Self { name: name.into(), is: FieldUse::Column(kind) }
    }

    /// A coordinate.
    pub(in crate::particles) fn position(axis: usize) -> Self {
        Self { name: ["x", "y", "z"][axis].to_owned(), is: FieldUse::Position(axis) }
    }
}

impl Fields {
    /// Describes the columns, without the positions.
    pub(in crate::particles) fn infos(&self) -> Vec<ColumnInfo> {
        let info = |field: &Field| {
            let FieldUse::Column(kind) = field.is else { return None };
            let kind = match kind {
                Kind::I32 | Kind::I64 => ColumnKind::Integer,
                Kind::F64 => ColumnKind::Float,
                Kind::Text => ColumnKind::Text,
            };
            Some(ColumnInfo { name: field.name.clone(), kind, range: None })
        };
        self.0.iter().filter_map(info).collect()
    }

    /// Changes numbers to words, and integers to floats, where the values of a row are such.
    pub(in crate::particles) fn refine(&mut self, row: &[u8]) {
        for (field, token) in self.0.iter_mut().zip(tokens(row)) {
            if let FieldUse::Column(kind) = &mut field.is {
                if float(token).is_none() {
                    *kind = Kind::Text;
                } else if *kind == Kind::I32 && super::number::integer(token).is_none() {
                    *kind = Kind::F64;
                }
            }
        }
    }

    /// Leaves out the columns that are not wanted.
    ///
    /// # Errors
    /// If a wanted one does not exist.
    pub(in crate::particles) fn select(mut self, wanted: &Wanted) -> Result<Self, Trouble> {
        wanted.check(self.infos().iter().map(|info| &*info.name))?;
        for field in &mut self.0 {
            if matches!(field.is, FieldUse::Column(_)) && !wanted.has(&field.name) {
                field.is = FieldUse::Skipped;
            }
        }
        Ok(self)
    }

    /// The kinds of the columns.
    pub(in crate::particles) fn kinds(&self) -> impl Iterator<Item = Kind> {
        let kind = |field: &Field| match field.is {
            FieldUse::Column(kind) => Some(kind),
            _ => None,
        };
        self.0.iter().filter_map(kind)
    }

    /// The names of the columns.
    pub(in crate::particles) fn names(&self) -> impl Iterator<Item = &str> {
        let is_column = |field: &&Field| matches!(field.is, FieldUse::Column(_));
        self.0.iter().filter(is_column).map(|field| &*field.name)
    }
}

/// Parses rows of values between white space.
pub(in crate::particles) struct SpacedRows {
    uses: Vec<FieldUse>,
    names: Vec<String>,
    /// Values up to here are parsed.
    last: usize,
    allows_more: bool,
    has_quotes: bool,
    /// The value that should have been a number, after an error.
    wrong: AtomicUsize,
}

impl SpacedRows {
    /// Parses these values; a row may have more if `allows_more`.
    pub(in crate::particles) fn new(fields: &Fields, allows_more: bool) -> Self {
        let uses: Vec<_> = fields.0.iter().map(|field| field.is).collect();
        let names = fields.0.iter().map(|field| field.name.clone()).collect();
        let is_used = |is: &FieldUse| *is != FieldUse::Skipped;
        let last = uses.iter().rposition(is_used).map_or(0, |last| last + 1);
        let wrong = AtomicUsize::new(usize::MAX);
        Self { uses, names, last, allows_more, has_quotes: false, wrong }
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
        Some(self.wrong.load(Ordering::Relaxed)).filter(|&at| at != usize::MAX)
    }

    /// The names of all values from one on.
    fn missing(&self, from: usize) -> String {
        let names: Vec<&str> = self.names[from..].iter().take(6).map(|name| &**name).collect();
        let more = if self.names.len() - from > 6 { " ..." } else { "" };
        format!("{}{more}", names.join(" "))
    }

    #[cold]
    fn wrong_count(&self, line: &[u8]) -> String {
        let found = tokens(line).count();
        let expected = plural(self.uses.len() as u64, "value");
        if found < self.uses.len() {
            let verb = if self.uses.len() - found == 1 { "is" } else { "are" };
            format!("expected {expected}, found {found} ({} {verb} missing)", self.missing(found))
        } else {
            format!("expected {expected}, found {found}")
        }
    }

    #[cold]
    fn wrong_value(&self, at: usize, token: &[u8]) -> String {
        let what = match self.uses[at] {
            FieldUse::Position(_) => "a finite number",
            _ => {
                self.wrong.store(at, Ordering::Relaxed);
                "a number"
            }
        };
        format!("expected {what} for `{}`, found {}", self.names[at], shown(token))
    }
}

impl LineParser for SpacedRows {
    fn parse(&self, line: &[u8], to: &mut Batch) -> Result<(), String> {
        let mut rest = line;
        let mut position = [0.0; 3];
        let mut columns = to.columns.iter_mut();
        for (at, is) in self.uses[..self.last].iter().enumerate() {
            if *is == FieldUse::Column(Kind::F64) || matches!(is, FieldUse::Position(_)) {
                if let Some(value) = short_number(&mut rest) {
                    match is {
                        FieldUse::Position(axis) => position[*axis] = value,
                        _ => columns.next().into_iter().for_each(|c| c.push_float(value)),
                    }
                    continue;
                }
            }
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
                return Err(self.wrong_value(at, token));
            }
        }
        for _ in self.last..self.uses.len() {
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
}

/// Takes the next token off a line, if it is a number that is quick to read.
#[inline]
fn short_number(rest: &mut &[u8]) -> Option<f64> {
    let start = rest.iter().position(|&byte| byte > b' ')?;
    let (value, length) = short_float(&rest[start..])?;
    let after = &rest[start + length..];
    if after.first().is_some_and(|&byte| byte > b' ') {
        return None;
    }
    *rest = after;
    Some(value)
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
