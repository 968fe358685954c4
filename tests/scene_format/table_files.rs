//! Files of sphere tables: types of columns, NumPy files, and what is left out or added. Scenes
//! with equal identities have equal numbers, to the last bit of f64.

use photosphere::math::DVec3;
use photosphere::scene::Scene;
use photosphere::scene::data::{SphereArrays, SphereData, StridedArray};
use photosphere::scene::description::SphereTable;

use crate::sphere_tables::{COLUMNS, Desk};

/// Rows of x, y, z and radius that f32 cannot hold.
const ROWS: [[f64; 4]; 3] =
    [[0.1, 1e9 + 0.3, -0.7, 0.25], [1.1, 1e9 + 0.3, -1.7, 0.5], [2.1, 1e9 + 0.3, -2.7, 0.75]];

fn arrays(rows: &[[f64; 4]]) -> SphereArrays {
    let [x, y, z, radius] = StridedArray::columns_from(rows.to_vec());
    SphereArrays { center: [x, y, z], radius, ..SphereArrays::default() }
}

/// Fails unless the table of a scene file holds these spheres.
fn must_hold(desk: &Desk, what: &str, arrays: SphereArrays) {
    let read = desk.load().unwrap_or_else(|error| panic!("{what}: {error}"));
    let mut description = read.description().clone();
    let name = Some(description.name_of_table(0));
    let material = description.tables[0].material;
    let data = SphereData::Memory(arrays);
    description.tables[0] = SphereTable { name, data, material, ..SphereTable::default() };
    let expected = Scene::build(description).expect("good arrays");
    assert_eq!(read.content_hash(), expected.content_hash(), "{what}");
    assert_eq!(read.spheres().rows(), expected.spheres().rows(), "{what}");
}

fn f64_bytes(values: impl IntoIterator<Item = f64>) -> Vec<u8> {
    values.into_iter().flat_map(f64::to_le_bytes).collect()
}

fn f32_bytes(values: impl IntoIterator<Item = f32>) -> Vec<u8> {
    values.into_iter().flat_map(f32::to_le_bytes).collect()
}

/// A NumPy file.
fn npy(version: u8, descr: &str, is_fortran: bool, shape: &str, bytes: &[u8]) -> Vec<u8> {
    let fortran_order = if is_fortran { "True" } else { "False" };
    let header =
        format!("{{'descr': {descr}, 'fortran_order': {fortran_order}, 'shape': {shape}, }}\n");
    let size = (header.len() as u32).to_le_bytes();
    let size = if version == 1 { &size[..2] } else { &size };
    [b"\x93NUMPY", &[version, 0][..], size, header.as_bytes(), bytes].concat()
}

/// A scene of one table in a NumPy file.
fn of_npy(columns: &str, file: &[u8]) -> Desk {
    Desk::new().table("a.npy", columns, "diffuse").bytes("a.npy", file)
}

/// A scene whose table does not list its columns.
fn without_columns(desk: Desk) -> Desk {
    let is_kept = |line: &&str| !line.starts_with("columns");
    let text = desk.text.lines().filter(is_kept).map(|line| format!("{line}\n")).collect();
    Desk { text, ..desk }
}

#[test]
fn columns_have_types_and_may_be_skipped() {
    let columns = r#"["_", "x:f64", "radius:f32", "_:f64", "y:f64", "z:f64"]"#;
    let row = |&[x, y, z, radius]: &[f64; 4]| {
        let radius = f32_bytes([radius as f32]);
        [f32_bytes([f32::NAN]), f64_bytes([x]), radius, f64_bytes([f64::NAN, y, z])].concat()
    };
    let bytes: Vec<u8> = ROWS.iter().flat_map(row).collect();
    let desk = Desk::new().table("a.bin", columns, "diffuse").bytes("a.bin", &bytes);
    must_hold(&desk, "mixed types", arrays(&ROWS));
    let same = r#"["x:f32", "y", "z:f32", "radius"]"#;
    let values = [0.5f32, 0.25, 0.125, 1.0];
    let desk = Desk::new().table("a.f32", same, "diffuse").values("a.f32", &values);
    must_hold(&desk, "f32", SphereArrays::from_rows(vec![values]));
    // Only f64 tells them apart.
    let one_bit_off = ROWS.map(|[x, y, z, r]| [x, y, f64::from_bits(z.to_bits() + 1), r]);
    let columns = r#"["x:f64", "y:f64", "z:f64", "radius:f64"]"#;
    for rows in [ROWS, one_bit_off] {
        let bytes = f64_bytes(rows.into_iter().flatten());
        let desk = Desk::new().table("a.bin", columns, "diffuse").bytes("a.bin", &bytes);
        must_hold(&desk, "f64", arrays(&rows));
    }
    let wrong = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1e16, 1.0];
    let desk = Desk::new().table("a.bin", columns, "diffuse").bytes("a.bin", &f64_bytes(wrong));
    let said = "`a.bin`: row 1 (the first is 0) has z = 1e16 at byte 48; it must be from -1e15 to \
                1e15";
    assert_eq!(desk.told(), [said]);
}

