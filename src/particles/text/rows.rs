//! Parses lines in parallel.

use rayon::prelude::*;

use crate::math::{Isa, bytes};
use crate::particles::budget::Budget;
use crate::particles::trouble::{Outcome, Trouble};

use super::batch::Batch;
use super::fields::FieldUse;
use super::input::Input;
use super::lane_digits::LANES;
use super::marks::{MarkedRow, Marks, Separator};
use super::row_lanes::UsualRows;

/// Bytes that one task parses, at least.
const TASK_BYTES: usize = 1 << 16;

/// Most rows that are parsed one by one before many are tried at once.
const MAX_PATIENCE: usize = 1 << 10;

/// Parses one line after the other.
pub(in crate::particles) trait LineParser: Sync {
    /// Appends the rows of a line. The error says what was expected, and what was found.
    ///
    /// # Errors
    /// If the line is wrong.
    fn parse(&self, line: &[u8], to: &mut Batch) -> Result<(), String>;

    /// What separates the values that [`Self::parse_quickly`] needs to be marked; `None` if it does
    /// nothing.
    fn separator(&self) -> Option<Separator> {
        None
    }

    /// The values of a row, if rows may be parsed many at once where these are all of it.
    fn values(&self) -> Option<&[FieldUse]> {
        None
    }

    /// Appends a row if all of its values are common ones and all is right; returns where its line
    /// ends in the text, its end included. Otherwise columns may have one value more, and
    /// [`Self::parse`] decides.
    fn parse_quickly(&self, _row: MarkedRow<'_>, _to: &mut Batch) -> Option<usize> {
        None
    }
}

/// Which lines are read.
#[derive(Clone, Copy)]
pub(in crate::particles) enum Section {
    /// This many, or as many as there are.
    Lines(u64),
    /// All up to where a function finds the end, in text that begins with a line. The line there
    /// stays the next one.
    Until(fn(&[u8]) -> Option<usize>),
}

impl Section {
    /// How many rows follow, about, if the first ones take so many bytes of a file. No more than
    /// the budget allows: a header may promise any number.
    fn rows_left(&self, first: &Batch, bytes: u64, length: u64, budget: Budget) -> usize {
        let (rows, held) = (first.positions.len() as u64, first.bytes());
        let all = rows.saturating_mul(length) / bytes.max(1);
        let all = match self {
            Self::Lines(count) => all.saturating_add(all / 64).min(*count),
            Self::Until(_) => all,
        };
        let fits = budget.check(held.saturating_mul(all) / rows.max(1)).is_ok();
        if fits { all.saturating_sub(rows) as usize } else { 0 }
    }

    /// The next lines of the section, with their number, and true if there may be more.
    fn next<'i>(&self, input: &'i mut Input, done: u64) -> Outcome<(&'i [u8], u64, bool)> {
        match self {
            Self::Lines(count) => {
                let (text, lines) = input.peek_lines(count - done)?;
                Ok((text, lines, lines > 0))
            }
            Self::Until(end) => {
                let (text, lines) = input.peek_lines(u64::MAX)?;
                match end(text) {
                    Some(at) => {
                        let text = &text[..at];
                        Ok((text, memchr::memchr_iter(b'\n', text).count() as u64, false))
                    }
                    None => Ok((text, lines, lines > 0)),
                }
            }
        }
    }
}

/// Moves past a section; returns its number of lines.
pub(in crate::particles) fn skip_section(input: &mut Input, section: Section) -> Outcome<u64> {
    let mut done = 0;
    loop {
        let (text, lines, has_more) = section.next(input, done)?;
        let bytes = text.len();
        input.consume_lines(bytes, lines);
        done += lines;
        if !has_more {
            return Ok(done);
        }
    }
}

/// Appends the rows of a section to `all`. Returns its number of lines.
pub(in crate::particles) fn read_rows(
    input: &mut Input,
    parser: &dyn LineParser,
    section: Section,
    budget: Budget,
    all: &mut Batch,
) -> Outcome<u64> {
    let mut done = 0;
    let mut has_reserved = false;
    // Batches keep their memory from one turn to the next.
    let mut batches: Vec<(Batch, Marks)> = Vec::new();
    loop {
        let first = input.line_number();
        let (text, lines, has_more) = section.next(input, done)?;
        let pieces = split(text, rayon::current_num_threads() * 4);
        batches.resize_with(pieces.len().max(batches.len()), Default::default);
        batches.iter_mut().for_each(|(batch, _)| batch.clear_like(all));
        let parse = |(piece, (batch, marks)): (&&[u8], &mut (Batch, Marks))| {
            parse_piece(piece, parser, batch, marks)
        };
        let parsed: Vec<_> = pieces.par_iter().zip(&mut batches).map(parse).collect();
        let (count, mut line) = (pieces.len(), first);
        for parsed in parsed {
            match parsed {
                Ok(lines) => line += lines,
                Err((at, message)) => return Err(Trouble::at(line + at, message).into()),
            }
        }
        all.append(batches[..count].iter_mut().map(|(batch, _)| batch));
        budget.check(all.bytes())?;
        let bytes = text.len();
        if !std::mem::replace(&mut has_reserved, true) {
            let length = input.length().unwrap_or(0);
            all.reserve(section.rows_left(all, bytes as u64, length, budget));
        }
        input.consume_lines(bytes, lines);
        done += lines;
        if !has_more {
            return Ok(done);
        }
    }
}

/// Cuts text at the ends of lines into about `count` pieces.
fn split(text: &[u8], count: usize) -> Vec<&[u8]> {
    let size = (text.len() / count.max(1)).max(TASK_BYTES);
    let mut pieces = Vec::new();
    let mut rest = text;
    while rest.len() > size {
        let Some(end) = memchr::memchr(b'\n', &rest[size..]) else { break };
        let (piece, after) = rest.split_at(size + end + 1);
        pieces.push(piece);
        rest = after;
    }
    if !rest.is_empty() {
        pieces.push(rest);
    }
    pieces
}

/// Parses the lines of a piece; returns their number. The error has the number of lines before it.
fn parse_piece(
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
