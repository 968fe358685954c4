//! Rows of a table.

use crate::particles::text::{
    Batch, FieldUse, Fields, LineParser, MarkedRow, RowValues, Separator, float, float_with_comma,
    push_quickly, short_float,
};

/// Parses rows with a delimiter. Empty lines and comments are left out.
pub(super) struct DelimitedRows {
    values: RowValues,
    delimiter: u8,
    has_decimal_comma: bool,
}

/// Parses rows of another kind. Empty lines and comments are left out.
pub(super) struct Commented<P>(pub(super) P);

impl<P: LineParser> LineParser for Commented<P> {
    fn parse(&self, line: &[u8], to: &mut Batch) -> Result<(), String> {
        if is_comment(line) { Ok(()) } else { self.0.parse(line, to) }
    }

    fn separator(&self) -> Option<Separator> {
        self.0.separator()
    }

    fn values(&self) -> Option<&[FieldUse]> {
        self.0.values()
    }

    fn parse_quickly(&self, row: MarkedRow<'_>, to: &mut Batch) -> Option<usize> {
        if may_be_comment(row.lines()) { None } else { self.0.parse_quickly(row, to) }
    }
}

/// Returns true if the line at the beginning of a text may be a comment.
#[inline]
fn may_be_comment(text: &[u8]) -> bool {
    let start = text.iter().find(|byte| **byte != b' ');
    start.is_none_or(|start| matches!(start, b'#' | b'/' | b'\n' | b'\r' | b'\t'))
}

/// Returns true for empty lines and comments.
pub(super) fn is_comment(line: &[u8]) -> bool {
    let start = line.trim_ascii_start();
    start.is_empty() || start[0] == b'#' || start.starts_with(b"//")
}

impl DelimitedRows {
    pub(super) fn new(fields: &Fields, delimiter: u8, has_decimal_comma: bool) -> Self {
        Self { values: RowValues::new(fields), delimiter, has_decimal_comma }
    }

    /// The value that should have been a number, after an error.
    pub(super) fn wrong_field(&self) -> Option<usize> {
        self.values.wrong_field()
    }

    fn number(&self, token: &[u8]) -> Option<f64> {
        if self.has_decimal_comma { float_with_comma(token) } else { float(token) }
    }

    #[cold]
    fn wrong_count(&self, line: &[u8]) -> String {
        self.values.wrong_count(Cells::new(line, self.delimiter).count())
    }
}

impl LineParser for DelimitedRows {
    fn parse(&self, line: &[u8], to: &mut Batch) -> Result<(), String> {
        if is_comment(line) {
            return Ok(());
        }
        let mut cells = Cells::new(line, self.delimiter);
        let mut position = [0.0; 3];
        let mut columns = to.columns.iter_mut();
        for (at, is) in self.values.uses.iter().enumerate() {
            let Some(cell) = cells.next() else { return Err(self.wrong_count(line)) };
            let is_right = match is {
                FieldUse::Skipped => true,
                FieldUse::Position(axis) => {
                    position[*axis] = self.number(cell).unwrap_or(f64::NAN);
                    position[*axis].is_finite()
                }
                FieldUse::Column(_) => columns.next().is_some_and(|column| {
                    let is_comma = self.has_decimal_comma && !column.is_text();
                    match is_comma.then(|| float_with_comma(cell)).flatten() {
                        Some(value) if cell.contains(&b',') => {
                            column.push_float(value);
                            true
                        }
                        _ => column.push(cell),
                    }
                }),
            };
            if !is_right {
                return Err(self.values.wrong_value(at, cell));
            }
        }
        if cells.next().is_some() {
            return Err(self.wrong_count(line));
        }
        to.positions.push(position);
        Ok(())
    }

    fn separator(&self) -> Option<Separator> {
        (!self.has_decimal_comma).then_some(Separator::Delimiter(self.delimiter))
    }

    fn values(&self) -> Option<&[FieldUse]> {
        (!self.has_decimal_comma).then_some(&self.values.uses)
    }

