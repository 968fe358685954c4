//! Errors of the library as `photosphere.Error`.

use photosphere::Error;
use photosphere::error::{Category, SourceLocation};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Names of texts that are no files: overrides, and options given as keywords.
const NO_FILES: [&str; 2] = ["override", "command line"];

/// Makes the exception for an error. File and line are those of its first place in a file.
pub(crate) fn raise(py: Python<'_>, error: &Error) -> PyErr {
    let help = error.help().or_else(|| error.diagnostics().iter().find_map(|d| d.help.as_deref()));
    let mut places = error.diagnostics().iter().filter_map(|d| d.location.as_ref());
    let place = places.find(|place| is_in_file(place));
    let category = match error.category() {
        Category::Input => "input",
        Category::File => "file",
        Category::Backend => "backend",
        Category::Cancelled => "cancelled",
    };
    new(py, &message(error), help, place, category).unwrap_or_else(|error| error)
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
        Some(place) if !is_in_file(place) => {
            format!("{}: {}", place.source.text, diagnostic.message)
        }
        _ => diagnostic.to_string(),
    };
    error.diagnostics().iter().map(line).collect::<Vec<_>>().join("\n")
}

fn is_in_file(place: &SourceLocation) -> bool {
    !NO_FILES.contains(&place.source.name.as_str())
}
