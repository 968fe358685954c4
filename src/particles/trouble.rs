//! Errors about the contents of a file.

use std::path::Path;

use crate::error::Error;

/// What is wrong at a place of a file, before it is known which file that is.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Trouble {
    /// The line; the first is 1.
    pub(super) line: Option<u64>,
    /// What is wrong, or what was expected and what was found.
    pub(super) message: String,
    /// How to mend it.
    pub(super) help: Option<String>,
}

/// The result of a reader.
pub(super) type Outcome<T> = std::result::Result<T, Failure>;

/// Why a reader stops.
#[derive(Debug)]
pub(super) enum Failure {
    /// The contents are wrong.
    Trouble(Trouble),
    /// The file cannot be read, or another file is wrong.
    Error(Error),
}

impl Trouble {
    /// Something about the file as a whole.
    pub(super) fn new(message: impl Into<String>) -> Self {
        Self { line: None, message: message.into(), help: None }
    }

    /// Something about a line.
    pub(super) fn at(line: u64, message: impl Into<String>) -> Self {
        Self { line: Some(line), ..Self::new(message) }
    }

    /// Adds advice.
    #[must_use]
    pub(super) fn with_help(self, help: impl Into<String>) -> Self {
        Self { help: Some(help.into()), ..self }
    }

    /// The error for the user.
    pub(super) fn into_error(self, path: &Path) -> Error {
        let place = match self.line {
            Some(line) => format!("{}:{line}", path.display()),
            None => path.display().to_string(),
        };
        let error = Error::input(format!("{place}: {}", printable(&self.message)));
        match self.help {
            Some(help) => error.with_help(printable(&help)),
            None => error,
        }
    }
}

/// A text without control characters, which may come from a file, and of bounded length.
fn printable(text: &str) -> String {
    const MOST: usize = 400;
    let printable = |c: char| if c.is_control() { '\u{fffd}' } else { c };
    let short: String = text.chars().take(MOST).map(printable).collect();
    if text.chars().nth(MOST).is_some() { short + "..." } else { short }
}

impl From<Trouble> for Failure {
    fn from(trouble: Trouble) -> Self {
        Self::Trouble(trouble)
    }
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        Self::Error(error)
    }
}

impl Failure {
    /// Changes what is said about the contents.
    pub(super) fn map(self, change: impl FnOnce(Trouble) -> Trouble) -> Self {
        match self {
            Self::Trouble(trouble) => Self::Trouble(change(trouble)),
            Self::Error(error) => Self::Error(error),
        }
    }

    /// The error for the user.
    pub(super) fn into_error(self, path: &Path) -> Error {
        match self {
            Self::Trouble(trouble) => trouble.into_error(path),
            Self::Error(error) => error,
        }
    }
}

/// A failure to read a file: of the disk, or of what decompresses it.
pub(super) fn io_failure(path: &Path, error: std::io::Error) -> Failure {
    match error.kind() {
        std::io::ErrorKind::UnexpectedEof => {
            Trouble::new("the file ends too early").with_help("is it complete?").into()
        }
        _ => Error::file("read", path, error).into(),
    }
}

/// A part of a line or of a file, fit to be shown in a message.
pub(super) fn shown(bytes: &[u8]) -> String {
    const MOST: usize = 40;
    let text = String::from_utf8_lossy(&bytes[..bytes.len().min(4 * MOST)]);
    let printable = |c: char| if c.is_control() { '\u{fffd}' } else { c };
    let short: String = text.chars().take(MOST).map(printable).collect();
    let is_cut = text.chars().count() > MOST || bytes.len() > 4 * MOST;
    format!("`{short}{}`", if is_cut { "..." } else { "" })
}

/// Something behind the particles that should not be there, because their number, which `counted`
/// tells, is too small.
pub(super) fn uncounted(line: u64, expected: &str, found: &[u8], counted: &str) -> Failure {
    let message = format!("expected {expected}, found {}", shown(found));
    Trouble::at(line, message).with_help(format!("{counted}: are there more?")).into()
}

/// A number with its noun, as in `1 atom` or `2 atoms`.
pub(super) fn plural(number: u64, singular: &str) -> String {
    format!("{number} {singular}{}", if number == 1 { "" } else { "s" })
}