#[test]
fn unknown_columns_and_types_have_suggestions() {
    let help = |columns: &str| {
        let desk = Desk::new().table("a.f32", columns, "diffuse").values("a.f32", &[1.0; 60]);
        let error = desk.load().expect_err("an unknown column");
        assert_eq!(error.diagnostics().len(), 1, "{error}");
        error.diagnostics()[0].help.clone().expect("a help")
    };
    assert_eq!(help(r#"["x", "y", "z", "radius:f8"]"#), "did you mean `radius:f64`?");
    assert_eq!(help(r#"["x:f46", "y", "z", "radius"]"#), "did you mean `x:f64`?");
    assert_eq!(help(r#"["x", "y", "z", "radios"]"#), "did you mean `radius`?");
}

#[test]
fn numpy_files_of_all_kinds_hold_their_rows() {
    let wide = || f64_bytes(ROWS.into_iter().flatten());
    let by_column = || f64_bytes((0..4).flat_map(|column| ROWS.map(|row| row[column])));
    for version in [1, 2, 3] {
        let desk = of_npy(COLUMNS, &npy(version, "'<f8'", false, "(3, 4)", &wide()));
        must_hold(&desk, "C order", arrays(&ROWS));
        let desk = of_npy(COLUMNS, &npy(version, "'<f8'", true, "(3, 4)", &by_column()));
        must_hold(&desk, "Fortran order", arrays(&ROWS));
    }
    let typed = r#"["x:f64", "y", "z:f64", "radius"]"#;
    let desk = of_npy(typed, &npy(1, "'<f8'", false, "(3, 4)", &wide()));
    must_hold(&desk, "types that agree", arrays(&ROWS));
    let narrow = ROWS.map(|row| row.map(|number| number as f32));
    let bytes = f32_bytes(narrow.into_iter().flatten());
    let desk = of_npy(COLUMNS, &npy(1, "'<f4'", false, "(3, 4)", &bytes));
    must_hold(&desk, "f32", SphereArrays::from_rows(narrow.to_vec()));
    // The extension does not matter, and one column of three is skipped.
    let bytes = f64_bytes([9.0, 8.0, 7.0, 5.0, 6.0]);
    let columns = r#"["z", "y", "x", "_", "radius"]"#;
    let desk = Desk::new().table("a.bin", columns, "diffuse");
    let desk = desk.bytes("a.bin", &npy(1, "'<f8'", true, "(1, 5)", &bytes));
    must_hold(&desk, "reversed", arrays(&[[7.0, 8.0, 9.0, 6.0]]));
}

/// Written by NumPy 2.4: id, x, y, z (f64), radius (f32), a name and emission.
#[test]
fn the_fields_of_numpy_records_name_columns() {
    let file = std::fs::read("tests/data/stars.npy").expect("a table of ours");
    let expected = arrays(&ROWS);
    let light = [0.0f32, 2.0, 4.0].map(|light| [light; 3]).to_vec();
    let expected = expected.with_emission(light);
    let desk = without_columns(of_npy("[]", &file));
    must_hold(&desk, "by their names", expected.clone());
    let scene = desk.load().expect("a good table");
    let listed = serde_json::to_value(&scene.description().tables[0].data).expect("plain values");
    let names = serde_json::json!(["_", "x", "y", "z", "radius", "_", "emission"]);
    assert_eq!(listed["columns"], names);
    let columns = r#"["_", "x", "y:f64", "z", "radius:f32", "_", "emission"]"#;
    must_hold(&of_npy(columns, &file), "listed", expected);
    // A field of three numbers is three columns.
    let descr = "[('pos', '<f8', (3,)), ('radius', '<f8')]";
    let bytes = f64_bytes(ROWS.into_iter().flatten());
    let desk = of_npy(COLUMNS, &npy(1, descr, false, "(3,)", &bytes));
    must_hold(&desk, "a field of three", arrays(&ROWS));
}

#[test]
fn a_numpy_file_that_does_not_fit_is_told() {
    let four = f32_bytes([1.0; 4]);
    let told = |columns: &str, descr: &str, shape: &str, bytes: &[u8], expected: &str| {
        let told = of_npy(columns, &npy(1, descr, false, shape, bytes)).told();
        assert_eq!(told, [expected], "{descr} {shape}");
    };
    told(
        COLUMNS,
        "'>f4'",
        "(1, 4)",
        &four,
        "`a.npy` is a NumPy file of type `>f4`, not `<f4` or `<f8`",
    );
    told(
        COLUMNS,
        "'<f4'",
        "(4,)",
        &four,
        "`a.npy` is a NumPy file of shape (4), but a table has rows and columns",
    );
    told(
        COLUMNS,
        "'<f4'",
        "(2, 4)",
        &four,
        "`a.npy` has 16 bytes after its header, which promises 2 rows of 16 bytes",
    );
    told(
        COLUMNS,
        "'<f4'",
        "(9999999999999, 9999999999999)",
        &four,
        "`a.npy` has 16 bytes after its header, which promises 9999999999999 rows of \
         39999999999996 bytes",
    );
    told(
        COLUMNS,
        "'<f4'",
        "(9223372036854775807, 9223372036854775807)",
        &four,
        "`a.npy` has 16 bytes after its header, which promises 9223372036854775807 rows of too \
         many bytes",
    );
    told(COLUMNS, "'<f4'", "(0, 4)", &[], "`a.npy` has no rows");
    told(
        COLUMNS,
        "'<f4'",
        "(2, 2)",
        &four,
        "`a.npy` has 2 numbers in a row, but `columns` lists 4",
    );
    told(
        r#"["x:f64", "y", "z", "radius"]"#,
        "'<f4'",
        "(1, 4)",
        &four,
        "`a.npy` holds numbers of type `f32` in its column 0, not `x:f64`",
    );
    let record = "[('x', '<f4'), ('y', '<f4'), ('z', '<i4'), ('radius', '<f4')]";
    let of_type = "`a.npy` holds numbers of type `<i4` in its column 2, not `z`";
    told(COLUMNS, record, "(1,)", &four, of_type);
    let desk = without_columns(of_npy("[]", &npy(1, record, false, "(1,)", &four)));
    assert_eq!(desk.told(), [of_type]);
    let incomplete = "[('x', '<f4'), ('y', '<f4'), ('z', '<f4'), ('r', '<f4')]";
    let desk = without_columns(of_npy("[]", &npy(1, incomplete, false, "(1,)", &four)));
    assert_eq!(desk.told(), ["`sphere_tables.0.columns` lacks \"radius\", \"g\", \"b\""]);
    let plain = without_columns(of_npy("[]", &npy(1, "'<f4'", false, "(1, 4)", &four)));
    let said = "`a.npy` has 4 numbers in a row, but `columns` does not list them";
    assert_eq!(plain.told(), [said]);
    let raw = without_columns(Desk::new().table("a.f32", "[]", "diffuse").bytes("a.f32", &four));
    assert_eq!(raw.told(), ["`sphere_tables.0.columns` is missing"]);
    let huge = "[('x', '|V9999999')]";
    let desk = of_npy(r#"["_"]"#, &npy(1, huge, false, "(1,)", &vec![0; 9_999_999]));
    let told = desk.told();
    assert!(
        told.contains(&"`a.npy` has rows of 9999999 bytes, more than 4194304".into()),
        "{told:?}"
    );
}

/// More rows than are read at a time, in an order in which every chunk has several pieces.
#[test]
fn long_tables_in_fortran_order_are_read_in_pieces() {
    let rows: Vec<[f64; 4]> = (0..300_000).map(|i| [f64::from(i) + 0.1, 0.2, 0.3, 0.4]).collect();
    let by_column = (0..4).flat_map(|column| rows.iter().map(move |row| row[column]));
    let bytes = f64_bytes(by_column);
    let desk = of_npy(COLUMNS, &npy(1, "'<f8'", true, "(300000, 4)", &bytes));
    must_hold(&desk, "long", arrays(&rows));
    let mut wrong = bytes;
    let at = 8 * (3 * 300_000 + 299_999);
    wrong[at..at + 8].copy_from_slice(&(-1.0f64).to_le_bytes());
    let file = npy(1, "'<f8'", true, "(300000, 4)", &wrong);
    let position = file.len() - 8;
    let said = format!(
        "`a.npy`: row 299999 (the first is 0) has radius = -1.0 at byte {position}; it must be from \
         1e-15 to 1e15"
    );
    assert_eq!(of_npy(COLUMNS, &file).told(), [said]);
}

#[test]
fn an_offset_is_added_in_f64() {
    let values = [0.1f32, 0.2, 0.3, 0.5, -0.1, 2.5, 0.0, 0.25];
    let plain = || Desk::new().table("a.f32", COLUMNS, "diffuse").values("a.f32", &values);
    let with = |offset: &str| {
        let desk = plain();
        Desk { text: format!("{}offset = {offset}\n", desk.text), ..desk }
    };
    let offset = DVec3::new(1e9 + 0.3, -0.1, 3.0);
    let moved: Vec<[f64; 4]> = values
        .chunks_exact(4)
        .map(|row| {
            let [x, y, z, radius] = [row[0], row[1], row[2], row[3]].map(f64::from);
            [x + offset.x, y + offset.y, z + offset.z, radius]
        })
        .collect();
    must_hold(&with("[1000000000.3, -0.1, 3]"), "moved", arrays(&moved));
    let [plain, zero] = [plain(), with("[0, -0.0, 0]")].map(|desk| desk.load().expect("good"));
    assert_eq!(plain.content_hash(), zero.content_hash());
    // Arrays in memory move alike.
    let desk = with("[1000000000.3, -0.1, 3]");
    let mut description = desk.load().expect("good").description().clone();
    let rows = values.chunks_exact(4).map(|row| [row[0], row[1], row[2], row[3]]).collect();
    description.tables[0].name = Some("a.f32".into());
    let of_file = Scene::build(description.clone()).expect("good values").content_hash();
    description.tables[0].data = SphereData::Memory(SphereArrays::from_rows(rows));
    assert_eq!(Scene::build(description).expect("good values").content_hash(), of_file);
    let told = with("[1e15, 0, 0]").told();
    assert!(told[0].contains("has x = 0.1 at byte 0, which `offset` moves to"), "{told:?}");
    assert!(with("[2e15, 0, 0]").told()[0].starts_with("`sphere_tables.0.offset` must be"));
}

#[test]
fn rows_and_bytes_at_the_beginning_are_left_out() {
    let rows = [[0.1f32, 0.2, 0.3, 0.5], [1.1, 0.2, 0.3, 0.5], [2.1, 0.2, 0.3, -0.5]];
    let bytes = f32_bytes(rows.into_iter().flatten());
    let with = |columns: &str, file: &[u8], keys: &str| {
        let desk = Desk::new().table("a.f32", columns, "diffuse").bytes("a.f32", file);
        Desk { text: format!("{}{keys}\n", desk.text), ..desk }
    };
    let good = &bytes[..32];
    let expected = |first: usize| SphereArrays::from_rows(rows[first..2].to_vec());
    must_hold(&with(COLUMNS, good, "skip_rows = 1"), "rows", expected(1));
    let with_header = [b"12345", good].concat();
    must_hold(&with(COLUMNS, &with_header, "skip_bytes = 5"), "bytes", expected(0));
    must_hold(&with(COLUMNS, &with_header, "skip_bytes = 5\nskip_rows = 1"), "both", expected(1));
    for is_fortran in [false, true] {
        let by_column: Vec<f32> =
            (0..4).flat_map(|column| [rows[0][column], rows[1][column]]).collect();
        let numbers = if is_fortran { f32_bytes(by_column) } else { good.to_vec() };
        let file = npy(1, "'<f4'", is_fortran, "(2, 4)", &numbers);
        must_hold(&with(COLUMNS, &file, "skip_rows = 1"), "NumPy", expected(1));
    }
    // Rows are numbered as they are in the file.
    let told =
        with(COLUMNS, &[b"12345", &bytes[..]].concat(), "skip_bytes = 5\nskip_rows = 1").told();
    let said = "`a.f32`: row 2 (the first is 0) has radius = -0.5 at byte 49; it must be from 1e-15 \
                to 1e15";
    assert_eq!(told, [said]);
    let said = "`a.f32` has 2 rows, and `skip_rows` leaves out 2";
    assert_eq!(with(COLUMNS, good, "skip_rows = 2").told(), [said]);
    let said = "`a.f32` has 32 bytes, and `skip_bytes` leaves out 32";
    assert_eq!(with(COLUMNS, good, "skip_bytes = 32").told(), [said]);
    let file = npy(1, "'<f4'", false, "(2, 4)", good);
    let said = "`a.f32` is a NumPy file, whose header says where its rows begin";
    assert_eq!(with(COLUMNS, &file, "skip_bytes = 1").told(), [said]);
    let error = with(COLUMNS, good, "skip_rows = 2").load().expect_err("no rows");
    let place = error.diagnostics()[0].location.clone().expect("a place");
    assert_eq!(&place.source.text[place.span], "2");
}

#[test]
fn emission_of_a_row_is_checked() {
    let columns = r#"["x", "y", "z", "radius", "emission_b", "emission_g", "emission_r"]"#;
    let desk = |light: [f32; 3]| {
        let values = [&[0.0, 0.0, 0.0, 1.0], &light[..]].concat();
        Desk::new().table("a.f32", columns, "diffuse").values("a.f32", &values)
    };
    let light = desk([1.0, 0.5, 1e15]).load().expect("good").sphere_material(0).material.emission;
    assert_eq!(light.to_array(), [1e15, 0.5, 1.0]);
    for light in [-1.0, f32::NAN, f32::INFINITY, 2e15] {
        let told = desk([0.0, light, 0.0]).told();
        let said = format!(
            "`a.f32`: row 0 (the first is 0) has emission_g = {light:?} at byte 20; it must be from \
             0 to 1e15"
        );
        assert_eq!(told, [said]);
    }
}
