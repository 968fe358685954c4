//! Overrides of scene keys, by a program or from the command line.
//!
//! Overrides are written into the parsed document before it is read, with spans that point into
//! their own text. Errors in them are therefore reported there.

use std::fmt;

use toml::de::{DeArray, DeTable, DeValue};

use crate::names::did_you_mean;
use crate::scene::keys::{is_list, of_other_types};
use crate::scene::value_types::{Span, SpannedValue, type_name};

use super::diagnostics::{Diagnostics, SpannedError};
use super::document::name_of;
use super::nesting::{MAX_DEPTH, too_deep};

/// A key of the scene with a value that replaces the one in the file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Override {
    /// Dotted path of the key, as in `materials.grass.albedo` or `spheres.0.radius`. List entries
    /// are selected by index from 0, or by `name`.
    pub key: String,
    /// A TOML value; a bare word is taken as a string.
    pub value: String,
    option: Vec<String>,
}

impl Override {
    /// Creates an override by a program. Messages show it as `key=value`.
    pub fn new(key: impl Into<String>, value: impl Into<String>) -> Self {
        Self { key: key.into(), value: value.into(), option: Vec::new() }
    }

    /// Sets the words of the command line that the override comes from, such as an option and its
    /// value. Messages then show these words.
    #[must_use]
    pub fn with_option<const N: usize>(mut self, words: [&str; N]) -> Self {
        self.option = words.map(str::to_owned).to_vec();
        self
    }

    /// The words of the command line that the override comes from; empty if a program made it.
    pub fn option(&self) -> &[String] {
        &self.option
    }

    /// Returns where the override comes from, and its text there.
    fn origin(&self) -> (&'static str, String) {
        match self.option.is_empty() {
            true => ("override", format!("{}={}", self.key, self.value)),
            false => ("command line", self.option.join(" ")),
        }
    }
}

/// The words of the command line, or `key=value`.
impl fmt::Display for Override {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.origin().1)
    }
}

/// An [`Override`] arranged so that the spans of its parts point into its text in messages.
#[derive(Debug)]
pub(super) struct ParsedOverride {
    key: String,
    key_span: Span,
    value: String,
    value_span: Span,
    bare_word: String,
}

/// Placeholder key used to parse a value.
const PLACEHOLDER_KEY: &str = "v";

impl ParsedOverride {
    /// Adds the text of the override to the diagnostics.
    pub(super) fn new(given: &Override, report: &mut Diagnostics) -> Self {
        let Override { key, value, .. } = given;
        let (origin, text) = given.origin();
        let begins = report.add_source(origin, &text);
        let whole = begins..begins + text.len();
        let behind = |at: usize, length: usize| begins + at..begins + at + length;
        let key_span = text.find(&**key).map(|at| behind(at, key.len()));
        let value_span = text.rfind(&**value).map(|at| behind(at, value.len()));
        let value_span = value_span.unwrap_or_else(|| whole.clone());
        // Leading blanks shift the spans to the position of the value.
        let blanks = value_span.start - PLACEHOLDER_KEY.len() - 1;
        let value_text = " ".repeat(blanks) + &format!("{PLACEHOLDER_KEY}={value}");
        Self {
            key: format!("{key}=0"),
            key_span: key_span.unwrap_or(whole),
            value: value_text,
            value_span,
            bare_word: value.clone(),
        }
    }

