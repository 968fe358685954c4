//! VTK files: XML and legacy.

use photosphere::particles::{ReadRequest, count_frames, read, survey};

use super::kit::{bytes, check, error, fixture, frame};

#[test]
fn files_of_vtk_and_meshio_are_read_as_vtk_reads_them() {
    check("vtk", 21);
}

#[test]
fn collections_have_frames_with_times() {
    let path = fixture("vtk/times.pvd");
    assert_eq!(count_frames(&path, &ReadRequest::default()).unwrap(), 2);
    assert_eq!(read(&path, &frame(-1)).unwrap().time, Some(1.5));
    assert!(read(&path, &frame(2)).is_err());
    let away = "<VTKFile type=\"Collection\"><Collection>\n<DataSet file=\"../a.vtp\"/></Collection></VTKFile>";
    assert!(error(away).starts_with("memory:2: expected a file beside the collection"));
}

#[test]
fn ranges_are_those_of_the_file() {
    let told = survey(&fixture("vtk/ascii.vtp"), &frame(0)).unwrap();
    let radius = told.columns.iter().find(|info| info.name == "radius").unwrap();
    let [low, high] = radius.range.expect("a range");
    assert!(0.0 < low && low < high && high < 1.0);
}

const FILE: &str = "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" byte_order=\"LittleEndian\">\n\
    <PolyData>\n<Piece NumberOfPoints=\"2\">\n<Points>\n<DataArray type=\"Float32\" \
    NumberOfComponents=\"3\" format=\"ascii\">1 2 3 4 5 6</DataArray>\n</Points>\n<PointData>\n\
    <DataArray type=\"Int64\" Name=\"id\" format=\"ascii\">7 8</DataArray>\n</PointData>\n</Piece>\n\
    </PolyData>\n</VTKFile>\n";

#[test]
fn pieces_are_joined() {
    let (before, piece) = FILE.split_at(FILE.find("<Piece").unwrap());
    let (piece, after) = piece.split_at(piece.find("</PolyData>").unwrap());
    let found = bytes(format!("{before}{piece}{piece}{after}")).unwrap();
    assert_eq!(found.len(), 4);
    assert_eq!(found.column("id").unwrap().number(3), 8.0);
    assert_eq!(found.positions.get(2).to_array(), [1.0, 2.0, 3.0]);
}

#[test]
fn mistakes_are_named() {
    for (text, message) in [
        (
            FILE.replace("\"2\"", "\"1152921504606846976\""),
            "the file ends too early: 1152921504606846976 rows",
        ),
        (FILE.replace("4 5 6", "4 5"), "the file ends too early: 2 rows of 12 bytes needs 24"),
        (FILE.replace("4 5 6", "4 five 6"), "expected a number, found `five`"),
        (FILE.replace("4 5 6", "4 nan 6"), "row 1 (the first is 0) is at (4.0, NaN, 6.0)"),
        (FILE.replace("\"2\"", "\"two\""), "expected a number for `NumberOfPoints`, found `two`"),
        (FILE.replace("</Piece>", ""), "the XML is damaged"),
        (
            FILE.replace("ascii", "odd"),
            "expected the format ascii, binary or appended, found `odd`",
        ),
        (FILE.replace("ascii", "appended"), "expected a number for `offset`"),
        (
            FILE.replace("byte_order", "compressor=\"vtkLZ4DataCompressor\" byte_order"),
            "its arrays are compressed by `vtkLZ4DataCompressor`",
        ),
    ] {
        let found = error(text);
        assert!(found.contains(message), "{found}");
    }
}

const LEGACY: &str = "# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET POLYDATA\nPOINTS 2 float\n1 2 3\n4 5 6\n\
    POINT_DATA 2\nSCALARS a%20b int 1\nLOOKUP_TABLE default\n7 8\nVECTORS v double\n1 0 0 0 1 0\n";

#[test]
fn legacy_files_have_mistakes_named() {
    let found = bytes(LEGACY).unwrap();
    assert_eq!(found.column("a b").unwrap().number(1), 8.0);
    assert_eq!(found.column("v_y").unwrap().number(1), 1.0);
    for (text, message) in [
        (
            LEGACY.replace("POINTS 2", "POINTS 1152921504606846976"),
            "memory:8: expected a number, found `POINT_DATA`",
        ),
        (LEGACY.replace("4 5 6", "4 5 six"), "memory:7: expected a number, found `six`"),
        (LEGACY.replace("POINT_DATA 2", "POINT_DATA 3"), "memory:8: expected data for 2 points"),
        (LEGACY.replace("VECTORS", "VECTOR"), "memory:12: expected a keyword of a VTK file"),
        (LEGACY.replace("POLYDATA", "FIELD"), "memory:4: expected POLYDATA"),
        (LEGACY.replace("ASCII", "EBCDIC"), "memory:3: expected ASCII or BINARY, found `EBCDIC`"),
    ] {
        let found = error(text);
        assert!(found.contains(message), "{found}");
    }
    let binary =
        LEGACY.replace("ASCII", "BINARY").replace("POINTS 2", "POINTS 1152921504606846976");
    assert!(error(binary).contains("the file ends too early"));
}
