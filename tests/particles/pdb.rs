//! PDB and PQR.

use photosphere::particles::{LengthUnit, ReadRequest, count_frames, read};

use super::kit::{bytes, check, error, fixture, frame};

#[test]
fn files_of_gemmi_and_mdanalysis_are_read_as_they_read_them() {
    check("pdb", 3);
}

#[test]
fn models_are_frames_and_the_best_location_stays() {
    let path = fixture("pdb/gemmi.pdb");
    assert_eq!(count_frames(&path, &ReadRequest::default()).unwrap(), 2);
    let found = read(&path, &frame(-1)).unwrap();
    assert_eq!(found.notes, ["1 alternate location of lower occupancy left out"]);
    assert_eq!(found.unit, Some(LengthUnit::Angstrom));
    let occupancy = found.column("occupancy").unwrap().range();
    assert_eq!(occupancy, Some([0.75, 1.0]));
}

const ATOM: &str =
    "ATOM      1  CA  ALA A   1      11.104   6.134  -6.504  1.00  0.00           C  \n";

#[test]
fn odd_lines_are_read() {
    let cut = "HETATM***** FE   HEM A9999      -1.000   2.000   3.000\n";
    let four = "ATOM  A0000 HG11LVALX A000     100.000 200.000 300.000  1.00  0.00\n";
    let found = bytes(format!(
        "CRYST1    1.000    1.000    1.000  90.00  90.00  90.00\n{ATOM}{cut}TER\n{four}END\n"
    ))
    .unwrap();
    assert_eq!((found.len(), found.cell), (3, None));
    let shown = |name: &str| -> Vec<String> {
        let column = found.column(name).unwrap();
        (0..3).map(|row| column.data.show(row)).collect()
    };
    assert_eq!(shown("element"), ["C", "Fe", "H"]);
    assert_eq!(shown("serial"), ["1", "-1", "100000"]);
    assert_eq!(shown("resid"), ["1", "9999", "10000"]);
    assert_eq!(shown("resname"), ["ALA", "HEM", "VALX"]);
    assert_eq!(shown("record"), ["ATOM", "HETATM", "ATOM"]);
}

#[test]
fn pqr_has_charge_and_radius() {
    let text = "REMARK by hand\nATOM      1  N   ALA     1      -1.5   2.25   3.0  -0.30  1.85\nATOM  2 \
                CA GLY B 2 1.0 2.0 3.0 0.21 2.275\nEND\n";
    let found = bytes(text).unwrap();
    let number = |name: &str, row| found.column(name).unwrap().number(row);
    assert_eq!((number("charge", 0), number("radius", 1)), (-0.30, 2.275));
    assert_eq!(found.column("chain").unwrap().data.show(1), "B");
    assert_eq!(found.positions.get(0).to_array(), [-1.5, 2.25, 3.0]);
}

#[test]
fn mistakes_have_their_line() {
    for (text, message) in [
        (format!("{ATOM}{}", &ATOM[..40]), "memory:2: expected y in columns 39 to 46, found"),
        (ATOM.replace("6.134", "x.134"), "memory:1: expected y in columns 39 to 46, found `x.134`"),
        (
            ATOM.replace("  6.134", "    nan"),
            "memory:1: expected y in columns 39 to 46, found `nan`",
        ),
        ("REMARK   1 nothing\nEND\n".to_owned(), "memory: it has no atoms"),
        (format!("CRYST1 odd\n{ATOM}"), "memory:1: expected lengths and angles of the cell"),
    ] {
        let found = error(text);
        assert!(found.starts_with(message), "{found}");
    }
    let mut path = read(&fixture("pdb/gemmi.pdb"), &frame(2)).unwrap_err().to_string();
    path = path.split(": ").last().unwrap().to_owned();
    assert_eq!(path, "it has 2 models, and no frame 2 (the first is 0)");
}
