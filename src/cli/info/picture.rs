//! What a picture's file says of how it was made.

use std::path::Path;

use serde_json::{Map, Value, json};

use crate::cli::print;
use crate::error::Result;
use crate::job::difference::shown;
use crate::job::metadata::value_of;
use crate::job::{Checkpoint, FilePath, Header, Metadata, Status, is_checkpoint};
use crate::output::{self, Record};

/// The name of what `photosphere resume` does with a part.
const RESUME: &str = "resume";

/// Longer lists are not written out for people.
const LONGEST_LIST: usize = 100;

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
    let (metadata, of_part) = match is_part(path) {
        true => {
            let part = Checkpoint::open(path)?;
            let header = part.header().clone();
            // What is damaged behind the header is not kept quiet.
            part.film()?;
            (header.metadata.clone(), records_of(&header))
        }
        false => (Metadata::of_records(path, &output::records(path)?)?, Vec::new()),
    };
    let mut records = metadata.to_records()?;
    records.extend(of_part);
    if as_json {
        return print::json(&in_json(&records));
    }
    let records: Vec<Record> =
        records.iter().flat_map(|record| words_of(record, &metadata)).collect();
    print::result(&in_words(&records))
}

/// Whether a file is a part or a checkpoint, or is called so.
fn is_part(path: &Path) -> bool {
    is_checkpoint(path) || path.extension().is_some_and(|extension| extension == "part")
}

/// What a part says of itself, beside its picture.
fn records_of(header: &Header) -> Vec<Record> {
    let mut records = Vec::new();
    let is_ended = matches!(header.status, Status::Ended { .. });
    records.push(Record::new("ended", is_ended.to_string()));
    if let Status::Ended { missed } = &header.status {
        let words: Vec<String> = missed.iter().map(ToString::to_string).collect();
        let said = (!words.is_empty()).then(|| Record::new("missed", words.join("; ")));
        records.extend(said);
    }
    if let Some(delivery) = &header.delivery {
        let files: Vec<String> = delivery.files.iter().map(name_of).collect();
        let way_on = json!({
            "scene": header.source.as_ref().map(|source| source.name.clone()),
            "files": files,
            "preview": delivery.preview.as_ref().map(name_of),
            "samples_per_pixel": header.samples.end,
        });
        records.push(Record::new(RESUME, way_on.to_string()));
    }
    records
}

fn name_of(FilePath(path): &FilePath) -> String {
    path.display().to_string()
}

/// One row each; a text of several lines comes last, under its name.
fn in_words(records: &[Record]) -> String {
    let (texts, rows): (Vec<&Record>, Vec<_>) =
        records.iter().partition(|record| record.text.contains('\n'));
    let longest = rows.iter().map(|record| record.name.len()).max().unwrap_or(0);
    let mut words = String::new();
    for Record { name, text } in rows {
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

/// A record for people, who need no JSON; the settings begin with what is asked for most.
fn words_of(record: &Record, metadata: &Metadata) -> Vec<Record> {
    let value = || value_of(record);
    let text = match record.name.as_str() {
        "settings" => return settings_in_words(metadata),
        "samples" => Some(metadata.samples_as_text()),
        "counts" => Some(metadata.counts.to_string()),
        "parts" => Some(format!("{}\n", metadata.parts)),
        "biased" => Some(metadata.biased.join(", ")),
        "look" => metadata.look.map(|look| look.to_string()),
        "layers" => listed(&value(), ","),
        "noise" => metadata.run.as_ref().and_then(|run| run.noise).map(|noise| noise.to_string()),
        // The user's own words say the same.
        "scene" if metadata.run.as_ref().is_some_and(|run| run.scene_text.is_some()) => {
            return Vec::new();
        }
        "scene" => metadata.scene.as_ref().map(|scene| line_by_line(&scene.to_keys())),
        "files" => Some(line_by_line(&value())),
        RESUME => way_on(&value()),
        _ => None,
    };
    vec![Record::new(&record.name, text.unwrap_or_else(|| record.text.clone()))]
}

fn settings_in_words(metadata: &Metadata) -> Vec<Record> {
    let image = &metadata.settings.image;
    let mut records = vec![Record::new("size", format!("{}x{}", image.width, image.height))];
    records.extend(image.crop.map(|crop| Record::new("crop", crop.to_string())));
    records.push(Record::new("settings", line_by_line(&metadata.settings.to_keys())));
    records
}

/// The texts of a list.
fn listed(value: &Value, between: &str) -> Option<String> {
    let texts: Option<Vec<&str>> = value.as_array()?.iter().map(Value::as_str).collect();
    Some(texts?.join(between))
}

/// A line for each value: `image.width = 16`.
fn line_by_line(value: &Value) -> String {
    let mut lines = String::new();
    add_lines("", value, &mut lines);
    lines
}

fn add_lines(path: &str, value: &Value, lines: &mut String) {
    let inner = |step: &str| match path {
        "" => step.to_owned(),
        _ => format!("{path}.{step}"),
    };
    match value {
        Value::Null => {}
        Value::Object(fields) => {
            fields.iter().for_each(|(name, value)| add_lines(&inner(name), value, lines));
        }
        Value::Array(list) if list.len() > LONGEST_LIST => {
            *lines += &format!("{path} = a list of {}\n", list.len());
        }
        Value::Array(list) if list.iter().any(Value::is_object) => {
            let numbered = list.iter().enumerate();
            numbered.for_each(|(at, value)| add_lines(&inner(&at.to_string()), value, lines));
        }
        Value::Array(list) if list.is_empty() => {}
        one => *lines += &format!("{path} = {}\n", shown(one)),
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
