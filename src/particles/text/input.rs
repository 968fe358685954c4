//! Text that is read forward, with its lines counted.

use std::ops::Range;
use std::path::PathBuf;

use crate::particles::source::Source;
use crate::particles::trouble::{Outcome, Trouble, io_failure};

use super::blocks::{Blocks, MAX_ROW_BYTES, end_of_lines};

/// Longest line of a header.
const MAX_LINE_BYTES: usize = 1 << 20;

/// What some programs write before text in UTF-8.
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// Whole lines, taken out of a text.
#[derive(Default)]
pub(super) struct Lines {
    memory: Vec<u8>,
    range: Range<usize>,
    count: u64,
}

impl Lines {
    /// The lines.
    pub(super) fn text(&self) -> &[u8] {
        &self.memory[self.range.clone()]
    }

    /// How many they are.
    pub(super) fn count(&self) -> u64 {
        self.count
    }
}

/// Text that is read forward.
pub(in crate::particles) struct Input {
    path: PathBuf,
    blocks: Blocks,
    /// Memory to be used again.
    spare: Vec<u8>,
    /// Whole lines, unless the file ends within one or it is too long.
    buffer: Vec<u8>,
    start: usize,
    line: u64,
    /// Length of a plain file.
    length: Option<u64>,
}

impl Input {
    /// Begins to read.
    pub(in crate::particles) fn new(source: Source) -> Self {
        let is_short = source.is_short();
        let Source { path, head: mut buffer, rest, plain_length: length, .. } = source;
        let start = if buffer.starts_with(BYTE_ORDER_MARK) { BYTE_ORDER_MARK.len() } else { 0 };
        let blocks = if is_short {
            Blocks::Over
        } else {
            let begun = buffer.split_off(end_of_lines(&buffer).max(start));
            Blocks::new(begun, rest, length.is_none())
        };
        Self { path, blocks, spare: Vec::new(), buffer, start, line: 1, length }
    }

    /// Bytes of the whole file, if it is a plain one.
    pub(in crate::particles) fn length(&self) -> Option<u64> {
        self.length
    }

    /// Number of the next line; the first is 1.
    pub(in crate::particles) fn line_number(&self) -> u64 {
        self.line
    }

    /// The next line without its end, if there is one; it stays the next one.
    pub(in crate::particles) fn peek_line(&mut self) -> Outcome<Option<&[u8]>> {
        Ok(self.find_line()?.map(|end| trimmed(&self.buffer[self.start..end])))
    }

    /// Moves past empty lines; returns the line behind them, which stays the next one.
    pub(in crate::particles) fn peek_filled_line(&mut self) -> Outcome<Option<&[u8]>> {
        while self.peek_line()?.is_some_and(|line| line.trim_ascii().is_empty()) {
            self.next_line()?;
        }
        self.peek_line()
    }

    /// The next line without its end; `None` after the last one.
    pub(in crate::particles) fn next_line(&mut self) -> Outcome<Option<String>> {
        let Some(end) = self.find_line()? else { return Ok(None) };
        let line = String::from_utf8_lossy(trimmed(&self.buffer[self.start..end])).into_owned();
        self.start = (end + 1).min(self.buffer.len());
        self.line += 1;
        Ok(Some(line))
    }

    /// The next line, which must exist. `expected` completes "expected ...".
    pub(in crate::particles) fn expect_line(&mut self, expected: &str) -> Outcome<String> {
        let line = self.line;
        self.next_line()?.ok_or_else(|| {
            Trouble::at(line, format!("expected {expected}, found the end of the file")).into()
        })
    }

    /// Index of the end of the next line; `None` at the end of the text.
    fn find_line(&mut self) -> Outcome<Option<usize>> {
        let mut searched = 0;
        loop {
            let rest = &self.buffer[self.start..];
            let found = memchr::memchr(b'\n', &rest[searched..]);
            searched += found.unwrap_or(rest.len() - searched);
            if found.is_some() && searched <= MAX_LINE_BYTES {
                return Ok(Some(self.start + searched));
            }
            if searched > MAX_LINE_BYTES {
                let message = format!("the line has more than {MAX_LINE_BYTES} bytes");
                return Err(Trouble::at(self.line, message).into());
            }
            if !self.fill()? {
                let len = self.buffer.len();
                return Ok((self.start < len).then_some(len));
            }
        }
    }

