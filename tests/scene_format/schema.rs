//! The JSON schema knows every key, and takes the scenes that the reader takes.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use photosphere::scene::keys::{all, schema};
use serde_json::{Map, Value, json};
use toml::de::{DeTable, DeValue};

use crate::scenes::{EXAMPLE, SCENE};

type Place = (String, Option<String>, String);

/// Every key of a table's schema and of those in it, with its table and that one's type.
fn places(schema: &Value, table: &str, places: &mut BTreeSet<Place>) {
    if let Some(types) = schema["oneOf"].as_array() {
        return types.iter().for_each(|of_type| self::places(of_type, table, places));
    }
    let properties = schema["properties"].as_object().expect("a table has keys");
    let of_type = properties.get("type").and_then(|key| key["const"].as_str());
    for (name, key) in properties {
        let inner = if table.is_empty() { name.clone() } else { format!("{table}.{name}") };
        if key["items"]["properties"].is_object() {
            self::places(&key["items"], &inner, places);
        } else if key["additionalProperties"].is_object() {
            self::places(&key["additionalProperties"], &format!("{inner}.NAME"), places);
        } else if key["properties"].is_object() || key["oneOf"].is_array() {
            self::places(key, &inner, places);
        } else {
            places.insert((table.to_owned(), of_type.map(str::to_owned), name.clone()));
        }
    }
}

#[test]
fn the_schema_has_every_key_and_no_other() {
    let mut found = BTreeSet::new();
    places(&schema(), "", &mut found);
    let keys = all();
    let types_of = |table: &str| -> BTreeSet<Option<String>> {
        let of_table = found.iter().filter(|place| place.0 == table);
        of_table.map(|(_, of_type, _)| of_type.clone()).collect()
    };
    let mut expected = BTreeSet::new();
    for key in &keys {
        let place = |of_type| (key.table.to_owned(), of_type, key.name.to_owned());
        match key.of_type {
            Some(of_type) => _ = expected.insert(place(Some(of_type.to_owned()))),
            // A key of every type stands in the schema of each.
            None => expected.extend(types_of(key.table).into_iter().map(place)),
        }
    }
    assert_eq!(found, expected);
    let types = |table: &str| types_of(table).len();
    assert_eq!((types("camera"), types("materials.NAME"), types("render")), (3, 7, 1));
}

/// A TOML value as JSON.
fn json_of(value: &DeValue<'_>) -> Value {
    match value {
        DeValue::String(text) => json!(text),
        DeValue::Integer(integer) => {
            json!(i64::from_str_radix(integer.as_str(), integer.radix()).expect("64 bits"))
        }
        DeValue::Float(float) => json!(float.as_str().parse::<f64>().expect("a number")),
        DeValue::Boolean(flag) => json!(flag),
        DeValue::Array(list) => list.iter().map(|entry| json_of(entry.get_ref())).collect(),
        DeValue::Table(table) => json_of_table(table),
        DeValue::Datetime(_) => panic!("no key of a scene is a date"),
    }
}

fn json_of_table(table: &DeTable<'_>) -> Value {
    let entry = |(key, value): (&toml::Spanned<_>, &toml::Spanned<DeValue<'_>>)| {
        let key: &std::borrow::Cow<'_, str> = key.get_ref();
        (key.to_string(), json_of(value.get_ref()))
    };
    Value::Object(table.iter().map(entry).collect::<Map<_, _>>())
}

/// Checks a value by the words of JSON schema that ours uses; any other word is an error.
fn check(value: &Value, schema: &Value, at: &str) -> Result<(), String> {
    for (word, rule) in schema.as_object().expect("a schema is an object") {
        let number = || rule.as_f64().expect("a limit is a number");
        let x = value.as_f64();
        let length = value.as_array().map(Vec::len).or(value.as_str().map(str::len));
        let is_right = match word.as_str() {
            "$schema" | "title" | "description" | "default" => true,
            "type" => match rule.as_array() {
                Some(types) => types.iter().any(|of_type| is_of_type(value, of_type)),
                None => is_of_type(value, rule),
            },
            "const" => value == rule,
            "enum" => rule.as_array().expect("a list").contains(value),
            // A limit of one type does not apply to values of others.
            "minimum" => x.is_none_or(|x| x >= number()),
            "maximum" => x.is_none_or(|x| x <= number()),
            "exclusiveMinimum" => x.is_none_or(|x| x > number()),
            "exclusiveMaximum" => x.is_none_or(|x| x < number()),
            "minItems" | "minLength" => length.is_none_or(|length| length as f64 >= number()),
            "maxItems" | "maxLength" => length.is_none_or(|length| length as f64 <= number()),
            "required" => {
                let mut names = rule.as_array().expect("a list").iter();
                names.all(|name| value.get(name.as_str().expect("a name")).is_some())
            }
            "items" => {
                let mut entries = value.as_array().into_iter().flatten().enumerate();
                entries.try_for_each(|(i, entry)| check(entry, rule, &format!("{at}.{i}")))?;
                true
            }
            "properties" | "additionalProperties" => {
                check_properties(value, schema, at)?;
                true
            }
            "oneOf" => {
                let types = rule.as_array().expect("a list");
                types.iter().filter(|of_type| check(value, of_type, at).is_ok()).count() == 1
            }
            "anyOf" => {
                let choices = rule.as_array().expect("a list");
                choices.iter().any(|choice| check(value, choice, at).is_ok())
            }
            other => panic!("{other} is no word that is checked here"),
        };
        if !is_right {
            return Err(format!("{at}: {value} breaks {word}: {rule}"));
        }
    }
    Ok(())
}

