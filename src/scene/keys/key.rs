//! What a key of a scene file is, and the table that it stands in.

use serde::Serialize;
use serde_json::{Value, json};

use crate::scene::value_types::ValueType;

/// One key.
pub(in crate::scene) struct Key<K> {
    pub(in crate::scene) name: &'static str,
    pub(in crate::scene) kind: K,
    /// As a scene file would write it; or in words, in brackets.
    pub(in crate::scene) default: DefaultValue,
    /// One sentence without a full stop.
    pub(in crate::scene) help: &'static str,
    pub(in crate::scene) option: Option<CliOption>,
}

/// What a key is where it is left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DefaultValue {
    /// The key is required.
    Required,
    /// This, in TOML.
    Toml(&'static str),
    /// This, in words: it depends on other keys.
    Derived(&'static str),
}

/// The option of the command line that sets a key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CliOption {
    /// The name of the option.
    pub name: &'static str,
    /// What stands for its value in a description.
    pub value: &'static str,
    /// What is said of it, where that is not what is said of the key.
    pub help: Option<&'static str>,
}

/// What anybody needs to know of a key, whatever it holds.
#[derive(Clone, Debug)]
pub struct KeyInfo {
    /// The table that it stands in: `image`, `render.paper`, `materials.NAME`.
    pub table: &'static str,
    /// The `type` of the table that it belongs to, if it is of one type only.
    pub of_type: Option<&'static str>,
    /// The name of the key in that table.
    pub name: &'static str,
    /// What it may hold, in words.
    pub expects: String,
    /// The allowed values as a JSON schema.
    pub schema: Value,
    /// What it is where it is left out.
    pub default: DefaultValue,
    /// What it means.
    pub help: &'static str,
    /// The option that sets it.
    pub option: Option<CliOption>,
}

/// A key whose kind does not matter.
pub(in crate::scene) trait DynKey: Sync {
    fn info(&self, table: &'static str, of_type: Option<&'static str>) -> KeyInfo;
    fn schema(&self) -> Value;
}

impl<K: ValueType + Sync> DynKey for Key<K> {
    fn info(&self, table: &'static str, of_type: Option<&'static str>) -> KeyInfo {
        let Self { name, ref kind, default, help, option } = *self;
        let (expects, schema) = (kind.expects(), kind.schema());
        KeyInfo { table, of_type, name, expects, schema, default, help, option }
    }

    fn schema(&self) -> Value {
        let mut schema = self.kind.schema();
        schema["description"] = json!(self.help);
        let default = match self.default {
            DefaultValue::Toml(text) => json_from_toml(text),
            _ => None,
        };
        if let Some(value) = default {
            schema["default"] = value;
        }
        schema
    }
}

/// A TOML value as JSON.
fn json_from_toml(text: &str) -> Option<Value> {
    // Every default in the table is written alike in both.
    serde_json::from_str(text).ok()
}

/// A table of a scene file.
pub(super) struct TableSchema {
    pub(super) path: &'static str,
    pub(super) help: &'static str,
    pub(super) keys: &'static [&'static dyn DynKey],
    /// The types of the table, each with the keys that only it has; the first is the one where none
    /// is named.
    pub(super) types: &'static [(&'static str, &'static [&'static dyn DynKey])],
}

pub(super) const fn key<K>(
    name: &'static str,
    kind: K,
    default: DefaultValue,
    help: &'static str,
) -> Key<K> {
    Key { name, kind, default, help, option: None }
}

pub(super) const fn key_with_option<K>(
    name: &'static str,
    kind: K,
    default: DefaultValue,
    help: &'static str,
    option: CliOption,
) -> Key<K> {
    Key { name, kind, default, help, option: Some(option) }
}

pub(super) const fn option(name: &'static str, value: &'static str) -> CliOption {
    CliOption { name, value, help: None }
}

/// The keys of an untyped table of a scene file.
pub(super) const fn untyped_table(
    path: &'static str,
    help: &'static str,
    keys: &'static [&'static dyn DynKey],
) -> TableSchema {
    TableSchema { path, help, keys, types: &[] }
}

/// Visits the keys of one table together with their values. The reader of scene files, the check
/// of values and their output under the names of the keys are such visitors.
pub(in crate::scene) trait KeyVisitor {
    /// Visits a key that always has a value.
    fn visit<K>(&mut self, key: &'static Key<K>, value: &mut K::Output)
    where
        K: ValueType,
        K::Output: Serialize;

    /// Visits a key without a value where it is left out.
    fn visit_option<K>(&mut self, key: &'static Key<K>, value: &mut Option<K::Output>)
    where
        K: ValueType,
        K::Output: Serialize;
}

/// Declares the keys of a table, and `ALL` of them.
macro_rules! keys {
    ($($(#[$doc:meta])* $id:ident: $kind:ty = $key:expr;)+) => {
        $($(#[$doc])* pub(in crate::scene) const $id: Key<$kind> = $key;)+
        pub(in crate::scene) const ALL: &[&dyn DynKey] = &[$(&$id),+];
    };
}
pub(super) use keys;
