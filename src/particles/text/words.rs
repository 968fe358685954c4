//! Collects words, each stored once.

use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;

use crate::particles::column::Categories;
use crate::task::pages::try_reserve;

/// Words that are found by comparing them with each.
const MAX_RECENT: usize = 16;

/// A growing column of words.
#[derive(Clone, Debug, Default)]
pub(in crate::particles) struct Words {
    words: Categories,
    codes: HashMap<Arc<str>, u32>,
    /// The first short words with their codes.
    short: Vec<(u64, u32)>,
}

impl Words {
    /// Appends a word.
    #[inline(always)]
    pub(in crate::particles) fn push(&mut self, word: &[u8]) {
        self.push_part(word, 0..word.len());
    }

    /// Appends a word within a text.
    #[inline(always)]
    pub(super) fn push_part(&mut self, text: &[u8], word: Range<usize>) {
        let key = short_key(&text[word.start..], word.len());
        for (known, code) in &self.short {
            if Some(*known) == key {
                self.words.codes.push(*code);
                return;
            }
        }
        let code = self.find(&text[word], key);
        self.words.codes.push(code);
    }

    #[cold]
    fn find(&mut self, word: &[u8], key: Option<u64>) -> u32 {
        let code = self.code(&String::from_utf8_lossy(word));
        if let Some(key) = key.filter(|_| self.short.len() < MAX_RECENT) {
            self.short.push((key, code));
        }
        code
    }

    fn code(&mut self, word: &str) -> u32 {
        if let Some(&code) = self.codes.get(word) {
            return code;
        }
        let name: Arc<str> = Arc::from(word);
        let code = self.words.names.len() as u32;
        self.words.names.push(Arc::clone(&name));
        self.codes.insert(name, code);
        code
    }

    /// Forgets all words, and keeps the memory for as many.
    pub(in crate::particles) fn clear(&mut self) {
        self.words.codes.clear();
        self.words.names.clear();
        self.codes.clear();
        self.short.clear();
    }

    /// Takes memory for more words, if there is as much.
    pub(in crate::particles) fn reserve(&mut self, count: usize) {
        let _ = try_reserve(&mut self.words.codes, count);
    }

    /// Keeps the first words. The others may stay known.
    pub(in crate::particles) fn truncate(&mut self, count: usize) {
        self.words.codes.truncate(count);
    }

    /// Appends all words of another column.
    pub(in crate::particles) fn append(&mut self, other: &Self) {
        let codes: Vec<u32> = other.words.names.iter().map(|name| self.code(name)).collect();
        if codes.iter().copied().eq(0..codes.len() as u32) {
            self.words.codes.extend_from_slice(&other.words.codes);
        } else {
            self.words.codes.extend(other.words.codes.iter().map(|&code| codes[code as usize]));
        }
    }

    /// Bytes of memory, about.
    pub(in crate::particles) fn bytes(&self) -> u64 {
        let names: usize = self.words.names.iter().map(|name| 100 + 2 * name.len()).sum();
        (4 * self.words.codes.len() + names) as u64
    }

    /// The column.
    pub(in crate::particles) fn finish(mut self) -> Categories {
        self.words.codes.shrink_to_fit();
        self.words
    }
}

/// A word of up to seven bytes at the beginning of a text as a number, which has its length.
#[inline(always)]
fn short_key(text: &[u8], length: usize) -> Option<u64> {
    let bytes = match text.first_chunk() {
        Some(bytes) => u64::from_le_bytes(*bytes),
        None => text.iter().rev().fold(0, |key, byte| key << 8 | u64::from(*byte)),
    };
    (length < 8).then(|| (bytes << 8).wrapping_shl(56 - 8 * length as u32) | length as u64)
}
