//! Errors of the library as `photosphere.Error`.

use photosphere::Error;
use photosphere::error::{Category, SourceLocation, Suggestion};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Names of texts that are no files: overrides, and options given as keywords.
const NO_FILES: [&str; 3] = ["override", "command line", SCENE];

/// The name of the text of a scene that was made of objects.
const SCENE: &str = "the scene";

/// Makes the exception for an error. File and line are those of its first place in a file.
pub(crate) fn raise(py: Python<'_>, error: &Error) -> PyErr {
    let of_diagnostics = || error.diagnostics().iter().find_map(|d| d.help.clone());
    let help = help(error).or_else(of_diagnostics);
    let mut places = error.diagnostics().iter().filter_map(|d| d.location.as_ref());
    let place = places.find(|place| is_in_file(place));
    let category = match error.category() {
        Category::Input => "input",
        Category::File => "file",
        Category::Backend => "backend",
        Category::Cancelled => "cancelled",
    };
    new(py, &message(error), help.as_deref(), place, category).unwrap_or_else(|error| error)
}

/// The help, with what to write in Python.
fn help(error: &Error) -> Option<String> {
    let help = error.help()?;
    let ways: Vec<String> = error.suggestions().filter_map(way_of).collect();
    Some(if ways.is_empty() { help.to_owned() } else { format!("{help}: {}", ways.join(" or ")) })
}

fn way_of((setting, value): (Suggestion, &str)) -> Option<String> {
    Some(match setting {
        Suggestion::Intersector => format!("accel={value:?}"),
        Suggestion::Threads => "threads=...".to_owned(),
        Suggestion::Layers => format!("layers=[{value:?}]"),
        Suggestion::SamplesPerPixel => format!("spp={value}"),
        Suggestion::AllowGaps => "allow_gaps=True".to_owned(),
        Suggestion::Resume => format!("photosphere.resume({value:?})"),
        Suggestion::Count | Suggestion::Folder | Suggestion::Info => return None,
    })
}

/// Makes the exception for options that cannot be read.
pub(crate) fn raise_usage(py: Python<'_>, message: &str) -> PyErr {
    new(py, message, None, None, "usage").unwrap_or_else(|error| error)
}

fn new(
    py: Python<'_>,
    message: &str,
    help: Option<&str>,
    place: Option<&SourceLocation>,
    category: &str,
) -> PyResult<PyErr> {
    let class = py.import("photosphere._errors")?.getattr("Error")?;
    let more = PyDict::new(py);
    more.set_item("help", help)?;
    more.set_item("category", category)?;
    if let Some(SourceLocation { source, span, .. }) = place {
        let (line, column) = source.line_and_column(span.start);
        more.set_item("file", &source.name)?;
        more.set_item("line", line)?;
        more.set_item("column", column)?;
    }
    Ok(PyErr::from_value(class.call((message,), Some(&more))?))
}

/// All that is wrong, a line each. A place in a keyword is shown as the keyword.
fn message(error: &Error) -> String {
    if error.diagnostics().is_empty() {
        return error.to_string();
    }
    let line = |diagnostic: &photosphere::error::Diagnostic| match &diagnostic.location {
        Some(place) if place.source.name == SCENE => {
            let (heading, key) = key_at(&place.source.text, place.span.start);
            match diagnostic.message.contains(key) {
                true => diagnostic.message.clone(),
                false => format!("{heading} {key}: {}", diagnostic.message),
            }
        }
        Some(place) if !is_in_file(place) => {
            format!("{}: {}", place.source.text, diagnostic.message)
        }
        _ => diagnostic.to_string(),
    };
    error.diagnostics().iter().map(line).collect::<Vec<_>>().join("\n")
}

/// The heading and the key at a place of a scene's text, as in `[materials.gold]`, `roughness`.
fn key_at(text: &str, at: usize) -> (&str, &str) {
    let before = text.get(..at).unwrap_or_default();
    let begin = before.rfind('\n').map_or(0, |end| end + 1);
    let line = text[begin..].lines().next().unwrap_or_default();
    let heading = before.lines().rev().find(|line| line.starts_with('[')).unwrap_or_default();
    (heading, line.split(" = ").next().unwrap_or_default())
}

fn is_in_file(place: &SourceLocation) -> bool {
    !NO_FILES.contains(&place.source.name.as_str())
}
