//! An error in the options for the look of particles.

use std::ops::Range;

use super::expression::ExpressionError;

/// What is wrong with an option, and which.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AppearanceError {
    /// The key of the option.
    pub key: &'static str,
    /// What is wrong, as one sentence without a full stop.
    pub message: String,
    /// Bytes of the option's text that the message is about.
    pub span: Option<Range<usize>>,
    /// How to fix it.
    pub help: Option<String>,
}

impl AppearanceError {
    pub(super) fn new(key: &'static str, message: impl Into<String>) -> Self {
        Self { key, message: message.into(), span: None, help: None }
    }

    pub(super) fn with_help(mut self, help: impl Into<Option<String>>) -> Self {
        self.help = help.into();
        self
    }

    pub(super) fn of_expression(key: &'static str, error: ExpressionError) -> Self {
        let ExpressionError { message, span, help } = error;
        Self { key, message, span: Some(span), help }
    }
}
