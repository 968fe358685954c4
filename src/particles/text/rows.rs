//! Parses lines in parallel: each thread takes the next block, parses it, and adds its rows to
//! those of the blocks before. No thread waits for the others after each block.

use std::cell::RefCell;
use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

use crate::particles::budget::Budget;
use crate::particles::trouble::{Outcome, Trouble};

use super::batch::Batch;
use super::input::{Input, Lines};
use super::joined::{Alarm, Block, Joined, lock};
use super::line_parser::LineParser;
use super::marks::Marks;
use super::piece::parse_piece;

/// Blocks for each thread that may wait until their turn to be joined.
const AHEAD: usize = 4;

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

    /// Takes the next lines of the section; true if there may be more.
    fn take(&self, input: &mut Input, done: u64, to: &mut Lines) -> Outcome<bool> {
        let (text, count, has_more) = self.next(input, done)?;
        let bytes = text.len();
        input.take_lines(bytes, count, to);
        Ok(has_more)
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
    let threads = rayon::current_num_threads();
    let length = input.length().unwrap_or(0);
    let taking = Mutex::new(Taking { input, section, done: 0, index: 0, has_more: true });
    let joined = Joined::new(all);
    let work = |_| {
        let _alarm = Alarm(&joined);
        let (mut lines, marks) = (Lines::default(), RefCell::default());
        while let Some((index, first_line)) = take(&taking, &joined, &mut lines) {
            let (lines, marks) = (&lines, &marks);
            let rows = Rows { lines, first_line, parser, marks, section, length, budget };
            joined.parse(index, AHEAD * threads, &rows);
        }
    };
    (0..threads).into_par_iter().with_max_len(1).for_each(work);
    joined.finish()?;
    Ok(taking.into_inner().unwrap_or_else(PoisonError::into_inner).done)
}

/// The rows of a block.
struct Rows<'r> {
    lines: &'r Lines,
    first_line: u64,
    parser: &'r dyn LineParser,
    marks: &'r RefCell<Marks>,
    section: Section,
    /// Length of the file.
    length: u64,
    budget: Budget,
}

impl Block for Rows<'_> {
    fn parse(&self, to: &mut Batch) -> Outcome<()> {
        let parsed = parse_piece(self.lines.text(), self.parser, to, &mut self.marks.borrow_mut());
        match parsed {
            Ok(_) => Ok(()),
            Err((before, message)) => Err(Trouble::at(self.first_line + before, message).into()),
        }
    }

    fn bytes(&self) -> usize {
        self.lines.text().len()
    }

    fn joined(&self, all: &mut Batch, bytes: usize, is_first: bool) -> Outcome<()> {
        self.budget.check(all.bytes())?;
        if is_first {
            all.reserve(self.section.rows_left(all, bytes as u64, self.length, self.budget));
        }
        Ok(())
    }
}

/// Where the next block comes from.
struct Taking<'i> {
    input: &'i mut Input,
    section: Section,
    /// Number of lines so far.
    done: u64,
    /// Number of blocks so far.
    index: usize,
    has_more: bool,
}

/// Takes the next block: its index, and the number of its first line.
fn take(taking: &Mutex<Taking<'_>>, joined: &Joined<'_>, to: &mut Lines) -> Option<(usize, u64)> {
    let mut taking = lock(taking);
    if !taking.has_more || joined.is_over() {
        return None;
    }
    let Taking { input, section, done, index, has_more } = &mut *taking;
    let first_line = input.line_number();
    match section.take(input, *done, to) {
        Ok(more) => *has_more = more,
        Err(failure) => {
            *has_more = false;
            joined.fail(*index, failure);
        }
    }
    if to.count() == 0 || joined.is_over() {
        return None;
    }
    *done += to.count();
    *index += 1;
    Some((*index - 1, first_line))
}

#[cfg(test)]
mod tests {
    use std::fmt::Write;
    use std::path::Path;

    use crate::particles::{Particles, ReadRequest, read_bytes};

    /// Rows of many blocks, whose columns become wider late.
    fn text() -> String {
        let mut text = "id,x,y,z,kind\n".to_owned();
        for row in 0..120_000i64 {
            let id = if row == 90_000 { 5_000_000_000 } else { row };
            let kind = ["b", "a", "c", "d"][if row < 60_000 { row % 2 } else { row % 4 } as usize];
            let _ = writeln!(text, "{id},{},{:.9},-1.5,{kind}", row as f64 / 7.0, row as f64);
        }
        text
    }

    fn read(text: &str, threads: usize) -> Result<Particles, String> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let request = ReadRequest::default();
        pool.install(|| read_bytes(Path::new("a.csv"), text.as_bytes(), &request))
            .map_err(|error| error.to_string())
    }

    #[test]
    fn rows_are_the_same_with_any_number_of_threads() {
        let text = text();
        let one = read(&text, 1).expect("it can be read");
        assert_eq!(one.len(), 120_000);
        for threads in [2, 5] {
            let many = read(&text, threads).expect("it can be read");
            assert_eq!(one.positions, many.positions);
            assert!(one.columns == many.columns);
        }
    }

    #[test]
    fn the_first_wrong_line_is_said_with_any_number_of_threads() {
        let text = text();
        let wrong: Vec<&str> = text
            .lines()
            .enumerate()
            .map(|(line, text)| if matches!(line, 50_000 | 95_000) { "1,2,3" } else { text })
            .collect();
        let one = read(&wrong.join("\n"), 1).expect_err("it is wrong");
        assert!(one.starts_with("a.csv:50001: "), "{one}");
        for threads in [2, 5] {
            for _ in 0..3 {
                assert_eq!(read(&wrong.join("\n"), threads).expect_err("it is wrong"), one);
            }
        }
    }
}
