//! Compares what is read with what the library that wrote a file reads back.

use std::path::{Path, PathBuf};

use photosphere::particles::{
    ColumnData, Particles, ReadRequest, Wanted, count_frames, read, read_bytes, survey,
};
use serde_json::Value;

/// The path of a fixture.
pub(crate) fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/particles/fixtures").join(name)
}

/// A request for a frame.
pub(crate) fn frame(frame: i64) -> ReadRequest {
    ReadRequest { frame, ..ReadRequest::default() }
}

/// A request for some columns.
pub(crate) fn only(columns: &[&str]) -> ReadRequest {
    let columns = columns.iter().map(|name| (*name).to_owned()).collect();
    ReadRequest { columns: Wanted::Only(columns), ..ReadRequest::default() }
}

/// Reads bytes in memory.
pub(crate) fn bytes(bytes: impl AsRef<[u8]>) -> photosphere::Result<Particles> {
    read_bytes(Path::new("memory"), bytes.as_ref(), &ReadRequest::default())
}

/// The message about bytes that cannot be read.
pub(crate) fn error(text: impl AsRef<[u8]>) -> String {
    bytes(text).expect_err("a mistake").to_string()
}

/// Compares every frame of `folder`, of which there are `count`, with what is expected.
pub(crate) fn check(folder: &str, count: usize) {
    let text = std::fs::read_to_string(fixture("expected.json"))
        .expect("a fixture as the script makes it");
    let all: Value = serde_json::from_str(&text).expect("a fixture as the script makes it");
    let frames = all["frames"].as_array().expect("a fixture as the script makes it").iter();
    let frames: Vec<&Value> =
        frames.filter(|entry| text_of(&entry["file"]).starts_with(&format!("{folder}/"))).collect();
    assert_eq!(frames.len(), count, "frames of fixtures in {folder}");
    for expected in frames {
        check_frame(expected);
    }
}

fn text_of(value: &Value) -> &str {
    value.as_str().expect("a fixture as the script makes it")
}

fn numbers(value: &Value) -> Vec<f64> {
    value
        .as_array()
        .expect("a fixture as the script makes it")
        .iter()
        .map(|x| x.as_f64().unwrap_or(f64::NAN))
        .collect()
}

fn check_frame(expected: &Value) {
    let name = text_of(&expected["file"]);
    let number = expected["frame"].as_i64().expect("a fixture as the script makes it");
    let path = fixture(name);
    let mut request = frame(number);
    if name.starts_with("xtc/mda") {
        request.topology = Some(fixture("xtc/mda.gro"));
    }
    let found = read(&path, &request).unwrap_or_else(|error| panic!("{name} {number}: {error}"));
    let tolerance = expected["tolerance"].as_f64().unwrap_or(0.0);
    let at = format!("{name} frame {number}");
    let count = expected["count"].as_u64().expect("a fixture as the script makes it") as usize;
    assert_eq!(found.len(), count, "{at}");
    let positions: Vec<f64> =
        (0..count).flat_map(|row| found.positions.get(row).to_array()).collect();
    compare(&positions, &numbers(&expected["positions"]), tolerance, &format!("{at}: positions"));
    for (column, values) in
        expected["columns"].as_object().expect("a fixture as the script makes it")
    {
        compare_column(&found, column, values, tolerance, &at);
    }
    match expected.get("cell") {
        Some(cell) => {
            let tolerance = expected["cell_tolerance"].as_f64().unwrap_or(tolerance);
            let own = found.cell.unwrap_or_else(|| panic!("{at}: a cell"));
            let vectors: Vec<f64> = own.vectors.iter().flat_map(|v| v.to_array()).collect();
            compare(&vectors, &numbers(cell), tolerance, &format!("{at}: cell"));
            let origin = numbers(&expected["origin"]);
            compare(&own.origin.to_array(), &origin, tolerance, &format!("{at}: origin"));
        }
        None => assert_eq!(found.cell, None, "{at}"),
    }
    if let Some(periodic) = expected.get("periodic") {
        let periodic: Vec<bool> = periodic
            .as_array()
            .expect("a fixture as the script makes it")
            .iter()
            .map(|p| p.as_bool().expect("a fixture as the script makes it"))
            .collect();
        assert_eq!(
            found.cell.expect("a fixture as the script makes it").periodic[..],
            periodic[..],
            "{at}"
        );
    }
    if let Some(time) = expected.get("time") {
        assert_eq!(found.time, time.as_f64(), "{at}");
    }
    check_survey(&path, &request, &found, &at);
}