fn is_of_type(value: &Value, name: &Value) -> bool {
    match name.as_str().expect("the name of a type") {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "integer" => value.is_i64() || value.is_u64(),
        "number" => value.is_number(),
        other => panic!("{other} is no type that is checked here"),
    }
}

fn check_properties(value: &Value, schema: &Value, at: &str) -> Result<(), String> {
    for (name, value) in value.as_object().into_iter().flatten() {
        let at = format!("{at}.{name}");
        match (schema["properties"].get(name), &schema["additionalProperties"]) {
            (Some(rule), _) | (None, rule @ Value::Object(_)) => check(value, rule, &at)?,
            (None, _) => return Err(format!("{at} is not in the schema")),
        }
    }
    Ok(())
}

fn check_text(text: &str) -> Result<(), String> {
    let table = DeTable::parse(text).expect("TOML");
    check(&json_of_table(table.get_ref()), &schema(), "")
}

/// All scene files below a folder.
fn scenes_in(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            scenes_in(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "toml") {
            found.push(path);
        }
    }
}

#[test]
fn every_scene_of_ours_fits_the_schema() {
    let mut paths = Vec::new();
    scenes_in(Path::new("scenes"), &mut paths);
    assert!(paths.len() > 10, "{paths:?}");
    for path in paths {
        let text = std::fs::read_to_string(&path).expect("a scene of ours");
        check_text(&text).unwrap_or_else(|wrong| panic!("{}: {wrong}", path.display()));
    }
    check_text(EXAMPLE).expect("it has every section");
    check_text(SCENE).expect("the smallest scene");
}

#[test]
fn columns_have_types_in_the_schema() {
    let with = |column: &str| {
        let table = format!("{{ file = \"a\", columns = [{column:?}], material = \"grass\" }}");
        check_text(&format!("sphere_tables = [{table}]\n{SCENE}"))
    };
    for column in ["x", "x:f64", "_", "_:f64", "emission", "emission_b:f32"] {
        with(column).unwrap_or_else(|wrong| panic!("{column}: {wrong}"));
    }
    for column in ["x:f8", "f64", "x:", "emission_blue"] {
        assert!(with(column).is_err(), "{column} fits");
    }
}

#[test]
fn mistakes_do_not_fit_the_schema() {
    for (old, new) in [
        ("width = 64", "widht = 64"),
        ("width = 64", "width = 0"),
        ("width = 64", "width = 64.5"),
        ("position = [0, 1, 5]", "position = [0, 1]"),
        ("position = [0, 1, 5]", "position = [0, 1, 2e15]"),
        ("position = [0, 1, 5]", ""),
        ("look_at = [0, 1, 0]", "look_at = [0, 1, 0]\nheight = 3"),
        ("look_at = [0, 1, 0]", "look_at = [0, 1, 0]\nvertical_fov_degrees = 180"),
        ("type = \"diffuse\"", "type = \"diffus\""),
        ("type = \"diffuse\"", ""),
        ("albedo = [0.2, 0.6, 0.2]", "reflectance = [0.2, 0.6, 0.2]"),
        ("name = \"ground\"", "name = \"\""),
        ("seed = 7", "seed = -7"),
        ("seed = 7", "sampler = \"sobl\""),
        ("format = 1", ""),
    ] {
        let text = SCENE.replacen(old, new, 1);
        assert_ne!(text, SCENE);
        assert!(check_text(&text).is_err(), "{new} fits");
    }
}
