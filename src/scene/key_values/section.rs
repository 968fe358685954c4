//! One table of keys and their values.

use serde::Serialize;
use serde_json::{Map, Value};

use crate::scene::keys::{Key, KeyVisitor};
use crate::scene::value_types::ValueType;

/// One table of a scene file.
#[derive(Default)]
pub(super) struct Section(Map<String, Value>);

impl Section {
    pub(super) fn set<K>(&mut self, key: &Key<K>, value: impl Serialize) {
        let value = serde_json::to_value(value).expect("plain values are JSON");
        self.0.insert(key.name.to_owned(), value);
    }

    pub(super) fn set_if_given<K>(&mut self, key: &Key<K>, value: Option<impl Serialize>) {
        if let Some(value) = value {
            self.set(key, value);
        }
    }

    pub(super) fn add(&mut self, name: &str, inner: impl Into<Value>) {
        self.0.insert(name.to_owned(), inner.into());
    }
}

impl KeyVisitor for Section {
    fn visit<K>(&mut self, key: &'static Key<K>, value: &mut K::Output)
    where
        K: ValueType,
        K::Output: Serialize,
    {
        self.set(key, &*value);
    }

    fn visit_option<K>(&mut self, key: &'static Key<K>, value: &mut Option<K::Output>)
    where
        K: ValueType,
        K::Output: Serialize,
    {
        self.set_if_given(key, value.as_ref());
    }
}

impl From<Section> for Value {
    fn from(Section(entries): Section) -> Self {
        Self::Object(entries)
    }
}
