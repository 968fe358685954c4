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
}

/// Appends the rows of the next `count` lines to `all`, or of all lines if `count` is `None`.
/// Returns the number of lines.
pub(in crate::particles) fn read_rows(
    input: &mut Input,
    parser: &dyn LineParser,
    count: Option<u64>,
    budget: Budget,
    all: &mut Batch,
) -> Outcome<u64> {
    let mut done = 0;
    loop {
        let most = count.map_or(u64::MAX, |count| count - done);
        let first = input.line_number();
        let (text, lines) = input.peek_lines(most)?;
        if lines == 0 {
            return Ok(done);
        }
        let pieces = split(text, rayon::current_num_threads() * 4);
        let kinds: Vec<_> = all.kinds().collect();
        let parse = |piece: &&[u8]| parse_piece(piece, parser, Batch::new(kinds.iter().copied()));
        let parsed: Vec<_> = pieces.par_iter().map(parse).collect();
        let mut line = first;
        for (piece, parsed) in pieces.iter().zip(parsed) {
            match parsed {
                Ok((batch, lines)) => {
                    all.append(batch);
                    line += lines;
                }
                Err((at, message)) => return Err(Trouble::at(line + at, message).into()),
            }
            debug_assert!(!piece.is_empty());
        }
        budget.check(all.bytes())?;
        let bytes = text.len();
        input.consume_lines(bytes, lines);
        done += lines;
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

/// Parses the lines of a piece; returns them with their number. The error has the number of lines
/// before it.
fn parse_piece(
    piece: &[u8],
    parser: &dyn LineParser,
    mut batch: Batch,
) -> Result<(Batch, u64), (u64, String)> {
    let (mut rest, mut lines) = (piece, 0);
    while !rest.is_empty() {
        let end = memchr::memchr(b'\n', rest).unwrap_or(rest.len());
        let line = rest[..end].strip_suffix(b"\r").unwrap_or(&rest[..end]);
        parser.parse(line, &mut batch).map_err(|message| (lines, message))?;
        lines += 1;
        rest = rest.get(end + 1..).unwrap_or_default();
    }
    Ok((batch, lines))
}
