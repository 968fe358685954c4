//! The mistakes of a scene, gathered with their places.
//!
//! A scene is read from several texts: its file, and the options that override it. Positions in all
//! of them are numbers on one line: the file begins at 0, and each option lies behind the text
//! before it. So one range of numbers, the only thing that a TOML value carries, says where in which
//! text it stands, and sorting by position sorts by text.

use std::cell::RefCell;
use std::collections::BTreeSet;
use std::sync::Arc;

use crate::error::{Error, Mistake, Place, Result, Source};
use crate::scene::kinds::Span;
use crate::scene::problem::{Path, Problem, Problems};

/// How many mistakes are told one by one.
const MOST_TOLD: usize = 100;

/// The gap between two texts on the line.
const GAP: usize = 2;

/// Something wrong at a place; [`Report::add`] makes it a [`Mistake`].
#[derive(Debug)]
pub(super) struct Wrong {
    span: Span,
    kind: Kind,
    message: String,
    label: String,
    help: Option<String>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    /// The text is not TOML.
    Syntax,
    /// What stands there is wrong.
    Value,
    /// Something does not stand anywhere; a syntax error may have hidden it.
    Absence,
}

impl Wrong {
    pub(super) fn value(span: Span, message: impl Into<String>) -> Self {
        Self::new(Kind::Value, span, message.into())
    }

    pub(super) fn absence(span: Span, message: impl Into<String>) -> Self {
        Self::new(Kind::Absence, span, message.into())
    }

    pub(super) fn syntax(span: Span, message: impl Into<String>) -> Self {
        Self::new(Kind::Syntax, span, message.into())
    }

    pub(super) fn label(mut self, label: impl Into<String>) -> Self {
        self.label = label.into();
        self
    }

    pub(super) fn help(mut self, help: impl Into<Option<String>>) -> Self {
        self.help = help.into();
        self
    }

    fn new(kind: Kind, span: Span, message: String) -> Self {
        Self { span, kind, message, label: String::new(), help: None }
    }
}

/// The texts of a scene and the mistakes found in them so far.
#[derive(Debug)]
pub(super) struct Report {
    texts: Vec<Text>,
    found: RefCell<Vec<Wrong>>,
    /// The tables and keys of which something wrong is told, as [`Path`] shows them.
    broken: RefCell<BTreeSet<String>>,
}

#[derive(Debug)]
struct Text {
    begins: usize,
    source: Arc<Source>,
}

impl Report {
    /// A report on a scene file.
    pub(super) fn new(name: &str, text: &str) -> Self {
        let (found, broken) = (RefCell::default(), RefCell::default());
        let mut report = Self { texts: Vec::new(), found, broken };
        report.add_text(name, text);
        report
    }

    /// Puts one more text behind the others; returns where it begins.
    pub(super) fn add_text(&mut self, name: &str, text: &str) -> usize {
        let begins = self.texts.last().map_or(0, |last| last.begins + last.source.text.len() + GAP);
        let source = Arc::new(Source { name: name.to_owned(), text: text.to_owned() });
        self.texts.push(Text { begins, source });
        begins
    }

    /// Notes a mistake and goes on.
    pub(super) fn add(&self, wrong: Wrong) {
        self.found.borrow_mut().push(wrong);
    }

    /// Notes that the value of a key, or a whole table, is not what the file says.
    pub(super) fn mark_broken(&self, path: impl Into<String>) {
        self.broken.borrow_mut().insert(path.into());
    }

    /// Notes the problems of values, at the places that `span_of` finds, but for those that follow from
    /// what was told already.
    pub(super) fn add_problems(&self, problems: Problems, span_of: impl Fn(&Path) -> Span) {
        for Problem { at, involves, message, help } in problems.0 {
            if ![&at].into_iter().chain(&involves).any(|path| self.is_broken(path)) {
                self.add(Wrong::value(span_of(&at), message).help(help));
            }
        }
    }

    /// Whether a key, or a table that it is in, is told to be wrong.
    fn is_broken(&self, path: &Path) -> bool {
        let (path, broken) = (path.to_string(), self.broken.borrow());
        let mut ends = path.match_indices('.').map(|(at, _)| at).chain([path.len()]);
        ends.any(|end| broken.contains(&path[..end]))
    }

