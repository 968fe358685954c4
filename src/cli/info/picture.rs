//! What a picture's file says of how it was made.

use std::path::Path;

use serde_json::{Map, Value, json};

use crate::cli::print;
use crate::error::Result;
use crate::job::metadata::value_of;
use crate::job::{Checkpoint, FilePath, Header, Metadata, Status, is_checkpoint};
use crate::output::{self, Record};

/// The name of what `photosphere resume` does with a part.
const RESUME: &str = "resume";

/// Names of records of [`Metadata`] that are shown in another way.
const SETTINGS: &str = "settings";
const SCENE: &str = "scene";
const SCENE_TEXT: &str = "scene-text";

/// Whether the name is that of a picture, a part or a checkpoint, or the file is one.
pub(super) fn is_picture(path: &Path) -> bool {
    let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
    ["png", "exr", "hdr", "pfm"].iter().any(|picture| extension == *picture) || is_part(path)
}

/// Prints all that the file says.
///
/// # Errors
/// When it cannot be read, or says nothing, or a part's sums are damaged.
pub(super) fn show(path: &Path, as_json: bool) -> Result<()> {
    let records = match is_part(path) {
        true => {
            let part = Checkpoint::open(path)?;
            let header = part.header().clone();
            // What is damaged behind the header is not kept quiet.
            part.film()?;
            records_of(&header)?
        }
        false => Metadata::of_records(path, &output::records(path)?)?.to_records()?,
    };
    if as_json { print::json(&in_json(&records)) } else { print::result(&in_words(&records)) }
}

/// Whether a file is a part or a checkpoint, or is called so.
fn is_part(path: &Path) -> bool {
    is_checkpoint(path) || path.extension().is_some_and(|extension| extension == "part")
}

/// What a part says of its picture and of itself.
fn records_of(header: &Header) -> Result<Vec<Record>> {
    let mut records = header.metadata.to_records()?;
    let is_ended = matches!(header.status, Status::Ended { .. });
    records.push(Record::new("ended", is_ended.to_string()));
    if let Status::Ended { missed } = &header.status {
        let words: Vec<String> = missed.iter().map(ToString::to_string).collect();
        let said = (!words.is_empty()).then(|| Record::new("missed", words.join("; ")));
        records.extend(said);
    }
    if let Some(delivery) = &header.delivery {
        let files: Vec<String> = delivery.files.iter().map(shown).collect();
        let way_on = json!({
            "scene": header.source.as_ref().map(|source| source.name.clone()),
            "files": files,
            "preview": delivery.preview.as_ref().map(shown),
            "samples_per_pixel": header.samples.end,
        });
        records.push(Record::new(RESUME, way_on.to_string()));
    }
    Ok(records)
}

fn shown(FilePath(path): &FilePath) -> String {
    path.display().to_string()
}

/// One row each; a text of several lines comes last, under its name.
fn in_words(records: &[Record]) -> String {
    // The scene in the user's words says what its values say.
    let has_text = records.iter().any(|record| record.name == SCENE_TEXT);
    let shown = records.iter().filter(|record| !(has_text && record.name == SCENE));
    let spread: Vec<Record> = shown.flat_map(spread).collect();
    let (texts, rows): (Vec<&Record>, Vec<_>) =
        spread.iter().partition(|record| record.text.contains('\n'));
    let longest = rows.iter().map(|record| record.name.len()).max().unwrap_or(0);
    let mut words = String::new();
    for Record { name, text } in rows {
        let text = in_short(name, text).unwrap_or_else(|| text.clone());
        words += &format!("{name:<longest$}  {text}\n");
    }
    for Record { name, text } in texts {
        words += &format!("{name}:\n");
        for line in text.lines() {
            words += format!("    {line}").trim_end();
            words.push('\n');
        }
    }
    words
}

/// The settings key by key; the scene's values on lines of their own; all else as it is.
fn spread(record: &Record) -> Vec<Record> {
    let value = value_of(record);
    match record.name.as_str() {
        SETTINGS => {
            let mut rows = Vec::new();
            each_leaf("", &value, &mut |key, text| rows.push(Record::new(key, text)));
            rows
        }
        SCENE => vec![Record::new(SCENE, format!("{value:#}"))],
        _ => vec![record.clone()],
    }
}

/// Calls `see` with the dotted name and the text of everything that is not null.
fn each_leaf(name: &str, value: &Value, see: &mut impl FnMut(&str, String)) {
    match value {
        Value::Object(fields) => {
            for (key, value) in fields {
                let name = if name.is_empty() { key.clone() } else { format!("{name}.{key}") };
                each_leaf(&name, value, see);
            }
        }
        Value::Null => {}
        Value::String(text) => see(name, text.clone()),
        other => see(name, other.to_string()),
    }
}

/// A record that is JSON in the file, for people.
fn in_short(name: &str, text: &str) -> Option<String> {
    let value: Value = serde_json::from_str(text).ok()?;
    match name {
        RESUME => way_on(&value),
        "samples" => serde_json::from_value(value).ok().map(|s: crate::job::Samples| s.to_string()),
        _ => None,
    }
}

/// What `photosphere resume` does with a part.
fn way_on(value: &Value) -> Option<String> {
    let files: Vec<&str> =
        value.get("files")?.as_array()?.iter().filter_map(Value::as_str).collect();
    let scene = value.get("scene")?.as_str()?;
    let samples = value.get("samples_per_pixel")?.as_u64()?;
    let mut words =
        format!("renders {scene} to {}, up to {samples} samples per pixel", files.join(" and "));
    if let Some(preview) = value.get("preview").and_then(Value::as_str) {
        words += &format!(", previewed in {preview}");
    }
    Some(words)
}

/// Texts as they are; what is JSON in the file is JSON here.
fn in_json(records: &[Record]) -> Value {
    let entries = records.iter().map(|record| (record.name.clone(), value_of(record)));
    Value::Object(Map::from_iter(entries))
}
