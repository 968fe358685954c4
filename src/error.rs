//! The one error type of the library.
//!
//! An [`Error`] is opaque so that it can grow; callers ask it questions ([`Error::category`],
//! [`Error::diagnostics`]) and print it. Mistakes in a scene keep their place in the source text, so
//! that the command line can draw an excerpt with a caret under the culprit.

use std::fmt;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

/// The result of everything that can fail.
pub type Result<T> = std::result::Result<T, Error>;

/// Something that went wrong, told in the user's words: what happened, and what to do.
#[derive(Debug)]
pub struct Error {
    repr: Box<Repr>,
}

/// Whose fault an [`Error`] is; the command line turns it into an exit code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Category {
    /// The scene, a table or an option says something impossible.
    Input,
    /// A file could not be read or written.
    File,
    /// An intersector could not be had, or failed.
    Backend,
    /// Somebody asked to stop.
    Cancelled,
}

/// What an advice tells to change. Every program has its own name for it: the command line, an option.
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
    /// The samples of each pixel.
    SamplesPerPixel,
    /// The folder of a scene's files.
    Folder,
    /// Whether a merged picture may lack pixels or samples.
    AllowGaps,
    /// To resume this checkpoint.
    Resume,
    /// To look at what a scene holds.
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

/// One mistake in a scene, with its place in the text where it has one.
#[derive(Clone, Debug)]
pub struct Diagnostic {
    /// What is wrong, as one sentence without a full stop.
    pub message: String,
    /// Where in the text, and the few words written under the caret.
    pub location: Option<SourceLocation>,
    /// What to do about it.
    pub help: Option<String>,
}

/// A stretch of source text, and what to write under it.
#[derive(Clone, Debug)]
pub struct SourceLocation {
    /// The text that the span points into.
    pub source: Arc<SourceText>,
    /// Byte range in the source text.
    pub span: Range<usize>,
    /// A few words for the caret; may be empty.
    pub label: String,
}

/// A named text: a scene file, or an option of the command line.
#[derive(Debug)]
pub struct SourceText {
    /// File name, or the option's name.
    pub name: String,
    /// The whole text.
    pub text: String,
}

impl Error {
    /// An error about what the user asked for.
    pub fn input(message: impl Into<String>) -> Self {
        Self::message(Category::Input, message)
    }

    /// An error of an intersector.
    pub fn backend(message: impl Into<String>) -> Self {
        Self::message(Category::Backend, message)
    }

    /// An error about a file: `doing` completes "cannot ... `path`", and `source` says why.
    pub fn file(
        doing: &str,
        path: &Path,
        source: impl Into<Box<dyn std::error::Error + Send + Sync>>,
    ) -> Self {
        let source = source.into();
        let message = format!("cannot {doing} `{}`: {source}", path.display());
        Self::message(Category::File, message).with_source(source)
    }

    /// The answer to a request to stop before there was anything to show.
    pub fn cancelled() -> Self {
        Self::message(Category::Cancelled, "stopped on request")
    }

    /// All the mistakes found in a scene; `mistakes` must not be empty.
    pub fn from_diagnostics(mistakes: Vec<Diagnostic>) -> Self {
        debug_assert!(!mistakes.is_empty());
        Self { repr: Box::new(Repr::Diagnostics(mistakes)) }
    }

    /// Adds the advice on what to do.
    #[must_use]
    pub fn with_help(mut self, advice: impl Into<String>) -> Self {
        if let Repr::Message { help, .. } = &mut *self.repr {
            *help = Some(advice.into());
        }
        self
    }

    /// Adds a setting that the advice is about, and to what it should be set; empty where that is open.
    #[must_use]
    pub fn with_suggestion(mut self, which: Suggestion, value: impl Into<String>) -> Self {
        if let Repr::Message { settings, .. } = &mut *self.repr {
            settings.push((which, value.into()));
        }
        self
    }

    /// Adds what it comes from.
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

    /// Whose fault it is.
    pub fn category(&self) -> Category {
        match &*self.repr {
            Repr::Diagnostics(_) => Category::Input,
            Repr::Message { category, .. } => *category,
        }
    }

    /// The mistakes of a scene, in the order of the file; empty for other errors.
    pub fn diagnostics(&self) -> &[Diagnostic] {
        match &*self.repr {
            Repr::Diagnostics(mistakes) => mistakes,
            Repr::Message { .. } => &[],
        }
    }

    /// What to do about it, where there is one thing to do.
    pub fn help(&self) -> Option<&str> {
        match &*self.repr {
            Repr::Diagnostics(_) => None,
            Repr::Message { help, .. } => help.as_deref(),
        }
    }

    /// The settings that the advice is about, any of which helps, and to what each should be set; empty
    /// where that is open.
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
    /// Line and column (in characters) of a byte offset, both counted from 1.
    pub fn line_and_column(&self, offset: usize) -> (usize, usize) {
        let before = &self.text[..offset.min(self.text.len())];
        let line_start = before.rfind('\n').map_or(0, |at| at + 1);
        (before.matches('\n').count() + 1, before[line_start..].chars().count() + 1)
    }
}