    /// Writes the value into the document. A new `type` takes away the keys of the file that only
    /// other types have, and `fit` what it finds by itself; returns a note for each.
    pub(super) fn apply<'t>(&'t self, root: &mut DeTable<'t>, report: &Diagnostics) -> Vec<String> {
        self.try_apply(root, report).unwrap_or_else(|wrong| {
            report.add(wrong);
            Vec::new()
        })
    }

    fn try_apply<'t>(
        &'t self,
        root: &mut DeTable<'t>,
        report: &Diagnostics,
    ) -> Result<Vec<String>, SpannedError> {
        let path = self.path()?;
        let value = self.value()?;
        let (last, way) = path.split_last().ok_or_else(|| self.error("no key is named".into()))?;
        let mut place = Container::Table(root);
        for (depth, step) in way.iter().enumerate() {
            place = self.descend(place, &path[..depth], step)?;
        }
        match place {
            Container::Table(table) => {
                table.remove(&*last.name);
                let taken = match (&*last.name, value.get_ref()) {
                    ("type", DeValue::String(name)) => take(table, report, &other_types(way, name)),
                    ("fit", DeValue::Boolean(true)) if dotted(way) == "camera" => {
                        take(table, report, &["position", "look_at", "height"])
                    }
                    _ => Vec::new(),
                };
                let note = |key: &str| {
                    let (way, last) = (dotted(way), &last.name);
                    format!(
                        "`{way}.{key}` of the scene is left out: it does not go with this `{last}`"
                    )
                };
                let taken = taken.into_iter().map(note).collect();
                let key = toml::Spanned::new(self.key_span.clone(), last.name.clone().into());
                table.insert(key, value);
                return Ok(taken);
            }
            Container::List(list) => *self.entry(list, way, last)? = value,
        }
        Ok(Vec::new())
    }

    fn descend<'p, 't>(
        &'t self,
        place: Container<'p, 't>,
        parents: &[KeySegment],
        step: &KeySegment,
    ) -> Result<Container<'p, 't>, SpannedError> {
        let node = match place {
            Container::List(list) => self.entry(list, parents, step)?,
            Container::Table(table) => {
                if parents.is_empty() && is_list(&step.name) && !table.contains_key(&*step.name) {
                    let message =
                        format!("the scene has no `[[{}]]` whose keys could be set", step.name);
                    return Err(self.error(message));
                }
                // A partial material would only be reported for its missing keys.
                if matches!(parents, [only] if only.name == "materials") {
                    self.require_material(table, step)?;
                }
                let key = toml::Spanned::new(self.key_span.clone(), step.name.clone().into());
                let empty =
                    || SpannedValue::new(self.key_span.clone(), DeValue::Table(DeTable::default()));
                table.entry(key).or_insert_with(empty)
            }
        };
        let kind = type_name(node);
        match node.get_mut() {
            DeValue::Table(table) => Ok(Container::Table(table)),
            DeValue::Array(list) => Ok(Container::List(list)),
            _ => {
                let path = dotted(&[parents, std::slice::from_ref(step)].concat());
                Err(self.error(format!("`{path}` is {kind} and has no keys")))
            }
        }
    }

    fn require_material(
        &self,
        materials: &DeTable<'_>,
        step: &KeySegment,
    ) -> Result<(), SpannedError> {
        if materials.contains_key(&*step.name) {
            return Ok(());
        }
        let names = materials.keys().map(|key| &**key.get_ref());
        let help = did_you_mean(&step.name, names);
        Err(self.error(format!("there is no material {:?}", step.name)).help(help))
    }

    /// The list entry selected by a path segment, by index or name.
    fn entry<'p, 't>(
        &self,
        list: &'p mut DeArray<'t>,
        parents: &[KeySegment],
        step: &KeySegment,
    ) -> Result<&'p mut SpannedValue<'t>, SpannedError> {
        let (path, count) = (dotted(parents), list.len());
        let index = match step.name.parse() {
            Ok(index) if !step.is_quoted => index,
            _ => self.index_of(&step.name, list, &path)?,
        };
        let outside = format!("`{path}` has {count} entries, counted from 0");
        list.get_mut(index).ok_or_else(|| self.error(outside))
    }

    fn index_of(&self, name: &str, list: &DeArray<'_>, path: &str) -> Result<usize, SpannedError> {
        let is_named = |&i: &usize| name_of(&list[i]) == Some(name);
        let named: Vec<usize> = (0..list.len()).filter(is_named).collect();
        match *named {
            [index] => Ok(index),
            [] => {
                let names = || list.iter().filter_map(name_of);
                let help = did_you_mean(name, names()).or_else(|| known(names(), list.len()));
                Err(self.error(format!("no entry of `{path}` is named {name:?}")).help(help))
            }
            [first, ..] => {
                let message = format!("{} entries of `{path}` are named {name:?}", named.len());
                let help = format!("use its number, such as `{path}.{first}`");
                Err(self.error(message).help(help))
            }
        }
    }

    fn path(&self) -> Result<Vec<KeySegment>, SpannedError> {
        if too_deep(&self.key).is_some() {
            return Err(self.error(format!("the key has more than {MAX_DEPTH} parts")));
        }
        let faulty = |message: &str| self.error(format!("the key cannot be read: {message}"));
        let parsed = DeTable::parse(&self.key).map_err(|error| faulty(error.message()))?;
        let mut steps = Vec::new();
        let mut table = parsed.get_ref();
        loop {
            let mut entries = table.iter();
            let (Some((key, node)), None) = (entries.next(), entries.next()) else {
                return Err(faulty("it must be one dotted name"));
            };
            let is_quoted = self.key[key.span()].starts_with(['"', '\'']);
            steps.push(KeySegment { name: key.get_ref().to_string(), is_quoted });
            match node.get_ref() {
                DeValue::Table(inner) => table = inner,
                _ => return Ok(steps),
            }
        }
    }

    fn value(&self) -> Result<SpannedValue<'_>, SpannedError> {
        if too_deep(&self.value).is_some() {
            let message = format!("tables and lists are nested more than {MAX_DEPTH} deep");
            return Err(SpannedError::value(self.value_span.clone(), message));
        }
        let (mut table, errors) = DeTable::parse_recoverable(&self.value);
        let Some(error) = errors.first() else {
            let value =
                table.get_mut().remove(PLACEHOLDER_KEY).filter(|_| table.get_ref().is_empty());
            let message = "the value must be a single TOML value";
            return value.ok_or_else(|| SpannedError::value(self.value_span.clone(), message));
        };
        let word = self.bare_word.trim();
        let at = error.span().unwrap_or_else(|| self.value_span.clone());
        if word.is_empty() {
            return Err(SpannedError::value(self.value_span.clone(), "the value is missing"));
        }
        if word.starts_with(['"', '\'', '[', '{']) || word.contains('\n') {
            let message = format!("the value is not TOML: {}", error.message());
            return Err(SpannedError::syntax(at, message));
        }
        Ok(SpannedValue::new(self.value_span.clone(), DeValue::String(word.into())))
    }

    fn error(&self, message: String) -> SpannedError {
        SpannedError::value(self.key_span.clone(), message)
    }
}

