//! `photosphere info` of a particle file.

use std::path::Path;

use serde_json::{Value, json};

use crate::accel::BackendChoice;
use crate::error::Result;
use crate::film::Aov;
use crate::job::{Job, MemoryPlan};
use crate::particles::{Cell, ColumnInfo, ColumnKind, ReadRequest, Role, Survey, read, survey};
use crate::scene::SceneSize;
use crate::scene::description::ColorStorage;

use super::file_columns::FileColumns;
use super::print;

/// Prints what is in a particle file, without reading what its format lets us skip; or, if
/// `reads_columns` is true, after all rows of the first frame have been read.
///
/// # Errors
/// If the file cannot be read.
pub(super) fn run(
    path: &Path,
    request: &ReadRequest,
    reads_columns: bool,
    as_json: bool,
) -> Result<()> {
    let mut survey = survey(path, request)?;
    let columns = match reads_columns {
        true => Some(FileColumns::read(&mut survey, &read(path, request)?)),
        false => None,
    };
    let memory = survey.count.map(|count| planned_memory(count, has_f32_spheres(&survey)));
    if as_json {
        let mut value = serde_json::to_value(&survey).unwrap_or(Value::Null);
        value["format"] = json!(survey.format.name());
        value["memory_bytes"] = json!(memory);
        if let Some(columns) = columns {
            columns.add_to(&mut value);
        }
        return print::json(&value);
    }
    print::result(&text(&survey, memory, columns.as_ref()))
}

/// Returns true if positions and radii are f32 with the usual options. An automatic radius is f64,
/// and so are all spheres then.
fn has_f32_spheres(survey: &Survey) -> bool {
    let radius_of = |column: &ColumnInfo| Role::of(&column.name);
    let f32_radii = [Role::Radius, Role::Element, Role::AtomicNumber];
    let has_radii = survey.columns.iter().filter_map(radius_of).any(|r| f32_radii.contains(&r));
    survey.position_bytes == 12 && has_radii
}

/// Memory at the peak of a render of so many particles.
fn planned_memory(count: u64, is_f32: bool) -> u64 {
    let size = SceneSize {
        spheres: count,
        f64_spheres: if is_f32 { 0 } else { count },
        colors: count,
        color_bytes: count * ColorStorage::Packed.bytes_per_color() as u64,
        ..SceneSize::default()
    };
    let threads = rayon::current_num_threads();
    let job = Job { layers: Aov::DEFAULT.to_vec(), threads, ..Job::default() };
    let backend = BackendChoice::Auto.select_for_count(count as usize).backend;
    MemoryPlan::with_backends(&size, &job, &[backend]).peak()
}

fn text(survey: &Survey, memory: Option<u64>, columns: Option<&FileColumns>) -> String {
    let unknown = || "unknown until it is read".to_owned();
    let mut text = print::field("file", survey.path.display());
    let compression = survey.compression.map_or(String::new(), |kind| format!(", {kind}"));
    text += &print::field("format", format!("{}{compression}", survey.format.name()));
    text += &print::field("frames", survey.frames.map_or_else(unknown, |n| n.to_string()));
    text += &print::field("particles", survey.count.map_or_else(unknown, |n| n.to_string()));
    let optional = [
        ("title", survey.title.clone()),
        ("time", survey.time.map(|time| time.to_string())),
        ("unit", survey.unit.map(|unit| unit.symbol().to_owned())),
        ("cell", survey.cell.as_ref().map(cell)),
        ("memory", memory.map(|bytes| format!("{} at the peak of a render", print::bytes(bytes)))),
    ];
    for (name, value) in optional {
        if let Some(value) = value {
            text += &print::field(name, value);
        }
    }
    if let Some(columns) = columns {
        let [low, high] = columns.positions.map(|v| format!("({} {} {})", v.x, v.y, v.z));
        text += &print::field("positions", format!("from {low} to {high}"));
    }
    for (index, info) in survey.columns.iter().enumerate() {
        let more = columns.map_or(String::new(), |columns| columns.more(index));
        text += &print::field(if index == 0 { "columns" } else { "" }, column(info) + &more);
    }
    if columns.is_some() {
        text += &print::field("", "(of all rows of the first frame)");
    }
    text
}

fn column(ColumnInfo { name, kind, range }: &ColumnInfo) -> String {
    let kind = match kind {
        ColumnKind::Integer => "integers",
        ColumnKind::Float => "numbers",
        ColumnKind::Text => "words",
    };
    match range {
        Some([low, high]) => format!("{name:<16}{kind} from {low} to {high}"),
        None => format!("{name:<16}{kind}"),
    }
}

fn cell(Cell { origin, vectors, periodic }: &Cell) -> String {
    let [a, b, c] = vectors.map(|v| format!("({} {} {})", v.x, v.y, v.z));
    let [x, y, z] = periodic.map(|is| if is { "p" } else { "-" });
    format!("{a} {b} {c} at ({} {} {}), periodic {x}{y}{z}", origin.x, origin.y, origin.z)
}
