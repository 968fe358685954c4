//! Describes how an image, a part or a checkpoint was made, from the metadata in its file.

use std::path::Path;

use serde_json::{Map, Value, json};

use crate::error::Result;
use crate::image_io::{self, MetadataEntry};
use crate::job::diff::format_json;
use crate::job::metadata::record_value;
use crate::job::{Checkpoint, CheckpointHeader, FilePath, Metadata, RenderStatus, is_checkpoint};

/// Name of the record that says how to resume a part.
const RESUME: &str = "resume";

/// Longer lists are not written out in text.
const MAX_LIST_LENGTH: usize = 100;

/// Records of how a file was made.
#[derive(Clone, Debug)]
pub struct FileRecords {
    metadata: Metadata,
    /// Header of a part or a checkpoint.
    header: Option<CheckpointHeader>,
}

/// Returns true if the file name is that of an image, a part or a checkpoint.
pub fn is_picture(path: &Path) -> bool {
    image_io::has_picture_extension(path) || is_part(path)
}

fn is_part(path: &Path) -> bool {
    is_checkpoint(path) || path.extension().is_some_and(|extension| extension == "part")
}

impl FileRecords {
    /// Reads the records of a file.
    ///
    /// # Errors
    /// If the file cannot be read or has no records, or if a part's sums are damaged.
    pub fn read(path: &Path) -> Result<Self> {
        if !is_part(path) {
            let metadata = Metadata::from_records(path, &image_io::read_metadata(path)?)?;
            return Ok(Self { metadata, header: None });
        }
        let part = Checkpoint::open(path)?;
        let header = part.header().clone();
        // Detects damage after the header.
        part.into_film()?;
        Ok(Self { metadata: header.metadata.clone(), header: Some(header) })
    }

    /// Returns all records as JSON: texts as strings, JSON records as values.
    ///
    /// # Errors
    /// If the records cannot be written.
    pub fn json(&self) -> Result<Value> {
        let entries = |record: &MetadataEntry| (record.name.clone(), record_value(record));
        Ok(Value::Object(Map::from_iter(self.records()?.iter().map(entries))))
    }

    /// Formats all records as text: one row each, with multi-line texts last, under their names.
    ///
    /// # Errors
    /// If the records cannot be written.
    pub fn to_text(&self) -> Result<String> {
        let records = self.records()?;
        let (texts, rows): (Vec<MetadataEntry>, Vec<MetadataEntry>) = records
            .iter()
            .flat_map(|record| self.format_record(record))
            .partition(|record| record.text.contains('\n'));
        let name_width = rows.iter().map(|record| record.name.len()).max().unwrap_or(0);
        let mut text = String::new();
        for row in rows {
            text += &format!("{:<name_width$}  {}\n", row.name, row.text);
        }
        for MetadataEntry { name, text: body } in texts {
            text += &format!("{name}:\n");
            body.lines()
                .for_each(|line| text += &format!("{}\n", format!("    {line}").trim_end()));
        }
        Ok(text)
    }

    fn records(&self) -> Result<Vec<MetadataEntry>> {
        let mut records = self.metadata.to_records()?;
        let Some(header) = &self.header else { return Ok(records) };
        let is_ended = matches!(header.status, RenderStatus::Ended { .. });
        records.push(MetadataEntry::new("ended", is_ended.to_string()));
        if let RenderStatus::Ended { missed_targets } = &header.status {
            let missed: Vec<String> = missed_targets.iter().map(ToString::to_string).collect();
            let record =
                (!missed.is_empty()).then(|| MetadataEntry::new("missed", missed.join("; ")));
            records.extend(record);
        }
        if let Some(output) = &header.output {
            let resume = json!({
                "scene": header.source.as_ref().map(|source| &source.name),
                "files": output.files.iter().map(name_of).collect::<Vec<_>>(),
                "preview": output.preview.as_ref().map(name_of),
                "samples_per_pixel": header.samples.end,
            });
            records.push(MetadataEntry::new(RESUME, resume.to_string()));
        }
        Ok(records)
    }

