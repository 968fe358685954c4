//! PLY.

use photosphere::particles::{ColumnData, Role, read, survey};

use super::kit::{bytes, check, error, fixture, frame, only};

#[test]
fn files_of_plyfile_are_read_to_the_bit() {
    check("ply", 4);
}

#[test]
fn colours_stay_bytes() {
    let found = read(&fixture("ply/little.ply"), &frame(0)).unwrap();
    assert!(matches!(found.role(Role::Red).unwrap().data, ColumnData::U8(_)));
    assert_eq!(found.title.as_deref(), Some("by plyfile"));
}

#[test]
fn splats_are_spheres_and_say_so() {
    let path = fixture("ply/splats.ply");
    let found = read(&path, &only(&["radius"])).unwrap();
    let names: Vec<&str> = found.columns.iter().map(|column| &*column.name).collect();
    assert_eq!(names, ["radius"]);
    assert!(found.notes[0].contains("3D Gaussian splats are shown as spheres"));
    let told = survey(&path, &frame(0)).unwrap();
    assert!(told.columns.iter().any(|info| info.name == "opacity"));
    assert!(!told.columns.iter().any(|info| info.name == "f_dc_0"));
}

const HEAD: &str = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n";

#[test]
fn mistakes_are_named() {
    let end = "property float z\nend_header\n";
    for (text, message) in [
        (format!("{HEAD}{end}1 2 3\n4 5\n"), "memory:9: expected 3 values, found 2 (z is missing)"),
        (format!("{HEAD}{end}1 2 3\n"), "memory:9: expected 2 lines with vertices, found 1"),
        (format!("{HEAD}end_header\n"), "memory: its vertices have no x, y and z among x, y"),
        (
            format!("{HEAD}property list int int x\nproperty float z\nend_header\n"),
            "memory: its vertices have a list, `x`",
        ),
        ("ply\nformat odd 1.0\n".to_owned(), "memory:2: expected a line of a PLY header"),
        (
            "ply\nformat ascii 1.0\nelement face 1\nproperty int x\nend_header\n1\n".to_owned(),
            "memory: there is no `element vertex`",
        ),
        (format!("{HEAD}property odd z\n"), "memory:6: expected a line of a PLY header"),
        (HEAD.to_owned(), "memory:6: expected `end_header` in the first 64 KiB"),
    ] {
        let found = error(text);
        assert!(found.starts_with(message), "{found}");
    }
    let binary = HEAD
        .replace("ascii", "binary_little_endian")
        .replace("vertex 2", "vertex 1152921504606846976");
    let found = error(format!("{binary}{end}1234"));
    assert!(found.contains("1152921504606846976 rows of 12 bytes needs"), "{found}");
    // A list that promises more than there is.
    let list = binary.replace(
        "element vertex",
        "element face 3\nproperty list uint uint vertices\nelement vertex",
    );
    let found = error([format!("{list}{end}").as_bytes(), &[0xff; 40]].concat());
    assert!(found.contains("the file ends too early"), "{found}");
    let found = bytes(format!("{HEAD}{end}1 2 3\n4 5 6\n").replace('\n', "\r\n")).unwrap();
    assert_eq!(found.positions.get(1).to_array(), [4.0, 5.0, 6.0]);
}
