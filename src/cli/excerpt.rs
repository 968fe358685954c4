//! The excerpt of a text that an error message shows: a line with its neighbours, cut to a width.
//!
//! Scene files may have lines of megabytes, of which only the part around the caret is of use. A
//! column number stays that of the file. Control characters are escaped.

use std::ops::Range;

use miette::{LabeledSpan, MietteError, MietteSpanContents, SourceCode, SourceSpan, SpanContents};

use crate::draw::printable::{printable, printable_line};
use crate::error::SourceLocation;

/// Maximum number of characters shown of a line.
const WIDTH: usize = 120;
/// Replaces what is cut off.
const ELLIPSIS: &str = "...";

/// The lines around a location.
#[derive(Debug)]
pub(super) struct Excerpt {
    name: String,
    text: String,
    /// Number of lines before the excerpt.
    lines_before: usize,
    /// Number of characters before the location, in its line.
    column: usize,
    caret: Range<usize>,
    label: Option<String>,
}

impl Excerpt {
    /// Cuts the excerpt out. A location of several lines ends with the first of them.
    pub(super) fn of(place: &SourceLocation) -> Self {
        let whole = place.source.text.trim_end_matches('\n');
        let start = place.span.start.min(whole.len());
        let begin = whole[..start].rfind('\n').map_or(0, |at| at + 1);
        let end = whole[start..].find('\n').map_or(whole.len(), |at| start + at);
        let before = begin.checked_sub(1).map(|end| whole[..end].rsplit('\n').next());
        let after = whole.get(end + 1..).map(|rest| rest.split('\n').next());

        let mut text = before.flatten().map_or(String::new(), |line| window(line, &(0..0)).0);
        let focus = start - begin..place.span.end.clamp(start, end) - begin;
        let (line, caret) = window(&whole[begin..end], &focus);
        let caret = text.len() + caret.start..text.len() + caret.end;
        text += &line;
        text += &after.flatten().map_or(String::new(), |line| window(line, &(0..0)).0);
        let line_number = whole[..begin].matches('\n').count();
        Self {
            name: printable_line(&place.source.name).into_owned(),
            text,
            lines_before: line_number - usize::from(begin > 0),
            column: whole[begin..start].chars().count(),
            caret,
            label: Some(printable_line(&place.label).into_owned()).filter(|text| !text.is_empty()),
        }
    }

    /// The caret below the location.
    pub(super) fn caret(&self) -> LabeledSpan {
        LabeledSpan::new(self.label.clone(), self.caret.start, self.caret.len())
    }
}

impl SourceCode for Excerpt {
    fn read_span<'a>(
        &'a self,
        span: &SourceSpan,
        context_lines_before: usize,
        context_lines_after: usize,
    ) -> Result<Box<dyn SpanContents<'a> + 'a>, MietteError> {
        let read = self.text.read_span(span, context_lines_before, context_lines_after)?;
        let line = self.lines_before + read.line();
        // Without context, the contents start at the location itself.
        let column = if context_lines_before == 0 { self.column } else { 0 };
        Ok(Box::new(MietteSpanContents::new_named(
            self.name.clone(),
            read.data(),
            *read.span(),
            line,
            column,
            read.line_count(),
        )))
    }
}

/// Returns the part of a line around `focus` with a line break, and where `focus` is in it.
fn window(line: &str, focus: &Range<usize>) -> (String, Range<usize>) {
    let line = line.trim_end_matches('\r');
    let count = |bytes: usize| line[..bytes.min(line.len())].chars().count();
    let (all, start, end) = (line.chars().count(), count(focus.start), count(focus.end));
    let first = start.saturating_sub(WIDTH / 2).min(all.saturating_sub(WIDTH));
    let last = (first + WIDTH).min(all);
    let piece = |columns: Range<usize>| -> String {
        let shown: String = line.chars().skip(columns.start).take(columns.len()).collect();
        printable(&shown).into_owned()
    };
    let mut text = if first > 0 { ELLIPSIS.to_owned() } else { String::new() };
    text += &piece(first..start);
    let begin = text.len();
    text += &piece(start..end.min(last));
    let caret = begin..text.len();
    text += &piece(end.min(last)..last);
    text += if last < all { ELLIPSIS } else { "" };
    (text + "\n", caret)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_short_line_is_shown_whole() {
        assert_eq!(window("radius = 0\r", &(9..10)), ("radius = 0\n".to_owned(), 9..10));
        assert_eq!(window("", &(0..0)), ("\n".to_owned(), 0..0));
        assert_eq!(window("a\u{1b}b", &(2..3)), ("a\\u{1b}b\n".to_owned(), 7..8));
    }

    #[test]
    fn of_a_long_line_the_part_around_the_caret_is_shown() {
        let line = format!("{}é={}", "x".repeat(70_000), "y".repeat(70_000));
        let (text, caret) = window(&line, &(70_000..70_002));
        assert_eq!(&text[caret], "é");
        assert_eq!(text.chars().count(), 2 * ELLIPSIS.len() + WIDTH + 1);
        assert!(text.starts_with("...x") && text.ends_with("y...\n"));
        let (text, caret) = window(&line, &(0..60_000));
        assert_eq!((text.len(), caret), (WIDTH + ELLIPSIS.len() + 1, 0..WIDTH));
        let (text, caret) = window(&line, &(line.len()..line.len()));
        assert_eq!((text.len(), caret), (ELLIPSIS.len() + WIDTH + 1, 123..123));
    }
}