    /// Formats a record as text instead of JSON. Settings start with the ones asked for most.
    fn format_record(&self, record: &MetadataEntry) -> Vec<MetadataEntry> {
        let metadata = &self.metadata;
        let text = match record.name.as_str() {
            "settings" => return settings_records(metadata),
            "intersector" => Some(metadata.intersector.name().to_owned()),
            "samples" => Some(metadata.samples_to_string()),
            "counts" => Some(metadata.counts.to_string()),
            "parts" => Some(format!("{}\n", metadata.parts)),
            "biased" => Some(metadata.biased.join(", ")),
            "look" => metadata.look.map(|look| look.to_string()),
            "layers" => join_list(&record_value(record)),
            "noise" => {
                metadata.run.as_ref().and_then(|run| run.noise).map(|noise| noise.to_string())
            }
            // The scene text contains it.
            "scene" if metadata.run.as_ref().is_some_and(|run| run.scene_text.is_some()) => {
                return Vec::new();
            }
            "scene" => metadata.scene.as_ref().map(|scene| line_by_line(&scene.to_keys())),
            "files" => Some(line_by_line(&record_value(record))),
            RESUME => self.header.as_ref().and_then(describe_resume),
            _ => None,
        };
        vec![MetadataEntry::new(&record.name, text.unwrap_or_else(|| record.text.clone()))]
    }
}

fn name_of(FilePath(path): &FilePath) -> String {
    path.display().to_string()
}

/// Describes how to resume a part, and where its image goes.
fn describe_resume(header: &CheckpointHeader) -> Option<String> {
    let (source, output) = (header.source.as_ref()?, header.output.as_ref()?);
    let files: Vec<String> = output.files.iter().map(name_of).collect();
    let (scene, files, samples) = (&source.name, files.join(" and "), header.samples.end);
    let preview = output.preview.as_ref().map(name_of);
    let preview = preview.map_or(String::new(), |preview| format!(", preview in {preview}"));
    Some(format!("renders {scene} to {files}, up to {samples} samples per pixel{preview}"))
}

fn settings_records(metadata: &Metadata) -> Vec<MetadataEntry> {
    let image = &metadata.settings.image;
    let mut records = vec![MetadataEntry::new("size", format!("{}x{}", image.width, image.height))];
    records.extend(image.crop.map(|crop| MetadataEntry::new("crop", crop.to_string())));
    records.push(MetadataEntry::new("settings", line_by_line(&metadata.settings.to_keys())));
    records
}

/// The texts of a list.
fn join_list(value: &Value) -> Option<String> {
    let texts: Option<Vec<&str>> = value.as_array()?.iter().map(Value::as_str).collect();
    Some(texts?.join(","))
}

/// One line per value: `image.width = 16`.
fn line_by_line(value: &Value) -> String {
    let mut lines = String::new();
    add_lines("", value, &mut lines);
    lines
}

fn add_lines(path: &str, value: &Value, lines: &mut String) {
    let inner = |key: &str| match path {
        "" => key.to_owned(),
        _ => format!("{path}.{key}"),
    };
    match value {
        Value::Null => {}
        Value::Object(fields) => {
            fields.iter().for_each(|(name, value)| add_lines(&inner(name), value, lines));
        }
        Value::Array(list) if list.len() > MAX_LIST_LENGTH => {
            *lines += &format!("{path} = a list of {}\n", list.len());
        }
        Value::Array(list) if list.iter().any(Value::is_object) => {
            let numbered = list.iter().enumerate();
            numbered.for_each(|(index, value)| add_lines(&inner(&index.to_string()), value, lines));
        }
        Value::Array(list) if list.is_empty() => {}
        other => *lines += &format!("{path} = {}\n", format_json(other)),
    }
}
