//! Describes how an image, a part or a checkpoint was made, from the metadata in its file.

use std::path::Path;

use serde_json::{Map, Value, json};

use crate::error::Result;
use crate::image_io::{self, MetadataEntry};
use crate::job::metadata::record_value;
use crate::job::{
    Checkpoint, CheckpointHeader, FilePath, Metadata, NoiseTarget, RenderStatus, is_checkpoint,
};

use super::record_text::{self, join_list, line_by_line};

/// Name of the record that says how to resume a part.
const RESUME: &str = "resume";

/// The name of the record of a noise target that was missed.
const MISSED: &str = "missed";

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

    /// How the picture was made.
    pub fn metadata(&self) -> &Metadata {
        &self.metadata
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
            records.retain(|record| record.name != MISSED);
            let record =
                (!missed.is_empty()).then(|| MetadataEntry::new(MISSED, missed.join("; ")));
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
        let run = metadata.run.as_ref();
        let text = match record.name.as_str() {
            "settings" => return settings_records(metadata),
            "intersector" => Some(metadata.intersector.name().to_owned()),
            "samples" => Some(metadata.samples_to_string()),
            "counts" => Some(record_text::counts(&metadata.counts)),
            "parts" => Some(record_text::parts(&metadata.parts)),
            "biased" => Some(metadata.biased.join(", ")),
            "look" => metadata.look.map(|look| look.to_string()),
            "bits" => metadata.bits.map(|bits| bits.name().to_owned()),
            "converted" => Some(metadata.converted.join("; ")),
            "overlay" => metadata.overlay.as_ref().map(record_text::overlay),
            "layers" | "column-layers" => join_list(&record_value(record)),
            "noise" => run.and_then(|run| run.noise).map(|noise| record_text::noise(&noise)),
            "error" => run.and_then(|run| {
                // Without a target, only its confidence matters.
                let target = run.noise.unwrap_or(NoiseTarget::new(0.01));
                Some(record_text::error(run.error?, &target))
            }),
            MISSED if self.header.is_none() => run.and_then(|run| Some(run.missed?.to_string())),
            "rays" => run.map(|run| record_text::rays(run.rays)),
            "seconds" => run.map(|run| record_text::seconds(run.seconds)),
            // The scene text contains it.
            "scene" if run.is_some_and(|run| run.scene_text.is_some()) => return Vec::new(),
            "scene" => metadata.scene.as_ref().map(|scene| line_by_line(&scene.to_keys())),
            "files" => Some(line_by_line(&record_value(record))),
            RESUME => self.header.as_ref().and_then(describe_resume),
            _ => None,
        };
        let text = text.unwrap_or_else(|| match record_value(record) {
            value @ (Value::Object(_) | Value::Array(_)) => line_by_line(&value),
            _ => record.text.clone(),
        });
        vec![MetadataEntry::new(&record.name, record_text::shortened(&text))]
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
