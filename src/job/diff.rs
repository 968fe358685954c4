//! Describes the differences between two renders, key by key.

use serde_json::Value;

use crate::scene::SceneDescription;

use super::metadata::Metadata;

impl Metadata {
    /// Describes every difference that affects the value of a sample, this render's value first,
    /// then the other's.
    pub fn describe_difference(&self, other: &Self) -> String {
        let mut differences = Vec::new();
        if self.version != other.version {
            let (own, other_value) = (&self.version, &other.version);
            differences.push(format!("the program's version is {own}, not {other_value}"));
        }
        if self.intersector != other.intersector {
            let (own, other_value) = (self.intersector.name(), other.intersector.name());
            differences.push(format!("the intersector is {own}, not {other_value}"));
        }
        if self.job_identity != other.job_identity {
            let keys = |metadata: &Self| {
                let mut settings = metadata.settings;
                settings.image.crop = None;
                // Ignore the sample count: the bare key would not explain why it matters.
                super::metadata::set_sample_count(&mut settings, 1);
                settings.to_keys()
            };
            differences.extend(differing_keys(Some(keys(self)), Some(keys(other))));
        }
        if self.scene_identity != other.scene_identity {
            let before = differences.len();
            let keys = |metadata: &Self| metadata.scene.as_ref().map(SceneDescription::to_keys);
            differences.extend(differing_keys(keys(self), keys(other)));
            let hashes = |metadata: &Self| -> Vec<_> {
                metadata.files.iter().map(|file| file.hash).collect()
            };
            if hashes(self) != hashes(other) {
                differences.push("the data of a table or an image differs".to_owned());
            } else if differences.len() == before {
                differences.push("the scene differs".to_owned());
            }
        }
        if differences.is_empty() {
            // The only other hashed input is the number of samples per pixel.
            differences.push(
                "the number of samples per pixel differs, and it changes each sample, as with \
                 `sampler = \"stratified\"`"
                    .to_owned(),
            );
        }
        differences.join("; ")
    }

    /// Differences in version, commit and intersector between two pictures. Empty if they must
    /// agree.
    pub fn program_differences(&self, other: &Self) -> Vec<String> {
        let program = |metadata: &Self| {
            let Self { version, commit, intersector, .. } = metadata;
            [version.clone(), commit.clone(), intersector.name().to_owned()]
        };
        let names = ["version", "commit", "intersector"];
        let pairs = names.into_iter().zip(program(self).into_iter().zip(program(other)));
        let differing = pairs.filter(|(_, (a, b))| a != b);
        differing.map(|(name, (a, b))| format!("{name}: {a} then, {b} now")).collect()
    }
}

/// Maximum number of keys to list.
const MAX_KEYS: usize = 5;

/// The keys in which two JSON trees differ, as in "`render.seed` is 1, not 2".
fn differing_keys(own: Option<Value>, other_value: Option<Value>) -> Vec<String> {
    let mut differences = Vec::new();
    if let (Some(own), Some(other_value)) = (own, other_value) {
        diff_values("", &own, &other_value, &mut differences);
    }
    if differences.len() > MAX_KEYS {
        let more = differences.split_off(MAX_KEYS).len();
        differences.push(format!("and {more} more keys differ"));
    }
    differences
}

fn diff_values(path: &str, own: &Value, other_value: &Value, differences: &mut Vec<String>) {
    let inner = |key_name: &str| {
        if path.is_empty() { key_name.to_owned() } else { format!("{path}.{key_name}") }
    };
    match (own, other_value) {
        (Value::Object(a), Value::Object(b)) => {
            let keys: std::collections::BTreeSet<&String> = a.keys().chain(b.keys()).collect();
            for key in keys {
                let keys = |map: &serde_json::Map<String, Value>| {
                    map.get(key).cloned().unwrap_or(Value::Null)
                };
                diff_values(&inner(key), &keys(a), &keys(b), differences);
            }
        }
        (Value::Array(a), Value::Array(b))
            if a.len() == b.len() && a.iter().any(Value::is_object) =>
        {
            for (index, (a, b)) in a.iter().zip(b).enumerate() {
                diff_values(&inner(&index.to_string()), a, b, differences);
            }
        }
        (a, b) if a != b => {
            differences.push(format!("`{path}` is {}, not {}", abbreviate(a), abbreviate(b)))
        }
        _ => {}
    }
}

/// A value as text, or a summary if it is long.
fn abbreviate(value: &Value) -> String {
    match value {
        Value::Null => "absent".to_owned(),
        Value::Array(list) if list.len() > 4 => format!("a list of {} values", list.len()),
        other => {
            let text = format_json(other);
            if text.len() <= 80 { text } else { "a longer text".to_owned() }
        }
    }
}

/// Formats a value as JSON, with f32 numbers in their shortest form.
pub fn format_json(value: &Value) -> String {
    let narrow = |number: f64| (f64::from(number as f32) == number).then_some(number as f32);
    match value {
        Value::Number(number) if number.is_f64() => match number.as_f64().and_then(narrow) {
            Some(number) => format!("{number:?}"),
            None => number.to_string(),
        },
        Value::Array(list) => {
            format!("[{}]", list.iter().map(format_json).collect::<Vec<_>>().join(", "))
        }
        other => other.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{SceneBuilder, Settings};

    #[test]
    fn the_keys_that_differ_are_named() {
        let mut other = Settings::default();
        other.render.seed = 7;
        other.image.width = 320;
        let differences =
            differing_keys(Some(Settings::default().to_keys()), Some(other.to_keys()));
        assert_eq!(differences, ["`image.width` is 640, not 320", "`render.seed` is 0, not 7"]);
        assert!(differing_keys(Some(other.to_keys()), Some(other.to_keys())).is_empty());
        let scene = |ior: f64| {
            let mut scene = SceneBuilder::new();
            scene.field_of_view(10.0 * ior).glass(ior);
            Some(scene.description.to_keys())
        };
        let differences = differing_keys(scene(1.5), scene(2.0));
        let expected = [
            "`camera.vertical_fov_degrees` is 15.0, not 20.0",
            "`materials.material-0.ior` is 1.5, not 2.0",
        ];
        assert_eq!(differences, expected);
    }
}
