//! Tests the memory use and row order of tables.

use tempfile::NamedTempFile;

use super::*;
use crate::scene::data::{Column, SphereArrays};
use crate::scene::description::{ColorStorage, MaterialDescription, SphereDescription};

/// Imports a valid description.
fn imported(mut description: SceneDescription) -> (SphereRows, Vec<RowGroup>) {
    let mut problems = ValidationErrors::default();
    let survey = ImportPlan::scan(&mut description, &mut problems);
    let read = load_tables(&mut description, survey, &mut problems).expect("few spheres");
    assert!(problems.0.is_empty(), "{problems:?}");
    read
}

/// A description with one inline sphere and these tables.
fn described(tables: Vec<SphereTable>) -> SceneDescription {
    let spheres = vec![SphereDescription { radius: 1.0, ..SphereDescription::default() }];
    let materials = vec![MaterialDescription::default()];
    SceneDescription { materials, spheres, tables, ..SceneDescription::default() }
}

fn file_of(values: &[f32]) -> NamedTempFile {
    let file = NamedTempFile::new().expect("a file");
    let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
    std::fs::write(file.path(), bytes).expect("the disk takes it");
    file
}

fn table(file: &NamedTempFile, columns: &[Column]) -> SphereTable {
    let data = SphereData::file(file.path(), columns.iter().copied());
    SphereTable { data, ..SphereTable::default() }
}

const PLAIN: [Column; 4] = [Column::X, Column::Y, Column::Z, Column::Radius];

#[test]
fn a_table_longer_than_the_buffer_keeps_its_order_and_fits_at_once() {
    let count = 600_000;
    let values: Vec<f32> = (0..count).flat_map(|i| [i as f32, 0.0, 0.0, 1.0]).collect();
    let file = file_of(&values);
    let (rows, groups) = imported(described(vec![table(&file, &PLAIN)]));
    assert_eq!(rows.table.len(), count);
    // The exact sphere will be appended.
    assert_eq!(rows.table.capacity(), count + 1, "nothing was moved or held twice");
    assert!(rows.table.iter().enumerate().all(|(i, row)| row[0] == i as f32));
    assert_eq!((groups[0].first_row, groups[0].count), (1, count as u32));
}

#[test]
fn packed_colours_take_a_third_of_the_memory() {
    use Column::{Blue, Green, Red};
    let file = file_of(&[0.0, 0.0, 0.0, 1.0, 0.25, 0.5, 1.0]);
    let colored = table(&file, &[&PLAIN[..], &[Red, Green, Blue]].concat());
    let packed = SphereTable { colors: ColorStorage::Packed, ..colored.clone() };
    let (_, groups) = imported(described(vec![colored, packed]));
    let bytes = |group: &RowGroup| match group.colors.as_ref().expect("colours") {
        SphereColors::Exact(colors) => size_of_val(&colors[..]),
        SphereColors::Packed(colors) => size_of_val(&colors[..]),
    };
    let planned = [ColorStorage::Exact, ColorStorage::Packed].map(ColorStorage::bytes_per_color);
    assert_eq!([&groups[0], &groups[1]].map(bytes), planned);
    assert_eq!(planned, [12, 4]);
}

/// Rows are numbered in table order, although f64 tables are stored separately.
#[test]
fn tables_of_both_precisions_keep_their_order() {
    let file = file_of(&[1.0, 0.0, 0.0, 1.0]);
    let narrow = |x: f32| SphereArrays::from_rows(vec![[x, 0.0, 0.0, 1.0]]);
    let memory = |arrays| SphereTable { data: SphereData::Memory(arrays), ..Default::default() };
    let wide = SphereArrays::from_centers(vec![[0.1, 0.0, 0.0]], vec![1.0]);
    let tables = vec![table(&file, &PLAIN), memory(wide), memory(narrow(3.0))];
    let (rows, groups) = imported(described(tables));
    let exact: Vec<f64> = rows.exact.iter().map(|sphere| sphere.center.x).collect();
    assert_eq!(exact, [0.0, 1.0, 0.1]);
    assert_eq!(rows.exact.capacity(), 3, "nothing was moved or held twice");
    assert_eq!(rows.table, [[3.0, 0.0, 0.0, 1.0]]);
    let first: Vec<u32> = groups.iter().map(|group| group.first_row).collect();
    assert_eq!(first, [1, 2, 3]);
}