/// A survey tells what is read afterwards.
fn check_survey(path: &Path, request: &ReadRequest, found: &Particles, at: &str) {
    let told = survey(path, request).unwrap_or_else(|error| panic!("{at}: {error}"));
    assert_eq!((&told.path, told.format), (&found.path, found.format), "{at}");
    assert!(told.count.is_none_or(|count| count == found.len() as u64), "{at}");
    let mut names: Vec<&str> = told.columns.iter().map(|column| &*column.name).collect();
    let mut own: Vec<&str> = found.columns.iter().map(|column| &*column.name).collect();
    names.sort_unstable();
    own.sort_unstable();
    assert_eq!(names, own, "{at}");
    let frames = count_frames(path, request).expect("a fixture as the script makes it");
    assert!(frames > request.frame as u64, "{at}: {frames} frames");
    assert!(told.frames.is_none_or(|told| told == frames), "{at}");
    // Only what is wanted, and nothing else, is read.
    let none = ReadRequest { columns: Wanted::Only(vec![]), ..request.clone() };
    let bare = read(path, &none).expect("a fixture as the script makes it");
    assert_eq!(bare.positions, found.positions, "{at}");
    assert!(bare.columns.is_empty(), "{at}");
    for column in found.columns.iter().take(3) {
        let one = Wanted::Only(vec![column.name.clone()]);
        let one = read(path, &ReadRequest { columns: one, ..request.clone() })
            .expect("a fixture as the script makes it");
        let names: Vec<&str> = one.columns.iter().map(|column| &*column.name).collect();
        assert_eq!(names, [&*column.name], "{at}");
        let shown = |c: &ColumnData| (0..c.len()).map(|row| c.show(row)).collect::<Vec<_>>();
        assert_eq!(shown(&one.columns[0].data), shown(&column.data), "{at}: {}", column.name);
    }
}

fn compare_column(found: &Particles, name: &str, values: &Value, tolerance: f64, at: &str) {
    let names: Vec<&str> = found.columns.iter().map(|column| &*column.name).collect();
    let column = found.column(name).unwrap_or_else(|| panic!("{at}: no `{name}` in {names:?}"));
    if values
        .as_array()
        .expect("a fixture as the script makes it")
        .first()
        .is_some_and(Value::is_string)
    {
        let own: Vec<String> = (0..found.len()).map(|row| column.data.show(row)).collect();
        let wanted: Vec<&str> = values
            .as_array()
            .expect("a fixture as the script makes it")
            .iter()
            .map(text_of)
            .collect();
        assert_eq!(own, wanted, "{at}: {name}");
    } else {
        let own: Vec<f64> = (0..found.len()).map(|row| column.number(row)).collect();
        compare(&own, &numbers(values), tolerance, &format!("{at}: {name}"));
    }
}

/// Compares numbers: to the bit, or within a tolerance relative to the larger of 1 and the number.
pub(crate) fn compare(found: &[f64], expected: &[f64], tolerance: f64, at: &str) {
    assert_eq!(found.len(), expected.len(), "{at}");
    for (row, (a, b)) in found.iter().zip(expected).enumerate() {
        let are_equal = a == b || a.is_nan() && b.is_nan();
        let are_close = (a - b).abs() <= tolerance * b.abs().max(1.0);
        assert!(are_equal || are_close, "{at}: {row}: {a:?}, expected {b:?}");
    }
}
