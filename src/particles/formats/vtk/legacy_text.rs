//! Moves through a legacy VTK file in memory: words, lines, and blocks of numbers.

use crate::particles::binary::NumberKind;
use crate::particles::trouble::{Outcome, Trouble, shown};

use super::array::encode;

/// A place in the bytes of a file.
pub(super) struct Cursor<'b> {
    bytes: &'b [u8],
    at: usize,
    pub(super) is_binary: bool,
}

impl<'b> Cursor<'b> {
    pub(super) fn new(bytes: &'b [u8]) -> Self {
        Self { bytes, at: 0, is_binary: false }
    }

    /// Number of the line here.
    pub(super) fn line_number(&self) -> u64 {
        memchr::memchr_iter(b'\n', &self.bytes[..self.at]).count() as u64 + 1
    }

    /// The next line, without its end; `None` after the last one.
    pub(super) fn line(&mut self) -> Option<&'b [u8]> {
        let rest = self.bytes.get(self.at..).filter(|rest| !rest.is_empty())?;
        let end = memchr::memchr(b'\n', rest).unwrap_or(rest.len());
        self.at = (self.at + end + 1).min(self.bytes.len());
        Some(rest[..end].strip_suffix(b"\r").unwrap_or(&rest[..end]))
    }

    /// The next line that is not empty, as words.
    pub(super) fn words(&mut self) -> Option<Vec<String>> {
        loop {
            let line = self.line()?.trim_ascii();
            if !line.is_empty() {
                let text = String::from_utf8_lossy(&line[..line.len().min(4096)]);
                return Some(text.split_whitespace().map(str::to_owned).collect());
            }
        }
    }

    /// Moves past the next line that is not empty, if it begins with a word.
    pub(super) fn line_with(&mut self, word: &[u8]) -> bool {
        let before = self.at;
        while let Some(line) = self.line() {
            let line = line.trim_ascii();
            if line.starts_with(word) {
                return true;
            }
            if !line.is_empty() {
                break;
            }
        }
        self.at = before;
        false
    }

    /// Moves past lines up to an empty one.
    pub(super) fn skip_paragraph(&mut self) {
        while self.line().is_some_and(|line| !line.trim_ascii().is_empty()) {}
    }

    /// A block of `count` numbers as bytes; those of a text become little-endian ones, those of a
    /// binary file are big-endian.
    pub(super) fn numbers(&mut self, count: u64, kind: NumberKind) -> Outcome<Vec<u8>> {
        if self.is_binary {
            let length = self.check(count, kind.bytes())?;
            let block = self.bytes[self.at..self.at + length].to_vec();
            self.at += length;
            return Ok(block);
        }
        let text = self.tokens(count)?;
        Ok(encode(text, kind)?)
    }

    /// Moves past a block of numbers.
    pub(super) fn skip(&mut self, count: u64, kind: NumberKind) -> Outcome<()> {
        if self.is_binary {
            self.at += self.check(count, kind.bytes())?;
            return Ok(());
        }
        self.tokens(count).map(|_| ())
    }

    fn check(&self, count: u64, size: u64) -> Outcome<usize> {
        let left = (self.bytes.len() - self.at) as u64;
        match count.checked_mul(size).filter(|&length| length <= left) {
            Some(length) => Ok(length as usize),
            None => {
                let message = format!(
                    "the file ends too early: {count} numbers of {size} bytes are promised, and \
                     {left} bytes are left"
                );
                Err(Trouble::new(message).with_help("is it complete?").into())
            }
        }
    }

    /// The text of this many tokens.
    fn tokens(&mut self, count: u64) -> Outcome<&'b [u8]> {
        let start = self.at;
        let line = |cursor: &Self| cursor.line_number();
        for _ in 0..count {
            while self.bytes.get(self.at).is_some_and(|&byte| byte <= b' ') {
                self.at += 1;
            }
            let rest = &self.bytes[self.at..];
            let length = rest.iter().position(|&byte| byte <= b' ').unwrap_or(rest.len());
            if length == 0 {
                let message = format!("expected {count} numbers, found the end of the file");
                return Err(Trouble::at(line(self), message).into());
            }
            if rest[0].is_ascii_alphabetic() && !rest[..length].eq_ignore_ascii_case(b"nan") {
                let found = shown(&rest[..length]);
                return Err(
                    Trouble::at(line(self), format!("expected a number, found {found}")).into()
                );
            }
            self.at += length;
        }
        Ok(&self.bytes[start..self.at])
    }
}
