//! The values that a row must have, and what is said if it has others.

use std::sync::atomic::{AtomicUsize, Ordering};

use crate::particles::trouble::{plural, shown};

use super::fields::{FieldUse, Fields};

/// The values that a row must have.
pub(in crate::particles) struct RowValues {
    pub(in crate::particles) uses: Vec<FieldUse>,
    names: Vec<String>,
    /// The value that should have been a number, after an error.
    wrong: AtomicUsize,
}

impl RowValues {
    pub(in crate::particles) fn new(fields: &Fields) -> Self {
        Self {
            uses: fields.0.iter().map(|field| field.is).collect(),
            names: fields.0.iter().map(|field| field.name.clone()).collect(),
            wrong: AtomicUsize::new(usize::MAX),
        }
    }

    /// The value that should have been a number, after an error.
    pub(in crate::particles) fn wrong_field(&self) -> Option<usize> {
        Some(self.wrong.load(Ordering::Relaxed)).filter(|&at| at != usize::MAX)
    }

    /// Says that a row has another number of values.
    #[cold]
    pub(in crate::particles) fn wrong_count(&self, found: usize) -> String {
        const SHOWN: usize = 6;
        let expected = plural(self.uses.len() as u64, "value");
        let missing = self.names.get(found..).unwrap_or_default();
        if missing.is_empty() {
            return format!("expected {expected}, found {found}");
        }
        let verb = if missing.len() == 1 { "is" } else { "are" };
        let more = if missing.len() > SHOWN { " ..." } else { "" };
        let names = missing[..missing.len().min(SHOWN)].join(" ");
        format!("expected {expected}, found {found} ({names}{more} {verb} missing)")
    }

    /// Says that a value is no number, or no finite one.
    #[cold]
    pub(in crate::particles) fn wrong_value(&self, at: usize, token: &[u8]) -> String {
        let what = match self.uses[at] {
            FieldUse::Position(_) => "a finite number",
            _ => {
                self.wrong.store(at, Ordering::Relaxed);
                "a number"
            }
        };
        format!("expected {what} for `{}`, found {}", self.names[at], shown(token))
    }
}
