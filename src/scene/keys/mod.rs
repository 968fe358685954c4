//! The table of scene file keys. Each key is declared once: its name, value type, default and
//! meaning. The scene file reader, the validation of values from a program, the command line
//! options, the JSON schema for editors and the manual are generated from this table or tested
//! against it.

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
    /// Default value, as TOML or described in words.
    pub(super) default: DefaultValue,
    /// One sentence without a full stop.
    pub(super) help: &'static str,
    pub(super) option: Option<CliOption>,
}

/// The value of a key that is omitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DefaultValue {
    /// The key is required.
    Required,
    /// A TOML value.
    Toml(&'static str),
    /// A description in words: the default depends on other keys.
    Derived(&'static str),
}

/// The command line option that sets a key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CliOption {
    /// Name of the option.
    pub name: &'static str,
    /// Placeholder for the value in help texts.
    pub value: &'static str,
    /// Help text, if it differs from the key's.
    pub help: Option<&'static str>,
}

/// Documentation of a key, independent of its value type.
#[derive(Clone, Debug)]
pub struct KeyInfo {
    /// The table that contains the key: `image`, `render.paper`, `materials.NAME`.
    pub table: &'static str,
    /// The `type` to which the key is restricted, if any.
    pub of_type: Option<&'static str>,
    /// Name of the key within its table.
    pub name: &'static str,
    /// Description of the allowed values.
    pub expects: String,
    /// JSON schema of the value.
    pub schema: Value,
    /// The value if the key is omitted.
    pub default: DefaultValue,
    /// Meaning of the key.
    pub help: &'static str,
    /// The option that sets the key.
    pub option: Option<CliOption>,
}

/// A key of any value type.
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

/// Converts a TOML value to JSON.
fn json_from_toml(text: &str) -> Option<Value> {
    // Every default in the table is written alike in TOML and JSON.
    serde_json::from_str(text).ok()
}

/// A table of a scene file.
struct TableSchema {
    path: &'static str,
    help: &'static str,
    keys: &'static [&'static dyn DynKey],
    /// The types of the table, each with the keys that only it has; the first type is the default.
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
