//! Error messages: mistakes in a scene with file, line, column, excerpt and caret.
//!
//! miette draws the excerpts. Without a terminal, or with `NO_COLOR`, they are plain ASCII on
//! unwrapped lines, so that scripts and tests can search them.

use std::borrow::Cow;
use std::fmt;
use std::io::IsTerminal;

use miette::{
    GraphicalTheme, MietteDiagnostic, MietteHandler, MietteHandlerOpts, Report, ReportHandler,
};
use serde_json::{Value, json};

use crate::draw::printable::{printable, printable_json, printable_line};
use crate::error::{Category, Diagnostic, Error, Suggestion};

use super::excerpt::Excerpt;
use super::exit::Exit;
use super::print;

/// Maximum number of characters of a message; it may quote a value of any length.
const MAX_MESSAGE: usize = 1000;

/// Prints the error with all its diagnostics, and with `as_json` also as one JSON value on the
/// standard output.
pub(super) fn print(error: &Error, as_json: bool) {
    print::drawn(report(error, &handler()).trim_end());
    if as_json {
        print_json(&to_json(error));
    }
}

/// Returns what [`print`] prints without a terminal, with the JSON value.
pub(super) fn text(error: &Error) -> String {
    report(error, &plain()) + &printable_json(&to_json(error).to_string())
}

/// Prints a failure as the JSON value of a command. Nothing can be done if that fails, too.
pub(super) fn print_json(failure: &Value) {
    let _ = print::json(failure);
}

/// Returns the error as JSON: the exit code, its category, the message, the help, and the
/// diagnostics of a scene.
fn to_json(error: &Error) -> Value {
    let category = match error.category() {
        Category::Input => "input",
        Category::File => "file",
        Category::Backend => "intersector",
        Category::Cancelled => "stopped",
    };
    let diagnostics: Vec<Value> = error.diagnostics().iter().map(diagnostic_json).collect();
    json!({ "error": {
        "exit_code": Exit::of(error) as u8,
        "category": category,
        "message": error.to_string(),
        "help": help(error),
        "diagnostics": diagnostics,
    }})
}

fn diagnostic_json(mistake: &Diagnostic) -> Value {
    let place = mistake.location.as_ref();
    let position = place.map(|place| place.source.line_and_column(place.span.start));
    json!({
        "message": mistake.message,
        "help": mistake.help,
        "file": place.map(|place| &place.source.name),
        "line": position.map(|(line, _)| line),
        "column": position.map(|(_, column)| column),
    })
}

/// Formats the complete error report.
fn report(error: &Error, handler: &MietteHandler) -> String {
    let mistakes = error.diagnostics();
    if mistakes.is_empty() {
        return drawn(&bare(&error.to_string(), help(error).as_deref()).into(), handler);
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
        Suggestion::Resume => {
            return format!("photosphere resume {}", print::shell_path(value.as_ref()));
        }
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
    let bare = bare(&mistake.message, mistake.help.as_deref());
    match &mistake.location {
        None => bare.into(),
        Some(place) => {
            let excerpt = Excerpt::of(place);
            Report::from(bare.with_label(excerpt.caret())).with_source_code(excerpt)
        }
    }
}

/// Creates a diagnostic without a place. File names and values in its texts are escaped.
fn bare(message: &str, help: Option<&str>) -> MietteDiagnostic {
    let bare = MietteDiagnostic::new(printable_line(&shortened(message)));
    match help {
        Some(help) => bare.with_help(printable(help)),
        None => bare,
    }
}

/// Leaves the middle of a long message out.
fn shortened(message: &str) -> Cow<'_, str> {
    let mut starts = message.char_indices().map(|(at, _)| at);
    let Some(cut) = starts.by_ref().nth(MAX_MESSAGE / 2) else { return message.into() };
    let mut ends = message.char_indices().rev().map(|(at, _)| at);
    match ends.nth(MAX_MESSAGE / 2) {
        Some(end) if end > cut => format!("{}...{}", &message[..cut], &message[end..]).into(),
        _ => message.into(),
    }
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
    use crate::error::{SourceLocation, SourceText};
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
    fn a_long_line_and_a_long_message_are_cut() {
        let text = format!("a\n{}\nb", "x".repeat(100_000));
        let mut mistake = mistake(&text, 70_000..70_001);
        mistake.message = format!("{} ends", "long ".repeat(20_000));
        let report = report(&Error::from_diagnostics(vec![mistake]), &plain());
        assert!(report.contains(",-[a.toml:2:69999]"), "{report}");
        assert!(report.contains("\n 2 | ...xxx") && report.contains("xxx...\n"), "{report}");
        assert!(report.contains(" 1 | a\n") && report.contains(" 3 | b\n"), "{report}");
        assert!(report.contains("ends\n"), "{report}");
        assert!(report.lines().all(|line| line.len() < MAX_MESSAGE + 20), "{report}");
    }

    #[test]
    fn control_characters_of_a_file_are_escaped() {
        let mut mistake = mistake("a = \"\u{1b}[2J\u{9b}\"\r\n", 4..12);
        mistake.message = "`\u{1b}]0;x\u{7}\nerror` is wrong".into();
        let report = report(&Error::from_diagnostics(vec![mistake]), &plain());
        assert!(report.contains(r"`\u{1b}]0;x\u{7}\nerror` is wrong"), "{report}");
        assert!(report.contains("a = \"\\u{1b}[2J\\u{9b}\""), "{report}");
        assert!(!report.contains(|c: char| c.is_control() && c != '\n'), "{report:?}");
    }

    #[test]
    fn a_failure_is_one_json_value() {
        let json = to_json(&Error::from_diagnostics(vec![mistake("[a]\nradius = 0\n", 13..14)]));
        let error = &json["error"];
        assert_eq!((&error["exit_code"], &error["category"]), (&json!(3), &json!("input")));
        let expected = json!({
            "message": "the radius is 0", "help": "give it a size",
            "file": "a.toml", "line": 2, "column": 10,
        });
        assert_eq!(error["diagnostics"], json!([expected]));
        let error = &to_json(&Error::cancelled().with_help("wait"))["error"];
        assert_eq!((&error["exit_code"], &error["help"]), (&json!(130), &json!("wait")));
    }

    #[test]
    fn plain_errors_are_a_message_and_its_help() {
        let error = Error::input("no").with_help("try yes");
        assert_eq!(report(&error, &plain()), "error: no\n  help: try yes\n");
        let error = error.with_suggestion(Suggestion::Intersector, "native");
        assert_eq!(report(&error, &plain()), "error: no\n  help: try yes: --accel native\n");
    }
}