    /// The end of the scene file, where what is missing from it could be added.
    pub(super) fn end_of_file(&self) -> Span {
        let end = self.texts[0].source.text.trim_end().len();
        end..end
    }

    /// Whether the place is in the scene file and not in an option.
    pub(super) fn is_in_file(&self, span: &Span) -> bool {
        self.text_at(span.start).begins == 0
    }

    /// A place in words: `name:line:column`, or for an option its own text.
    pub(super) fn words_for(&self, span: &Span) -> String {
        let Text { begins, source } = self.text_at(span.start);
        if *begins > 0 {
            return format!("`{}`", source.text);
        }
        let (line, column) = source.line_and_column(span.start);
        format!("{}:{line}:{column}", source.name)
    }

    /// All that was found, in the order of the texts.
    ///
    /// Where the file is not TOML, what could merely follow from that is left out: everything from
    /// the first such line on, and everything that is missed.
    ///
    /// # Errors
    /// When anything was found.
    pub(super) fn verdict(&self) -> Result<()> {
        let mut found = self.found.take();
        let is_fault_of_file = |w: &&Wrong| w.kind == Kind::Syntax && self.is_in_file(&w.span);
        if let Some(first) = found.iter().filter(is_fault_of_file).map(|w| w.span.start).min() {
            let text = &self.texts[0].source.text.as_bytes()[..first];
            let line = text.iter().rposition(|&byte| byte == b'\n').map_or(0, |at| at + 1);
            let stands = |w: &Wrong| w.kind == Kind::Value && w.span.start < line;
            found.retain(|w| w.kind == Kind::Syntax || stands(w));
        }
        if found.is_empty() {
            return Ok(());
        }
        found.sort_by_key(|w| w.span.start);
        let untold = found.split_off(found.len().min(MOST_TOLD)).len();
        let mut mistakes: Vec<_> = found.into_iter().map(|w| self.mistake(w)).collect();
        if untold > 0 {
            let message = format!("there are {untold} more mistakes");
            mistakes.push(Mistake { message, place: None, help: None });
        }
        Err(Error::mistakes_found(mistakes))
    }

    fn mistake(&self, wrong: Wrong) -> Mistake {
        let Wrong { span, message, label, help, .. } = wrong;
        let Text { begins, source } = self.text_at(span.start);
        let within = |at: usize| (at - begins).min(source.text.len());
        let span = within(span.start)..within(span.end.max(span.start));
        Mistake { message, place: Some(Place { source: source.clone(), span, label }), help }
    }

    fn text_at(&self, position: usize) -> &Text {
        let after = self.texts.partition_point(|text| text.begins <= position);
        &self.texts[after - 1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_find_their_text() {
        let mut report = Report::new("a.toml", "one\ntwo\n");
        let option = report.add_text("command line", "spp = 0");
        report.add(Wrong::value(option + 6..option + 7, "second"));
        report.add(Wrong::value(4..7, "first"));
        let error = report.verdict().expect_err("mistakes");
        assert_eq!(error.to_string(), "a.toml:2:1: first\ncommand line:1:7: second");
        assert_eq!(error.mistakes()[1].place.as_ref().expect("a place").span, 6..7);
    }

    #[test]
    fn what_may_follow_from_a_syntax_error_is_left_out() {
        let report = Report::new("a.toml", "one\ntwo = \nthree\n");
        report.add(Wrong::syntax(10..10, "syntax"));
        report.add(Wrong::value(0..3, "before"));
        report.add(Wrong::value(11..13, "after"));
        report.add(Wrong::absence(0..0, "missing"));
        let error = report.verdict().expect_err("mistakes");
        assert_eq!(error.to_string(), "a.toml:1:1: before\na.toml:2:7: syntax");
    }

    #[test]
    fn a_flood_of_mistakes_is_cut_short() {
        let report = Report::new("a.toml", "x");
        (0..250).for_each(|_| report.add(Wrong::value(0..1, "again")));
        let error = report.verdict().expect_err("mistakes");
        assert_eq!(error.mistakes().len(), 101);
        assert_eq!(error.mistakes()[100].message, "there are 150 more mistakes");
    }
}
