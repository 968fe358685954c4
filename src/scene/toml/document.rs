//! A typed cursor over a TOML document.
//!
//! Each read names a key and a value type. Errors are added to the [`Diagnostics`] with their
//! positions, and reading continues, so that all errors of a scene are reported at once. A
//! [`Table`] remembers which keys were read; any other key is reported as unknown.

use std::cell::{Cell, RefCell};

use toml::de::{DeArray, DeTable, DeValue};

use crate::names::did_you_mean;
use crate::scene::keys::{DefaultValue, Key, KeyVisitor};
use crate::scene::synonyms;
use crate::scene::validation_errors::{KeyPath, PathSegment, quote_if_needed};
use crate::scene::value_types::{
    InvalidValue, ParseValue, Span, SpannedValue, ValueType, type_name,
};

use super::diagnostics::{Diagnostics, SpannedError};
use super::nesting::{MAX_DEPTH, too_deep};
use super::not_toml::what_it_looks_like;

/// Maximum number of known keys that a message lists.
const MAX_LISTED_KEYS: usize = 12;

/// Parses TOML. Syntax errors are added to the diagnostics, and the rest of the text is kept; of a
/// text that nests too deeply, nothing is.
pub(super) fn parse<'t>(text: &'t str, report: &Diagnostics) -> DeTable<'t> {
    if let Some(at) = too_deep(text) {
        let message = format!("tables and lists are nested more than {MAX_DEPTH} deep");
        let help = "a scene needs no more than a few levels: [materials.NAME], for example";
        report.add(SpannedError::syntax(at..at + 1, message).help(help.to_owned()));
        return DeTable::new();
    }
    let (root, errors) = DeTable::parse_recoverable(text);
    if let Some(what) = errors.first().and_then(|_| what_it_looks_like(text)) {
        let start = text.len() - text.trim_start().len();
        let end = start + text[start..].find('\n').unwrap_or(text.len() - start);
        let message = format!("this is no scene: it looks like {}", what.name);
        report.add(SpannedError::syntax(start..end, message).help(what.help.to_owned()));
        return DeTable::new();
    }
    for error in errors {
        let span = error.span().unwrap_or_else(|| report.end_of_file());
        report.add(SpannedError::syntax(span, format!("this is not TOML: {}", error.message())));
    }
    root.into_inner()
}

/// A table of the document, or a placeholder for an optional table that is absent.
pub(super) struct Table<'d> {
    /// Path of the table, as written in `--set`; empty for the document root.
    path: String,
    entries: Option<&'d DeTable<'d>>,
    span: Span,
    diagnostics: &'d Diagnostics,
    known: RefCell<Vec<&'static str>>,
    allows_unknown: Cell<bool>,
}

/// Reads the keys of a table that a scene file has; the other values stay.
pub(super) struct TableValues<'a, 'd>(pub(super) &'a Table<'d>);

impl KeyVisitor for TableValues<'_, '_> {
    fn visit<K: ValueType>(&mut self, key: &'static Key<K>, value: &mut K::Output) {
        if let Some(given) = self.0.get(key) {
            *value = given;
        }
    }

    fn visit_option<K: ValueType>(&mut self, key: &'static Key<K>, value: &mut Option<K::Output>) {
        if let Some(given) = self.0.get(key) {
            *value = Some(given);
        }
    }
}

impl<'d> Table<'d> {
    /// Reads the whole document with `read`.
    pub(super) fn root<T>(
        entries: &'d DeTable<'d>,
        report: &'d Diagnostics,
        read: impl FnOnce(&Self) -> T,
    ) -> T {
        Self::new(String::new(), Some(entries), report.end_of_file(), report).read_with(read)
    }

    /// The value of a key; `None` selects the default. A missing required key is an error.
    pub(super) fn get<K: ParseValue>(&self, key: &'static Key<K>) -> Option<K::Output> {
        match key.default {
            DefaultValue::Required => self.required(key.name, &key.kind),
            DefaultValue::Toml(_) | DefaultValue::Derived(_) => self.optional(key.name, &key.kind),
        }
    }

    /// The value of a required key.
    pub(super) fn required<R: ParseValue>(
        &self,
        key: &'static str,
        reader: &R,
    ) -> Option<R::Output> {
        if self.node(key).is_none() {
            let message = format!("`{}` is missing", self.path_to(key));
            let help = format!("add `{key} = ...`, {}", reader.expects());
            self.diagnostics.add(SpannedError::absence(self.span.clone(), message).help(help));
            self.mark_invalid(key);
        }
        self.optional(key, reader)
    }

