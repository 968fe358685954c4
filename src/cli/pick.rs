//! `photosphere pick`: prints the particle that a pixel of a picture shows.

use std::path::{Path, PathBuf};

use serde_json::{Map, Value, json};

use crate::error::Result;
use crate::job::reproduce::read_metadata;
use crate::job::{Pick, pick};
use crate::particles::{ColumnData, Particles, Wanted, read};
use crate::scene::ParticleTable;
use crate::scene::data::SphereData;

use super::args::PickArgs;
use super::exit::Exit;
use super::print;

/// A particle of a file.
struct FileRow {
    file: PathBuf,
    row: u32,
    particles: Particles,
}

/// Runs the command.
///
/// # Errors
/// If the picture does not record its scene, or the scene has changed.
pub(super) fn run(args: &PickArgs) -> Result<Exit> {
    let recorded = read_metadata(&args.picture)?;
    let beside = args.picture.parent().unwrap_or(Path::new(""));
    let folder = args.folder.as_deref().unwrap_or(beside);
    let Some(found) = pick(&recorded, folder, [args.x, args.y])? else {
        match args.json {
            true => print::json(&Value::Null)?,
            false => print::result("the background\n")?,
        }
        return Ok(Exit::Done);
    };
    let particle = match found.table.as_ref().map(|(table, row)| (&table.data, *row)) {
        Some((SphereData::Particles(particles), row)) => file_row(particles, folder, row)?,
        _ => None,
    };
    match args.json {
        true => print::json(&as_json(&found, particle.as_ref()))?,
        false => print::result(&as_text(&found, particle.as_ref()))?,
    }
    Ok(Exit::Done)
}

/// Reads the row of the file that a row of a table shows.
fn file_row(table: &ParticleTable, folder: &Path, row: u32) -> Result<Option<FileRow>> {
    let mut table = table.clone();
    table.path = folder.join(table.path);
    table.topology = table.topology.map(|file| folder.join(file));
    let Some(row) = table.file_rows()?.row_in_file(row) else { return Ok(None) };
    let particles = read(&table.path, &table.request(Wanted::All))?;
    Ok(Some(FileRow { file: table.path, row, particles }))
}

fn as_text(found: &Pick, particle: Option<&FileRow>) -> String {
    let [x, y, z] = found.center.to_array();
    let mut text = print::field("sphere", &found.name);
    text += &print::field("centre", format!("{x} {y} {z}"));
    text += &print::field("radius", found.radius);
    text += &print::field("distance", found.distance);
    let Some(FileRow { file, row, particles }) = particle else { return text };
    text += &print::field("file", file.display());
    text += &print::field("row", row);
    if let Some(first) = particles.first_line {
        text += &print::field("line", first + u64::from(*row));
    }
    for column in &particles.columns {
        text += &print::field(&column.name, column.data.show(*row as usize));
    }
    text
}

fn as_json(found: &Pick, particle: Option<&FileRow>) -> Value {
    let mut value = json!({
        "name": found.name,
        "center": found.center.to_array(),
        "radius": found.radius,
        "distance": found.distance,
    });
    if let Some(FileRow { file, row, particles }) = particle {
        let columns = particles.columns.iter().map(|column| {
            let value = match &column.data {
                ColumnData::Text(_) => json!(column.data.show(*row as usize)),
                ColumnData::U8(values) => json!(values[*row as usize]),
                ColumnData::I32(values) => json!(values[*row as usize]),
                ColumnData::I64(values) => json!(values[*row as usize]),
                data => json!(data.number(*row as usize)),
            };
            (column.name.clone(), value)
        });
        value["file"] = json!(file.display().to_string());
        value["row"] = json!(row);
        value["line"] = json!(particles.first_line.map(|first| first + u64::from(*row)));
        value["columns"] = Value::Object(columns.collect::<Map<String, Value>>());
    }
    value
}
