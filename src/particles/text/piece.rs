//! The lines of a block: parsed many rows at once where all are usual, else one by one.

use crate::math::{Isa, bytes};

use super::batch::Batch;
use super::lanes::LANES;
use super::line_parser::LineParser;
use super::marks::{MarkedRow, Marks};
use super::row_lanes::UsualRows;

/// Most rows that are parsed one by one before many are tried at once.
const MAX_PATIENCE: usize = 1 << 10;

/// Parses the lines of a piece; returns their number. The error has the number of lines before it.
pub(super) fn parse_piece(
    piece: &[u8],
    parser: &dyn LineParser,
    batch: &mut Batch,
    marks: &mut Marks,
) -> Result<u64, (u64, String)> {
    let Some(separator) = parser.separator() else { return parse_slowly(piece, parser, batch) };
    let isa = Isa::best();
    marks.mark(piece, separator, isa);
    let (mut marks, mut values) = (marks.starts(), 0);
    let (mut start, mut lines) = (0, 0);
    let uses = parser.values().filter(|uses| isa != Isa::PORTABLE && !uses.is_empty());
    let mut patience = Patience { rows_left: 0, next: LANES };
    while start < piece.len() {
        let row = MarkedRow { text: piece, start, marks };
        if let Some(uses) = uses.filter(|_| patience.is_over()) {
            let mut rows = 0;
            bytes::run(isa, UsualRows { uses, row, to: batch, rows: &mut rows, end: &mut start });
            batch.drop_incomplete_row();
            marks = &marks[rows * uses.len()..];
            lines += rows as u64;
            patience.renew(rows > 0);
            continue;
        }
        start = match parser.parse_quickly(row, batch) {
            Some(end) => end,
            None => {
                batch.drop_incomplete_row();
                let (line, length) = first_line(&piece[start..]);
                parser.parse(line, batch).map_err(|message| (lines, message))?;
                start + length
            }
        };
        values = marks_before(marks, start, values);
        marks = &marks[values..];
        lines += 1;
    }
    Ok(lines)
}

/// Rows to parse one by one before many are tried at once again.
struct Patience {
    rows_left: usize,
    /// How many there will be after the next failure.
    next: usize,
}

impl Patience {
    /// Takes a row; true if none was left.
    fn is_over(&mut self) -> bool {
        let is_over = self.rows_left == 0;
        self.rows_left -= usize::from(!is_over);
        is_over
    }

    /// Begins again after a trial.
    fn renew(&mut self, has_succeeded: bool) {
        self.next = if has_succeeded { LANES } else { (2 * self.next).min(MAX_PATIENCE) };
        self.rows_left = self.next;
    }
}

/// How many marks are before a place; `usual` is tried first.
#[inline(always)]
fn marks_before(marks: &[u32], place: usize, usual: usize) -> usize {
    let is_before = |at: usize| marks.get(at).is_some_and(|mark| (*mark as usize) < place);
    if !is_before(usual) && (usual == 0 || is_before(usual - 1)) {
        return usual;
    }
    marks.iter().position(|mark| *mark as usize >= place).unwrap_or(marks.len())
}

fn parse_slowly(
    piece: &[u8],
    parser: &dyn LineParser,
    batch: &mut Batch,
) -> Result<u64, (u64, String)> {
    let (mut rest, mut lines) = (piece, 0);
    while !rest.is_empty() {
        let (line, length) = first_line(rest);
        parser.parse(line, batch).map_err(|message| (lines, message))?;
        rest = &rest[length..];
        lines += 1;
    }
    Ok(lines)
}

/// The first line without its end, and its length with it.
fn first_line(text: &[u8]) -> (&[u8], usize) {
    let end = memchr::memchr(b'\n', text).unwrap_or(text.len());
    let line = &text[..end];
    (line.strip_suffix(b"\r").unwrap_or(line), text.len().min(end + 1))
}