    /// The value of an optional key.
    pub(super) fn optional<R: ParseValue>(
        &self,
        key: &'static str,
        reader: &R,
    ) -> Option<R::Output> {
        let node = self.node(key)?;
        let unfit = match reader.parse(node) {
            Ok(value) => return Some(value),
            Err(unfit) => unfit,
        };
        let InvalidValue { span, found, help, is_unknown_name: names_nothing } = unfit;
        let message = format!("`{}` must be {}, not {found}", self.path_to(key), reader.expects());
        let make = if names_nothing { SpannedError::absence } else { SpannedError::value };
        self.diagnostics.add(make(span, message).help(help));
        self.mark_invalid(key);
        None
    }

    /// A required table; `help` says what to do without it.
    pub(super) fn section<T: Default>(
        &self,
        key: &'static str,
        help: Option<&str>,
        read: impl FnOnce(&Table<'d>) -> T,
    ) -> T {
        if self.node(key).is_none() {
            let message = format!("`[{}]` is missing", self.path_to(key));
            let help = help.map(str::to_owned);
            self.diagnostics.add(SpannedError::absence(self.span.clone(), message).help(help));
            self.mark_invalid(key);
            return T::default();
        }
        self.optional_section(key, read)
    }

    /// An optional table. If it is absent, `read` finds every key missing.
    pub(super) fn optional_section<T: Default>(
        &self,
        key: &'static str,
        read: impl FnOnce(&Table<'d>) -> T,
    ) -> T {
        let path = self.path_to(key);
        match self.node(key) {
            Some(node) => {
                self.table_at(path, node).map_or_else(T::default, |table| table.read_with(read))
            }
            None => Table::new(path, None, self.span.clone(), self.diagnostics).read_with(read),
        }
    }

    /// An optional table; `None` if it is absent.
    pub(super) fn section_if_present<T>(
        &self,
        key: &'static str,
        read: impl FnOnce(&Table<'d>) -> T,
    ) -> Option<T> {
        let node = self.node(key)?;
        self.table_at(self.path_to(key), node).map(|table| table.read_with(read))
    }

    /// Reads every table in a table of tables, with its name, in text order.
    pub(super) fn named_sections<T: Default>(
        &self,
        key: &'static str,
        read: impl Fn(&'d str, &Table<'d>) -> T,
    ) -> Vec<(&'d str, T)> {
        let path = self.path_to(key);
        let Some(sections) = self.node(key).and_then(|node| self.table_at(path, node)) else {
            return Vec::new();
        };
        let mut entries: Vec<_> = sections.entries.into_iter().flat_map(DeTable::iter).collect();
        entries.sort_by_key(|(name, _)| name.span().start);
        let read_one = |name: &'d str, node: &'d SpannedValue<'d>| {
            let table = self.table_at(sections.path_to(name), node);
            table.map_or_else(T::default, |table| table.read_with(|table| read(name, table)))
        };
        let named = entries.into_iter().map(|(name, node)| (&**name.get_ref(), node));
        named.map(|(name, node)| (name, read_one(name, node))).collect()
    }

    /// Reads every table in a list of tables, in order.
    pub(super) fn sections<T: Default>(
        &self,
        key: &'static str,
        mut read: impl FnMut(&Table<'d>) -> T,
    ) -> Vec<T> {
        let Some(node) = self.node(key) else {
            return Vec::new();
        };
        let Some(entries) = node.get_ref().as_array() else {
            let message = format!("`{key}` must be a list of tables, not {}", type_name(node));
            let help = format!("write `[[{key}]]` above each");
            self.diagnostics.add(SpannedError::value(node.span(), message).help(help));
            self.mark_invalid(key);
            return Vec::new();
        };
        let read_one = |(i, node): (usize, &'d SpannedValue<'d>)| {
            let name = name_of(node).map_or_else(|| i.to_string(), quote_if_needed);
            let table = self.table_at(format!("{key}.{name}"), node);
            table.map_or_else(T::default, |table| table.read_with(&mut read))
        };
        entries.iter().enumerate().map(read_one).collect()
    }

    /// The diagnostics.
    pub(super) fn diagnostics(&self) -> &'d Diagnostics {
        self.diagnostics
    }

    /// Adds an error at a key's value, or at the table's heading if the key is absent.
    pub(super) fn error_at(
        &self,
        key: &str,
        message: impl Into<String>,
        help: impl Into<Option<String>>,
    ) {
        self.diagnostics.add(SpannedError::value(self.span_or_heading(key), message).help(help));
        self.mark_invalid(key);
    }

    /// Marks a key as invalid: its value does not come from the file.
    pub(super) fn mark_invalid(&self, key: &str) {
        self.diagnostics.mark_invalid(self.path_to(key));
    }

    /// Marks the whole table as invalid.
    pub(super) fn mark_all_invalid(&self) {
        self.diagnostics.mark_invalid(&*self.path);
    }

    /// Span of a key's value, if present.
    pub(super) fn span_of(&self, key: &str) -> Option<Span> {
        self.entries?.get(key).map(|node| node.span())
    }

    /// Returns true if a table of this one has a key.
    pub(super) fn has_entry(&self, table: &str, key: &str) -> bool {
        let node = self.entries.and_then(|entries| entries.get(table));
        let inner = node.and_then(|node| node.get_ref().as_table());
        inner.is_some_and(|inner| inner.get(key).is_some())
    }

    /// Returns true if a list of tables is absent or empty.
    pub(super) fn is_empty_list(&self, key: &str) -> bool {
        let node = self.entries.and_then(|entries| entries.get(key));
        node.is_none_or(|node| node.get_ref().as_array().is_some_and(|list| list.is_empty()))
    }

    /// Span of the table's heading.
    pub(super) fn span(&self) -> Span {
        self.span.clone()
    }

    /// Path of a key in this table, as written in `--set`.
    pub(super) fn path_to(&self, key: &str) -> String {
        let key = quote_if_needed(key);
        if self.path.is_empty() { key } else { format!("{}.{key}", self.path) }
    }

    /// Span of a key's value, or of the table's heading.
    fn span_or_heading(&self, key: &str) -> Span {
        self.span_of(key).unwrap_or_else(|| self.span())
    }

    /// Accepts unknown keys from here on, because the valid ones cannot be determined.
    pub(super) fn allow_unknown_keys(&self) {
        self.allows_unknown.set(true);
    }

    fn new(
        path: String,
        entries: Option<&'d DeTable<'d>>,
        span: Span,
        report: &'d Diagnostics,
    ) -> Self {
        Self {
            path,
            entries,
            span,
            diagnostics: report,
            known: RefCell::default(),
            allows_unknown: Cell::new(false),
        }
    }

    /// Reads the table, then reports keys that `read` did not ask for.
    fn read_with<T>(self, read: impl FnOnce(&Self) -> T) -> T {
        let result = read(&self);
        if !self.allows_unknown.get() {
            self.report_unknown_keys();
        }
        result
    }

    fn report_unknown_keys(&self) {
        let known = self.known.borrow();
        for key in self.entries.into_iter().flat_map(DeTable::keys) {
            let name = &**key.get_ref();
            if known.contains(&name) {
                continue;
            }
            let message = format!("unknown key `{}`", self.path_to(name));
            let all = || format!("known keys: {}", known.join(", "));
            let help = synonyms::key(&self.path, name)
                .or_else(|| did_you_mean(name, known.iter().copied()))
                .or_else(|| (known.len() <= MAX_LISTED_KEYS).then(all));
            self.diagnostics
                .add(SpannedError::value(key.span(), message).label("unknown").help(help));
        }
    }

    fn node(&self, key: &'static str) -> Option<&'d SpannedValue<'d>> {
        let mut known = self.known.borrow_mut();
        if !known.contains(&key) {
            known.push(key);
        }
        self.entries?.get(key)
    }

    fn table_at(&self, path: String, node: &'d SpannedValue<'d>) -> Option<Table<'d>> {
        if let DeValue::Table(entries) = node.get_ref() {
            return Some(Table::new(path, Some(entries), node.span(), self.diagnostics));
        }
        let message = format!("`{path}` must be a table, not {}", type_name(node));
        self.diagnostics.add(SpannedError::value(node.span(), message));
        self.diagnostics.mark_invalid(path);
        None
    }
}

/// Span of the value at the end of a path, or of its deepest existing prefix.
pub(super) fn span_at(root: &DeTable<'_>, path: &KeyPath, end_of_file: Span) -> Span {
    let mut span = end_of_file;
    let mut table = Some(root);
    let mut list: Option<&DeArray<'_>> = None;
    for step in path.segments() {
        let node = match step {
            PathSegment::Key(name) => table.and_then(|table| table.get(name.as_str())),
            PathSegment::Entry(index, _) => list.and_then(|list| list.get(*index)),
        };
        let Some(node) = node else { break };
        span = node.span();
        (table, list) = (node.get_ref().as_table(), node.get_ref().as_array());
    }
    span
}

/// The string at the end of a path, if any.
pub(super) fn string_at(root: &DeTable<'_>, [section, key]: [&str; 2]) -> Option<String> {
    let section = root.get(section)?.get_ref().as_table()?;
    section.get(key)?.get_ref().as_str().map(str::to_owned)
}

/// The `name` of a table in a list.
pub(super) fn name_of<'n>(node: &'n SpannedValue<'_>) -> Option<&'n str> {
    node.get_ref().as_table()?.get("name")?.get_ref().as_str()
}
