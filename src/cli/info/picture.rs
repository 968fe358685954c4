//! What a picture's file says of how it was made.

use std::path::Path;

use serde_json::{Map, Value};

use crate::cli::print;
use crate::cli::render::RESUME;
use crate::error::{Error, Result};
use crate::output::{self, PartFile, Record};
use crate::provenance;

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
    let mut records = match is_part(path) {
        true => {
            let part = PartFile::open(path)?;
            let records = part.head().records.clone();
            // What is damaged behind the records is not kept quiet.
            part.film()?;
            records
        }
        false => output::records(path)?,
    };
    if records.is_empty() {
        let message = format!("`{}` does not say how it was made", path.display());
        let help = "older versions do not say it, and other programs may drop it on saving";
        return Err(Error::input(message).with_help(help));
    }
    provenance::sort(&mut records);
    if as_json { print::json(&in_json(&records)) } else { print::result(&in_words(&records)) }
}

/// Whether a file is a part or a checkpoint, or is called so.
fn is_part(path: &Path) -> bool {
    output::is_part_file(path) || path.extension().is_some_and(|extension| extension == "part")
}

/// One row each; a text of several lines comes last, under its name.
fn in_words(records: &[Record]) -> String {
    let (texts, rows): (Vec<&Record>, Vec<_>) =
        records.iter().partition(|record| record.text.contains('\n'));
    let mut words = String::new();
    for Record { name, text } in rows {
        let text = match name.as_str() {
            RESUME => way_on(text).unwrap_or_else(|| text.clone()),
            _ => text.clone(),
        };
        words += &format!("{name:<11} {text}\n");
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

/// What `photosphere resume` does with a part.
fn way_on(text: &str) -> Option<String> {
    let value: Value = serde_json::from_str(text).ok()?;
    let files: Vec<&str> =
        value.get("files")?.as_array()?.iter().filter_map(Value::as_str).collect();
    let scene = value.get("scene")?.as_str()?;
    let mut words = format!("renders {scene} to {}", files.join(" and "));
    if let Some(samples) = value.get("extended_to").and_then(Value::as_u64) {
        words += &format!(", up to {samples} samples per pixel");
    }
    if let Some(preview) = value.get("preview").and_then(Value::as_str) {
        words += &format!(", previewed in {preview}");
    }
    Some(words)
}

/// Texts as they are; what is JSON in the file is JSON here.
fn in_json(records: &[Record]) -> Value {
    let value = |Record { name, text }: &Record| match name.as_str() {
        "options" | "files" | RESUME => {
            serde_json::from_str(text).unwrap_or_else(|_| text.clone().into())
        }
        _ => Value::from(text.clone()),
    };
    let entries = records.iter().map(|record| (record.name.clone(), value(record)));
    Value::Object(Map::from_iter(entries))
}
