//! Every key of a scene file, declared once: its name, what it may hold, what it is where it is left
//! out, and what it means. The reader of scene files, the check of values that a program gives, the
//! command line's options, the JSON schema for editors, and the manual are made of this table or
//! tested against it.

mod entries;
mod schema;
mod sections;

use serde_json::{Value, json};

use super::value_types::ValueType;

pub(super) use entries::{
    MIN_RADIUS, background, camera, image, material, render, root, sphere, table,
};
pub use schema::schema;

/// One key.
pub(super) struct Key<K> {
    pub(super) name: &'static str,
    pub(super) kind: K,
    /// As a scene file would write it; or in words, in brackets.
    pub(super) default: DefaultValue,
    /// One sentence without a full stop.
    pub(super) help: &'static str,
    pub(super) option: Option<CliOption>,
}

/// What a key is where it is left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DefaultValue {
    /// It may not be left out.
    Required,
    /// This, in TOML.
    Toml(&'static str),
    /// This, in words: it depends on other keys.
    Derived(&'static str),
}

/// The option of the command line that sets a key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CliOption {
    /// Its name.
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
    /// Its name in that table.
    pub name: &'static str,
    /// What it may hold, in words.
    pub expects: String,
    /// The same as a JSON schema.
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
struct TableSchema {
    path: &'static str,
    help: &'static str,
    keys: &'static [&'static dyn DynKey],
    /// Its types, each with the keys that only it has; the first is the one where none is named.
    types: &'static [(&'static str, &'static [&'static dyn DynKey])],
}

const fn key<K>(name: &'static str, kind: K, default: DefaultValue, help: &'static str) -> Key<K> {
    Key { name, kind, default, help, option: None }
}

const fn key_with_option<K>(
    name: &'static str,
    kind: K,
    default: DefaultValue,
    help: &'static str,
    option: CliOption,
) -> Key<K> {
    Key { name, kind, default, help, option: Some(option) }
}

const fn option(name: &'static str, value: &'static str) -> CliOption {
    CliOption { name, value, help: None }
}

/// Every key of a scene file, table by table.
pub fn all() -> Vec<KeyInfo> {
    let of_section = |section: &'static TableSchema| {
        let common = section.keys.iter().map(|key| key.info(section.path, None));
        let typed = section
            .types
            .iter()
            .flat_map(|(name, keys)| keys.iter().map(|key| key.info(section.path, Some(name))));
        common.chain(typed)
    };
    sections::TABLES.iter().flat_map(of_section).collect()
}
