//! Validation errors of a scene. The values may come from a program or a scene file: an error names
//! its key, and the scene file reader finds the position of that key.

use std::fmt;
use std::ops::Range;

use crate::error::{Diagnostic, Error, Result};

use super::keys::Key;
use super::value_types::ValueType;

/// Path of a key, as written in `--set`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct KeyPath(Vec<PathSegment>);

/// One segment of a path.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum PathSegment {
    /// A key of a table.
    Key(String),
    /// An entry of a list, by its index, with an optional name for messages.
    Entry(usize, Option<String>),
}

/// An error in a value.
#[derive(Clone, Debug)]
pub(super) struct ValidationError {
    pub(super) path: KeyPath,
    /// Keys of other values involved. If one of them is invalid itself, this error is not reported.
    pub(super) related: Vec<KeyPath>,
    pub(super) message: String,
    pub(super) help: Option<String>,
    /// Bytes of a text value that the message is about.
    pub(super) within: Option<Range<usize>>,
}

/// All errors found.
#[derive(Debug, Default)]
pub(super) struct ValidationErrors(pub(super) Vec<ValidationError>);

impl KeyPath {
    /// A table or key at the document root.
    pub(super) fn root(name: &str) -> Self {
        Self(vec![PathSegment::Key(name.to_owned())])
    }

    /// A key in this table.
    pub(super) fn key(&self, name: &str) -> Self {
        self.join(PathSegment::Key(name.to_owned()))
    }

    /// An entry of this list.
    pub(super) fn entry(&self, index: usize, name: Option<&str>) -> Self {
        self.join(PathSegment::Entry(index, name.map(str::to_owned)))
    }

    pub(super) fn segments(&self) -> &[PathSegment] {
        &self.0
    }

    fn join(&self, step: PathSegment) -> Self {
        let mut steps = self.0.clone();
        steps.push(step);
        Self(steps)
    }
}

/// As in `materials.grass.albedo` and `spheres.0.radius`.
impl fmt::Display for KeyPath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (at, step) in self.0.iter().enumerate() {
            let dot = if at > 0 { "." } else { "" };
            match step {
                PathSegment::Key(name) | PathSegment::Entry(_, Some(name)) => {
                    write!(f, "{dot}{}", quote_if_needed(name))?;
                }
                PathSegment::Entry(index, None) => write!(f, "{dot}{index}")?,
            }
        }
        Ok(())
    }
}

/// A name as it appears in a dotted key: bare or quoted.
pub(super) fn quote_if_needed(name: &str) -> String {
    let is_bare = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    let may_be_index = name.bytes().all(|byte| byte.is_ascii_digit());
    if name.chars().all(is_bare) && !may_be_index { name.to_owned() } else { format!("{name:?}") }
}

impl ValidationErrors {
    /// Checks the value of a key.
    pub(super) fn check<K: ValueType>(&mut self, table: &KeyPath, key: &Key<K>, value: &K::Output) {
        if let Err(found) = key.kind.check(value) {
            let at = table.key(key.name);
            let message = format!("`{at}` must be {}, not {found}", key.kind.expects());
            self.add(at, message);
        }
    }

    /// Adds an error; the returned reference allows adding details.
    pub(super) fn add(&mut self, at: KeyPath, message: impl Into<String>) -> &mut ValidationError {
        self.0.push(ValidationError {
            path: at,
            related: Vec::new(),
            message: message.into(),
            help: None,
            within: None,
        });
        self.0.last_mut().expect("it was just added")
    }

    /// Returns an error if there are problems.
    ///
    /// # Errors
    /// Reports all of them.
    pub(super) fn into_result(self) -> Result<()> {
        if self.0.is_empty() {
            return Ok(());
        }
        let mistake =
            |ValidationError { message, help, .. }| Diagnostic { message, location: None, help };
        Err(Error::from_diagnostics(self.0.into_iter().map(mistake).collect()))
    }
}

impl ValidationError {
    /// Sets the help text.
    pub(super) fn with_help(&mut self, help: impl Into<Option<String>>) -> &mut Self {
        self.help = help.into();
        self
    }

    /// Narrows the error to a part of a text value.
    pub(super) fn within(&mut self, part: Option<Range<usize>>) -> &mut Self {
        self.within = part;
        self
    }

    /// Adds a related key.
    pub(super) fn with_related(&mut self, path: KeyPath) -> &mut Self {
        self.related.push(path);
        self
    }
}
