//! Error messages: mistakes in a scene with file, line, column, excerpt and caret.
//!
//! miette draws the excerpts. Without a terminal, or with `NO_COLOR`, they are plain ASCII on
//! unwrapped lines, so that scripts and tests can search them.

use std::fmt;
use std::io::IsTerminal;

use miette::{
    GraphicalTheme, LabeledSpan, MietteDiagnostic, MietteHandler, MietteHandlerOpts, NamedSource,
    Report, ReportHandler,
};

use crate::error::{Diagnostic, Error, SourceLocation, Suggestion};

use super::print;

/// Prints the error with all its diagnostics.
pub(super) fn print(error: &Error) {
    print::note(report(error, &handler()).trim_end());
}

/// Formats the complete error report.
fn report(error: &Error, handler: &MietteHandler) -> String {
    let mistakes = error.diagnostics();
    if mistakes.is_empty() {
        return drawn(&bare(error.to_string(), help(error).as_deref()).into(), handler);
    }
    mistakes.iter().map(|mistake| drawn(&diagnostic(mistake), handler)).collect()
}

/// Returns the help text, with the option that applies it.
fn help(error: &Error) -> Option<String> {
    let help = error.help()?;
    let ways: Vec<String> = error.suggestions().map(way_of).collect();
    Some(if ways.is_empty() { help.to_owned() } else { format!("{help}: {}", ways.join(" or ")) })
}

/// Returns what to type for a suggestion.
fn way_of((setting, value): (Suggestion, &str)) -> String {
    let option = match setting {
        Suggestion::Intersector => "--accel",
        Suggestion::Threads => "--threads",
        Suggestion::Count => "--count",
        Suggestion::Layers => "--layers",
        Suggestion::SamplesPerPixel => "--spp",
        Suggestion::Folder => "--folder",
        Suggestion::AllowGaps => "--allow-gaps",
        Suggestion::Resume => return format!("photosphere resume '{value}'"),
        Suggestion::Info => "photosphere info",
    };
    format!("{option} {value}").trim_end().to_owned()
}

/// Draws one diagnostic at the left margin.
fn drawn(diagnostic: &Report, handler: &MietteHandler) -> String {
    let drawn = Drawing { diagnostic, handler }.to_string();
    format!("{}\n", drawn.trim_start().trim_end())
}

fn diagnostic(mistake: &Diagnostic) -> Report {
    let bare = bare(mistake.message.clone(), mistake.help.as_deref());
    match &mistake.location {
        None => bare.into(),
        Some(place) => {
            // miette draws no marker under the end of a last line that lacks a newline.
            let text = format!("{}\n", place.source.text.trim_end_matches('\n'));
            let source = NamedSource::new(&place.source.name, text);
            Report::from(bare.with_label(label(place))).with_source_code(source)
        }
    }
}

fn bare(message: String, help: Option<&str>) -> MietteDiagnostic {
    let bare = MietteDiagnostic::new(message);
    match help {
        Some(help) => bare.with_help(help),
        None => bare,
    }
}

fn label(place: &SourceLocation) -> LabeledSpan {
    let end = place.span.end.min(place.source.text.trim_end_matches('\n').len());
    let start = place.span.start.min(end);
    let words = Some(place.label.clone()).filter(|words| !words.is_empty());
    LabeledSpan::new(words, start, end - start)
}

/// Creates miette's handler, with colour and the terminal's width if there is a terminal.
fn handler() -> MietteHandler {
    let wanted = |variable: &str| std::env::var_os(variable).is_some_and(|value| !value.is_empty());
    let dumb = std::env::var_os("TERM").is_some_and(|term| term == "dumb");
    if std::io::stderr().is_terminal() && !wanted("NO_COLOR") && !dumb {
        drawn_with(GraphicalTheme::ascii()).build()
    } else {
        plain()
    }
}

fn plain() -> MietteHandler {
    drawn_with(GraphicalTheme::none()).width(usize::MAX).wrap_lines(false).build()
}

fn drawn_with(mut theme: GraphicalTheme) -> MietteHandlerOpts {
    "error:".clone_into(&mut theme.characters.error);
    MietteHandlerOpts::new().force_graphical(true).terminal_links(false).graphical_theme(theme)
}

/// Adapter to `Display`: miette draws through a formatter.
struct Drawing<'a> {
    diagnostic: &'a Report,
    handler: &'a MietteHandler,
}

impl fmt::Display for Drawing<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.handler.debug(self.diagnostic.as_ref(), f)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::SourceText;
    use std::sync::Arc;

    fn mistake(text: &str, span: std::ops::Range<usize>) -> Diagnostic {
        let source = Arc::new(SourceText { name: "a.toml".into(), text: text.into() });
        let place = SourceLocation { source, span, label: "not positive".into() };
        Diagnostic {
            message: "the radius is 0".into(),
            location: Some(place),
            help: Some("give it a size".into()),
        }
    }

    #[test]
    fn all_mistakes_are_drawn_with_place_and_caret() {
        let text = "[a]\nradius = 0\n";
        let mistakes = vec![mistake(text, 13..14), mistake(text, 1..2)];
        let report = report(&Error::from_diagnostics(mistakes), &plain());
        let expected = "\
error: the radius is 0
   ,-[a.toml:2:10]
 1 | [a]
 2 | radius = 0
   :          |
   :          `-- not positive
   `----
  help: give it a size
error: the radius is 0
   ,-[a.toml:1:2]";
        assert!(report.starts_with(expected), "{report}");
    }

    #[test]
    fn a_place_at_the_end_or_beyond_is_still_drawn() {
        for (text, span) in [("", 0..0), ("a", 1..1), ("a\n", 2..2), ("a\n", 7..9)] {
            let report = report(&Error::from_diagnostics(vec![mistake(text, span)]), &plain());
            assert!(report.contains("[a.toml:") && report.contains("not positive"), "{report}");
        }
    }

    #[test]
    fn plain_errors_are_a_message_and_its_help() {
        let error = Error::input("no").with_help("try yes");
        assert_eq!(report(&error, &plain()), "error: no\n  help: try yes\n");
        let error = error.with_suggestion(Suggestion::Intersector, "native");
        assert_eq!(report(&error, &plain()), "error: no\n  help: try yes: --accel native\n");
    }
}