    /// Moves past the next `count` lines; returns how many there were.
    pub(in crate::particles) fn skip_lines(&mut self, count: u64) -> Outcome<u64> {
        let mut left = count;
        while left > 0 {
            let (lines, end) = self.find_lines(left)?;
            if lines == 0 {
                break;
            }
            left -= lines;
            self.consume(end, lines);
        }
        Ok(count - left)
    }

    /// The next whole lines, of which there are at most `most`, and their number; none at the end.
    pub(in crate::particles) fn peek_lines(&mut self, most: u64) -> Outcome<(&[u8], u64)> {
        let (lines, end) = self.find_lines(most)?;
        Ok((&self.buffer[self.start..end], lines))
    }

    /// Moves past lines that [`Self::peek_lines`] returned.
    pub(in crate::particles) fn consume_lines(&mut self, bytes: usize, lines: u64) {
        self.consume(self.start + bytes, lines);
    }

    /// Takes out lines that [`Self::peek_lines`] returned, in exchange for memory to be used again.
    pub(super) fn take_lines(&mut self, bytes: usize, count: u64, to: &mut Lines) {
        let (start, end) = (self.start, self.start + bytes);
        if end == self.buffer.len() {
            std::mem::swap(&mut self.buffer, &mut to.memory);
            to.range = start..end;
            self.buffer.clear();
            self.consume(0, count);
        } else {
            to.memory.clear();
            to.memory.extend_from_slice(&self.buffer[start..end]);
            to.range = 0..bytes;
            self.consume(end, count);
        }
        to.count = count;
    }

    fn consume(&mut self, end: usize, lines: u64) {
        self.start = end;
        self.line += lines;
    }

    /// Finds at most `most` whole lines in the buffer, and at least one unless the text is over:
    /// their number, and where the last one ends.
    fn find_lines(&mut self, most: u64) -> Outcome<(u64, usize)> {
        if most == 0 {
            return Ok((0, self.start));
        }
        loop {
            let rest = &self.buffer[self.start..];
            if let Some((lines, end)) = whole_lines(rest, most) {
                return Ok((lines, self.start + end));
            }
            if rest.len() > MAX_ROW_BYTES {
                let message = format!("the line has more than {MAX_ROW_BYTES} bytes");
                return Err(Trouble::at(self.line, message).into());
            }
            if !self.fill()? {
                let lines = u64::from(self.start < self.buffer.len());
                return Ok((lines, self.buffer.len()));
            }
        }
    }

    /// Adds a block to the buffer, or puts it in the place of lines that are done; false at the end
    /// of the text.
    fn fill(&mut self) -> Outcome<bool> {
        match self.blocks.next(&mut self.spare) {
            Some(Ok(mut block)) => {
                if self.start == self.buffer.len() {
                    std::mem::swap(&mut self.buffer, &mut block);
                } else {
                    self.buffer.drain(..self.start);
                    self.buffer.extend_from_slice(&block);
                }
                self.start = 0;
                self.spare = block;
                Ok(true)
            }
            Some(Err(error)) => Err(io_failure(&self.path, error)),
            None => Ok(false),
        }
    }
}

/// Number and length of the first whole lines, of which there are at most `most`.
fn whole_lines(text: &[u8], most: u64) -> Option<(u64, usize)> {
    /// From here on, counting all lines is faster than finding each.
    const MANY: u64 = 1 << 16;
    if most > MANY {
        let last = memchr::memrchr(b'\n', text)?;
        let lines = memchr::memchr_iter(b'\n', &text[..=last]).count() as u64;
        if lines <= most {
            return Some((lines, last + 1));
        }
    }
    let ends = memchr::memchr_iter(b'\n', text).take(most as usize);
    let (lines, last) = ends.fold((0, None), |(lines, _), end| (lines + 1, Some(end)));
    Some((lines, last? + 1))
}

/// A line without its end.
fn trimmed(line: &[u8]) -> &[u8] {
    line.strip_suffix(b"\r").unwrap_or(line)
}