    fn parse_quickly(&self, row: MarkedRow<'_>, to: &mut Batch) -> Option<usize> {
        if may_be_comment(row.lines()) {
            return None;
        }
        let (text, uses) = (row.text, &self.values.uses[..]);
        // The last one is where the next line begins.
        let marks = row.marks.get(..=uses.len())?;
        let mut position = [0.0; 3];
        let mut columns = to.columns.iter_mut();
        for (index, (is, cell)) in uses.iter().zip(marks.windows(2)).enumerate() {
            let (start, end) = (skip_spaces(text, cell[0] as usize), cell[1] as usize - 1);
            let is_last = index + 1 == uses.len();
            let cell = text.get(start..end)?;
            if (text[end] == b'\n') != is_last || cell.first() == Some(&b'"') {
                return None;
            }
            let length = match is {
                FieldUse::Skipped => continue,
                FieldUse::Position(axis) => {
                    let (value, length) = short_float(&text[start..])?;
                    position[*axis] = value;
                    length
                }
                FieldUse::Column(_) => {
                    let word_length = |_: &[u8]| cell.trim_ascii_end().len();
                    push_quickly(columns.next()?, &text[start..], word_length)?
                }
            };
            let mut after = skip_spaces(text, start + length);
            after += usize::from(is_last && text.get(after) == Some(&b'\r'));
            if after != end {
                return None;
            }
        }
        to.positions.push(position);
        Some(*marks.last()? as usize)
    }
}

#[inline(always)]
fn skip_spaces(text: &[u8], mut at: usize) -> usize {
    while text.get(at) == Some(&b' ') {
        at += 1;
    }
    at
}

/// The cells of a line, without space and quotes around them.
pub(super) struct Cells<'l> {
    rest: Option<&'l [u8]>,
    delimiter: u8,
}

impl<'l> Cells<'l> {
    pub(super) fn new(line: &'l [u8], delimiter: u8) -> Self {
        Self { rest: Some(line), delimiter }
    }
}

impl<'l> Iterator for Cells<'l> {
    type Item = &'l [u8];

    #[inline]
    fn next(&mut self) -> Option<&'l [u8]> {
        let rest = self.rest?;
        let start = rest.iter().position(|&b| b != b' ').unwrap_or(rest.len());
        if rest.get(start) == Some(&b'"') {
            return Some(self.quoted(&rest[start + 1..]));
        }
        let end = rest[start..].iter().position(|&b| b == self.delimiter);
        let cell = match end {
            Some(end) => {
                self.rest = Some(&rest[start + end + 1..]);
                &rest[start..start + end]
            }
            None => {
                self.rest = None;
                &rest[start..]
            }
        };
        Some(cell.trim_ascii_end())
    }
}

impl<'l> Cells<'l> {
    /// A cell after its opening quote; doubled quotes stay as they are.
    #[cold]
    fn quoted(&mut self, text: &'l [u8]) -> &'l [u8] {
        let mut at = 0;
        let close = loop {
            match text[at..].iter().position(|&b| b == b'"') {
                Some(quote) if text.get(at + quote + 1) == Some(&b'"') => at += quote + 2,
                Some(quote) => break at + quote,
                None => break text.len(),
            }
        };
        let after = text.get(close + 1..).unwrap_or_default();
        let next = after.iter().position(|&b| b == self.delimiter);
        self.rest = next.map(|next| &after[next + 1..]);
        &text[..close]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_split_and_trimmed() {
        let cells = |line: &str| -> Vec<String> {
            let cells = Cells::new(line.as_bytes(), b',');
            cells.map(|cell| String::from_utf8_lossy(cell).into_owned()).collect()
        };
        assert_eq!(cells("1, 2 ,3"), ["1", "2", "3"]);
        assert_eq!(cells("a,,"), ["a", "", ""]);
        assert_eq!(cells("\"a,b\",\"c \"\"d\"\"\" , e"), ["a,b", "c \"\"d\"\"", "e"]);
        assert_eq!(cells(""), [""]);
        assert_eq!(cells("\"open"), ["open"]);
    }
}
