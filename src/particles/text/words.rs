//! Collects words, each stored once.

use std::collections::HashMap;
use std::sync::Arc;

use crate::particles::column::Categories;

/// A growing column of words.
#[derive(Clone, Debug, Default)]
pub(in crate::particles) struct Words {
    words: Categories,
    codes: HashMap<Arc<str>, u32>,
}

impl Words {
    /// Appends a word.
    #[inline]
    pub(in crate::particles) fn push(&mut self, word: &[u8]) {
        // Neighbours are often equal.
        if let Some(&last) = self.words.codes.last() {
            if self.words.names[last as usize].as_bytes() == word {
                self.words.codes.push(last);
                return;
            }
        }
        let code = self.code(&String::from_utf8_lossy(word));
        self.words.codes.push(code);
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

    /// Appends all words of another column.
    pub(in crate::particles) fn append(&mut self, other: &Self) {
        let codes: Vec<u32> = other.words.names.iter().map(|name| self.code(name)).collect();
        self.words.codes.extend(other.words.codes.iter().map(|&code| codes[code as usize]));
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
