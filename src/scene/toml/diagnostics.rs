//! Collects the errors of a scene with their positions.
//!
//! A scene is read from several texts: its file, and the options that override it. All texts share
//! one range of positions: the file starts at 0, and each option follows the text before it. A
//! span, the only position that a TOML value carries, therefore identifies both text and place, and
//! sorting by position sorts by text.

use std::cell::RefCell;
use std::collections::BTreeSet;
use std::sync::Arc;

use crate::error::{Diagnostic, Error, Result, SourceLocation, SourceText};
use crate::scene::validation_errors::{KeyPath, ValidationError, ValidationErrors};
use crate::scene::value_types::Span;

/// Maximum number of errors reported individually.
const MAX_REPORTED: usize = 100;

/// Gap between the positions of two texts.
const GAP: usize = 2;

/// An error at a span; [`Diagnostics::finish`] reports it.
#[derive(Debug)]
pub(super) struct SpannedError {
    span: Span,
    kind: ErrorKind,
    message: String,
    label: String,
    help: Option<String>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum ErrorKind {
    /// The text is not TOML.
    Syntax,
    /// The value is wrong.
    Value,
    /// Something is missing; a syntax error may have hidden it.
    Absence,
}

impl SpannedError {
    pub(super) fn value(span: Span, message: impl Into<String>) -> Self {
        Self::new(ErrorKind::Value, span, message.into())
    }

    pub(super) fn absence(span: Span, message: impl Into<String>) -> Self {
        Self::new(ErrorKind::Absence, span, message.into())
    }

    pub(super) fn syntax(span: Span, message: impl Into<String>) -> Self {
        Self::new(ErrorKind::Syntax, span, message.into())
    }

    pub(super) fn label(mut self, label: impl Into<String>) -> Self {
        self.label = label.into();
        self
    }

    pub(super) fn help(mut self, help: impl Into<Option<String>>) -> Self {
        self.help = help.into();
        self
    }

    fn new(kind: ErrorKind, span: Span, message: String) -> Self {
        Self { span, kind, message, label: String::new(), help: None }
    }
}

/// The texts of a scene and the errors found so far.
#[derive(Debug)]
pub(super) struct Diagnostics {
    sources: Vec<MappedSource>,
    errors: RefCell<Vec<SpannedError>>,
    /// Paths of tables and keys already reported as invalid, as shown by [`KeyPath`].
    invalid_keys: RefCell<BTreeSet<String>>,
}

#[derive(Debug)]
struct MappedSource {
    start: usize,
    source: Arc<SourceText>,
}

impl Diagnostics {
    /// Diagnostics for a scene file.
    pub(super) fn new(name: &str, text: &str) -> Self {
        let (found, broken) = (RefCell::default(), RefCell::default());
        let mut report = Self { sources: Vec::new(), errors: found, invalid_keys: broken };
        report.add_source(name, text);
        report
    }

    /// Adds a text and returns its start position.
    pub(super) fn add_source(&mut self, name: &str, text: &str) -> usize {
        let begins =
            self.sources.last().map_or(0, |last| last.start + last.source.text.len() + GAP);
        let source = Arc::new(SourceText { name: name.to_owned(), text: text.to_owned() });
        self.sources.push(MappedSource { start: begins, source });
        begins
    }

    /// Adds an error; reading continues.
    pub(super) fn add(&self, wrong: SpannedError) {
        self.errors.borrow_mut().push(wrong);
    }

    /// Marks a key or table as invalid: its value does not come from the file.
    pub(super) fn mark_invalid(&self, path: impl Into<String>) {
        self.invalid_keys.borrow_mut().insert(path.into());
    }

    /// Adds validation errors at the positions found by `span_of`, except those that follow from
    /// errors already reported.
    pub(super) fn add_validation_errors(
        &self,
        problems: ValidationErrors,
        span_of: impl Fn(&KeyPath) -> Span,
    ) {
        for ValidationError { path: at, related: involves, message, help, within } in problems.0 {
            if ![&at].into_iter().chain(&involves).any(|path| self.is_invalid(path)) {
                let span = self.narrowed(span_of(&at), within);
                self.add(SpannedError::value(span, message).help(help));
            }
        }
    }

    /// The part of a text value, which may stand in quotation marks.
    fn narrowed(&self, span: Span, part: Option<Span>) -> Span {
        let Some(part) = part else { return span };
        let holds = |mapped: &&MappedSource| mapped.start <= span.start;
        let Some(mapped) = self.sources.iter().rev().find(holds) else { return span };
        let value = &mapped.source.text[span.start - mapped.start..];
        let quotes = usize::from(value.starts_with(['"', '\'']));
        let start = span.start + quotes + part.start;
        let end = (span.start + quotes + part.end).min(span.end);
        if start <= end { start..end } else { span }
    }

