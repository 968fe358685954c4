//! An error in an expression, with its span.

use std::ops::Range;
use std::sync::Arc;

use crate::error::{Diagnostic, Error, SourceLocation, SourceText};

/// What is wrong with an expression, and where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ExpressionError {
    /// What is wrong, as one sentence without a full stop.
    pub message: String,
    /// Bytes of the expression that the message is about.
    pub span: Range<usize>,
    /// How to fix it.
    pub help: Option<String>,
}

impl ExpressionError {
    pub(super) fn new(span: Range<usize>, message: impl Into<String>) -> Self {
        Self { message: message.into(), span, help: None }
    }

    pub(super) fn with_help(mut self, help: impl Into<Option<String>>) -> Self {
        self.help = help.into();
        self
    }

    /// The error as one of the library. `name` says where the expression comes from, and `text` is
    /// the text there, in which the expression begins at byte `begin`.
    pub fn locate(self, name: &str, text: &str, begin: usize) -> Error {
        let source = Arc::new(SourceText { name: name.to_owned(), text: text.to_owned() });
        let span = begin + self.span.start..begin + self.span.end;
        let location = Some(SourceLocation { source, span, label: String::new() });
        Error::from_diagnostics(vec![Diagnostic {
            message: self.message,
            location,
            help: self.help,
        }])
    }
}
