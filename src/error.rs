//! The library's error type.
//!
//! [`Error`] is opaque, so it can grow. Callers query it ([`Error::category`],
//! [`Error::diagnostics`]) and print it. Errors in a scene keep their location in the source text,
//! so that the command line can show an excerpt with a caret.

use std::fmt;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

/// The result type of the library.
pub type Result<T> = std::result::Result<T, Error>;

/// An error message for the user: what is wrong, and how to fix it.
#[derive(Debug)]
pub struct Error {
    repr: Box<Repr>,
}

/// The category of an [`Error`]; the command line maps it to an exit code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Category {
    /// A scene, a table or an option is invalid.
    Input,
    /// A file could not be read or written.
    File,
    /// An intersector is unavailable or failed.
    Backend,
    /// The operation was cancelled.
    Cancelled,
}

/// A setting that an error suggests to change. Each front end has its own name for it, such as a
/// command line option.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Suggestion {
    /// The intersector.
    Intersector,
    /// The number of threads.
    Threads,
    /// The number of spheres to generate.
    Count,
    /// The layers of a picture.
    Layers,
    /// The number of samples per pixel.
    SamplesPerPixel,
    /// The folder of a scene's files.
    Folder,
    /// Permission for a merged picture to lack pixels or samples.
    AllowGaps,
    /// Resuming this checkpoint.
    Resume,
    /// Inspecting a scene.
    Info,
}

#[derive(Debug)]
enum Repr {
    Diagnostics(Vec<Diagnostic>),
    Message {
        category: Category,
        message: String,
        help: Option<String>,
        settings: Vec<(Suggestion, String)>,
        source: Option<Box<dyn std::error::Error + Send + Sync>>,
    },
}

/// One error in a scene, with its location in the text if known.
#[derive(Clone, Debug)]
pub struct Diagnostic {
    /// What is wrong, as one sentence without a full stop.
    pub message: String,
    /// Location in the text, with a label for the caret.
    pub location: Option<SourceLocation>,
    /// How to fix it.
    pub help: Option<String>,
}

/// A span of source text with a label.
#[derive(Clone, Debug)]
pub struct SourceLocation {
    /// The text that the span refers to.
    pub source: Arc<SourceText>,
    /// Byte range in the source text.
    pub span: Range<usize>,
    /// A short label for the caret; may be empty.
    pub label: String,
}

/// A named text: a scene file, an override of one of its keys, or a command line option.
#[derive(Debug)]
pub struct SourceText {
    /// The name of the file, or where the text comes from.
    pub name: String,
    /// The full text.
    pub text: String,
}

impl Error {
    /// Creates an error about invalid input.
    pub fn input(message: impl Into<String>) -> Self {
        Self::message(Category::Input, message)
    }

    /// Creates an error of an intersector.
    pub fn backend(message: impl Into<String>) -> Self {
        Self::message(Category::Backend, message)
    }

    /// Creates a file error: `doing` completes "cannot ... `path`", and `source` gives the reason.
    pub fn file(
        doing: &str,
        path: &Path,
        source: impl Into<Box<dyn std::error::Error + Send + Sync>>,
    ) -> Self {
        let source = source.into();
        let message = format!("cannot {doing} `{}`: {source}", path.display());
        Self::message(Category::File, message).with_source(source)
    }

    /// Creates the error for an operation cancelled before it had a result.
    pub fn cancelled() -> Self {
        Self::message(Category::Cancelled, "stopped on request")
    }

    /// Creates an error from all diagnostics of a scene; `mistakes` must not be empty.
    pub fn from_diagnostics(mistakes: Vec<Diagnostic>) -> Self {
        debug_assert!(!mistakes.is_empty());
        Self { repr: Box::new(Repr::Diagnostics(mistakes)) }
    }

    /// Adds the help text.
    #[must_use]
    pub fn with_help(mut self, advice: impl Into<String>) -> Self {
        if let Repr::Message { help, .. } = &mut *self.repr {
            *help = Some(advice.into());
        }
        self
    }

    /// Adds a setting that the help refers to, and a suggested value; empty if there is none.
    #[must_use]
    pub fn with_suggestion(mut self, which: Suggestion, value: impl Into<String>) -> Self {
        if let Repr::Message { settings, .. } = &mut *self.repr {
            settings.push((which, value.into()));
        }
        self
    }

    /// Adds the underlying error.
    #[must_use]
    pub fn with_source(
        mut self,
        from: impl Into<Box<dyn std::error::Error + Send + Sync>>,
    ) -> Self {
        if let Repr::Message { source, .. } = &mut *self.repr {
            *source = Some(from.into());
        }
        self
    }

    /// The category of the error.
    pub fn category(&self) -> Category {
        match &*self.repr {
            Repr::Diagnostics(_) => Category::Input,
            Repr::Message { category, .. } => *category,
        }
    }

    /// The diagnostics of a scene, in file order; empty for other errors.
    pub fn diagnostics(&self) -> &[Diagnostic] {
        match &*self.repr {
            Repr::Diagnostics(mistakes) => mistakes,
            Repr::Message { .. } => &[],
        }
    }

    /// The help text, if any.
    pub fn help(&self) -> Option<&str> {
        match &*self.repr {
            Repr::Diagnostics(_) => None,
            Repr::Message { help, .. } => help.as_deref(),
        }
    }

    /// The settings that the help refers to, with suggested values (empty if none). Changing any
    /// one of them helps.
    pub fn suggestions(&self) -> impl Iterator<Item = (Suggestion, &str)> {
        let settings: &[(Suggestion, String)] = match &*self.repr {
            Repr::Diagnostics(_) => &[],
            Repr::Message { settings, .. } => settings,
        };
        settings.iter().map(|(which, value)| (*which, value.as_str()))
    }

    fn message(category: Category, message: impl Into<String>) -> Self {
        let message = message.into();
        Self {
            repr: Box::new(Repr::Message {
                category,
                message,
                help: None,
                settings: Vec::new(),
                source: None,
            }),
        }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &*self.repr {
            Repr::Message { message, .. } => f.write_str(message),
            Repr::Diagnostics(mistakes) => {
                for (i, mistake) in mistakes.iter().enumerate() {
                    let separator = if i == 0 { "" } else { "\n" };
                    write!(f, "{separator}{mistake}")?;
                }
                Ok(())
            }
        }
    }
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(place) = &self.location {
            let (line, column) = place.source.line_and_column(place.span.start);
            write!(f, "{}:{line}:{column}: ", place.source.name)?;
        }
        f.write_str(&self.message)
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match &*self.repr {
            Repr::Diagnostics(_) => None,
            Repr::Message { source, .. } => Some(source.as_deref()?),
        }
    }
}

impl SourceText {
    /// Line and column (in characters) of a byte offset, both starting at 1.
    pub fn line_and_column(&self, offset: usize) -> (usize, usize) {
        let before = &self.text[..offset.min(self.text.len())];
        let line_start = before.rfind('\n').map_or(0, |at| at + 1);
        (before.matches('\n').count() + 1, before[line_start..].chars().count() + 1)
    }
}
