//! Builds the JSON schema of scene files from the key table.

use serde_json::{Map, Value, json};

use super::key::DefaultValue::Required;
use super::key::{DynKey, TableSchema};
use super::sections::{is_list, tables};

/// The JSON schema of scene files, for editors.
pub fn schema() -> Value {
    let mut root = SchemaNode::default();
    for section in tables() {
        let mut node = &mut root;
        for step in section.path.split('.').filter(|step| !step.is_empty()) {
            node = node.tables.entry(step).or_default();
        }
        node.section = Some(section);
    }
    let mut schema = root.schema();
    schema["$schema"] = json!("http://json-schema.org/draft-07/schema#");
    schema["title"] = json!("photosphere scene");
    schema
}

/// A table and its nested tables.
#[derive(Default)]
struct SchemaNode {
    section: Option<&'static TableSchema>,
    tables: std::collections::BTreeMap<&'static str, SchemaNode>,
}

impl SchemaNode {
    fn schema(&self) -> Value {
        let Some(section) = self.section else {
            // A table of tables: `build_materials`.
            let entry = self.tables.values().next().map(Self::schema);
            return json!({ "type": "object", "additionalProperties": entry });
        };
        let mut shared: Map<String, Value> = Map::new();
        let mut required = Vec::new();
        let add = |keys: &[&dyn DynKey], to: &mut Map<String, Value>, required: &mut Vec<_>| {
            for key in keys {
                let info = key.info(section.path, None);
                to.insert(info.name.to_owned(), key.schema());
                required.extend((info.default == Required).then_some(info.name));
            }
        };
        add(section.keys, &mut shared, &mut required);
        for (name, table) in &self.tables {
            let schema = table.schema();
            let is_list = is_list(name);
            let schema = match is_list {
                true => json!({ "type": "array", "items": schema }),
                false => schema,
            };
            shared.insert((*name).to_owned(), schema);
        }
        if section.types.is_empty() {
            return object_schema(section.help, shared, &required);
        }
        let is_first = |index: usize| index == 0 && !required.contains(&"type");
        let of_type = |(index, (name, keys)): (usize, &(&str, &[&dyn DynKey]))| {
            let (mut properties, mut required) = (shared.clone(), required.clone());
            add(keys, &mut properties, &mut required);
            properties.insert("type".to_owned(), json!({ "const": name }));
            if !is_first(index) && !required.contains(&"type") {
                required.push("type");
            }
            let mut schema = object_schema(section.help, properties, &required);
            if section.path == "camera" {
                // What a fitted camera finds by itself.
                let placed = json!({ "required": ["position", "look_at"] });
                schema["anyOf"] = json!([placed, { "required": ["fit"] }]);
            }
            schema
        };
        json!({ "oneOf": section.types.iter().enumerate().map(of_type).collect::<Vec<_>>() })
    }
}

fn object_schema(help: &str, properties: Map<String, Value>, required: &[&str]) -> Value {
    json!({
        "type": "object",
        "description": help,
        "properties": properties,
        "required": required,
        "additionalProperties": false,
    })
}