    /// Returns true if a key or an enclosing table is marked as invalid.
    fn is_invalid(&self, path: &KeyPath) -> bool {
        let (path, broken) = (path.to_string(), self.invalid_keys.borrow());
        let mut ends = path.match_indices('.').map(|(at, _)| at).chain([path.len()]);
        ends.any(|end| broken.contains(&path[..end]))
    }

    /// The end of the scene file, where missing entries could be added.
    pub(super) fn end_of_file(&self) -> Span {
        let end = self.sources[0].source.text.trim_end().len();
        end..end
    }

    /// Returns true if the span is in the scene file and not in an option.
    pub(super) fn is_in_file(&self, span: &Span) -> bool {
        self.source_at(span.start).start == 0
    }

    /// A position as text: `name:line:column`, or the text of the option.
    pub(super) fn describe_span(&self, span: &Span) -> String {
        let MappedSource { start: begins, source } = self.source_at(span.start);
        if *begins > 0 {
            return format!("`{}`", source.text);
        }
        let (line, column) = source.line_and_column(span.start);
        format!("{}:{line}:{column}", source.name)
    }

    /// Reports all errors in the order of the texts.
    ///
    /// If the file is not valid TOML, errors that may only follow from that are dropped: everything
    /// after the first syntax error, and all missing entries.
    ///
    /// # Errors
    /// If there are any errors.
    pub(super) fn finish(&self) -> Result<()> {
        let mut found = self.errors.take();
        let is_fault_of_file =
            |w: &&SpannedError| w.kind == ErrorKind::Syntax && self.is_in_file(&w.span);
        if let Some(first) = found.iter().filter(is_fault_of_file).map(|w| w.span.start).min() {
            let text = &self.sources[0].source.text.as_bytes()[..first];
            let line = text.iter().rposition(|&byte| byte == b'\n').map_or(0, |at| at + 1);
            let stands = |w: &SpannedError| w.kind == ErrorKind::Value && w.span.start < line;
            found.retain(|w| w.kind == ErrorKind::Syntax || stands(w));
        }
        if found.is_empty() {
            return Ok(());
        }
        found.sort_by_key(|w| w.span.start);
        let untold = found.split_off(found.len().min(MAX_REPORTED)).len();
        let mut mistakes: Vec<_> = found.into_iter().map(|w| self.to_diagnostic(w)).collect();
        if untold > 0 {
            let message = format!("there are {untold} more errors");
            mistakes.push(Diagnostic { message, location: None, help: None });
        }
        Err(Error::from_diagnostics(mistakes))
    }

    fn to_diagnostic(&self, wrong: SpannedError) -> Diagnostic {
        let SpannedError { span, message, label, help, .. } = wrong;
        let MappedSource { start: begins, source } = self.source_at(span.start);
        let within = |at: usize| (at - begins).min(source.text.len());
        let span = within(span.start)..within(span.end.max(span.start));
        Diagnostic {
            message,
            location: Some(SourceLocation { source: source.clone(), span, label }),
            help,
        }
    }

    fn source_at(&self, position: usize) -> &MappedSource {
        let after = self.sources.partition_point(|text| text.start <= position);
        &self.sources[after - 1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_find_their_text() {
        let mut report = Diagnostics::new("a.toml", "one\ntwo\n");
        let option = report.add_source("command line", "spp = 0");
        report.add(SpannedError::value(option + 6..option + 7, "second"));
        report.add(SpannedError::value(4..7, "first"));
        let error = report.finish().expect_err("mistakes");
        assert_eq!(error.to_string(), "a.toml:2:1: first\ncommand line:1:7: second");
        assert_eq!(error.diagnostics()[1].location.as_ref().expect("a place").span, 6..7);
    }

    #[test]
    fn what_may_follow_from_a_syntax_error_is_left_out() {
        let report = Diagnostics::new("a.toml", "one\ntwo = \nthree\n");
        report.add(SpannedError::syntax(10..10, "syntax"));
        report.add(SpannedError::value(0..3, "before"));
        report.add(SpannedError::value(11..13, "after"));
        report.add(SpannedError::absence(0..0, "missing"));
        let error = report.finish().expect_err("mistakes");
        assert_eq!(error.to_string(), "a.toml:1:1: before\na.toml:2:7: syntax");
    }

    #[test]
    fn a_flood_of_mistakes_is_cut_short() {
        let report = Diagnostics::new("a.toml", "x");
        (0..250).for_each(|_| report.add(SpannedError::value(0..1, "again")));
        let error = report.finish().expect_err("mistakes");
        assert_eq!(error.diagnostics().len(), 101);
        assert_eq!(error.diagnostics()[100].message, "there are 150 more errors");
    }
}
