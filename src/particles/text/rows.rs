//! Parses lines in parallel.

use rayon::prelude::*;

use crate::particles::budget::Budget;
use crate::particles::trouble::{Outcome, Trouble};

use super::batch::Batch;
use super::input::Input;

/// Bytes that one task parses, at least.
const TASK_BYTES: usize = 1 << 16;

/// Parses one line after the other.
pub(in crate::particles) trait LineParser: Sync {
    /// Appends the rows of a line. The error says what was expected, and what was found.
    ///
    /// # Errors
    /// If the line is wrong.
    fn parse(&self, line: &[u8], to: &mut Batch) -> Result<(), String>;

    /// Appends the row of the line at the beginning of a text, if all of its values are common ones
    /// and all is right; returns the length of the line with its end. Otherwise columns may have
    /// one value more, and [`Self::parse`] decides.
    fn parse_quickly(&self, _text: &[u8], _to: &mut Batch) -> Option<usize> {
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
    // Batches keep their memory from one turn to the next.
    let mut batches: Vec<Batch> = Vec::new();
    loop {
        let first = input.line_number();
        let (text, lines, has_more) = section.next(input, done)?;
        let pieces = split(text, rayon::current_num_threads() * 4);
        batches.resize_with(pieces.len().max(batches.len()), Batch::default);
        batches.iter_mut().for_each(|batch| batch.clear_like(all));
        let parse = |(piece, batch): (&&[u8], &mut Batch)| parse_piece(piece, parser, batch);
        let parsed: Vec<_> = pieces.par_iter().zip(&mut batches).map(parse).collect();
        let mut line = first;
        for (parsed, batch) in parsed.into_iter().zip(&mut batches) {
            match parsed {
                Ok(lines) => {
                    all.append(batch);
                    line += lines;
                }
                Err((at, message)) => return Err(Trouble::at(line + at, message).into()),
            }
        }
        budget.check(all.bytes())?;
        let bytes = text.len();
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
) -> Result<u64, (u64, String)> {
    let (mut rest, mut lines) = (piece, 0);
    while !rest.is_empty() {
        match parser.parse_quickly(rest, batch) {
            Some(length) => rest = &rest[length..],
            None => {
                batch.drop_incomplete_row();
                let end = memchr::memchr(b'\n', rest).unwrap_or(rest.len());
                let line = rest[..end].strip_suffix(b"\r").unwrap_or(&rest[..end]);
                parser.parse(line, batch).map_err(|message| (lines, message))?;
                rest = rest.get(end + 1..).unwrap_or_default();
            }
        }
        lines += 1;
    }
    Ok(lines)
}