/// The container in which the next path segment is looked up.
enum Container<'p, 't> {
    Table(&'p mut DeTable<'t>),
    List(&'p mut DeArray<'t>),
}

/// One part of a dotted key.
#[derive(Clone)]
struct KeySegment {
    name: String,
    is_quoted: bool,
}

/// The keys that only other types than `name` have, in a table that has types.
fn other_types(way: &[KeySegment], name: &str) -> Vec<&'static str> {
    match way {
        [only] if only.name == "camera" => of_other_types("camera", name),
        [first, _] if first.name == "materials" => of_other_types("materials.NAME", name),
        _ => Vec::new(),
    }
}

/// Says which entries there are.
fn known<'n>(names: impl Iterator<Item = &'n str>, count: usize) -> Option<String> {
    const MOST: usize = 8;
    let mut names: Vec<String> = names.take(MOST + 1).map(|name| format!("{name:?}")).collect();
    if names.len() > MOST {
        names[MOST] = "...".to_owned();
    }
    let last = count.checked_sub(1)?;
    let numbers = format!("each has a number, from 0 to {last}");
    Some(match names.is_empty() {
        true => numbers,
        false => format!("named are {}; {numbers}", names.join(", ")),
    })
}

/// Removes those of the keys that the file has; returns them.
fn take<'k>(table: &mut DeTable<'_>, report: &Diagnostics, keys: &[&'k str]) -> Vec<&'k str> {
    let is_of_file =
        |key: &&&str| table.get(**key).is_some_and(|node| report.is_in_file(&node.span()));
    let taken: Vec<&str> = keys.iter().filter(is_of_file).copied().collect();
    taken.iter().for_each(|key| {
        table.remove(*key);
    });
    taken
}

fn dotted(path: &[KeySegment]) -> String {
    path.iter().map(|step| &*step.name).collect::<Vec<_>>().join(".")
}
