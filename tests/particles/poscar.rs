//! VASP POSCAR and XDATCAR.

use photosphere::particles::{LengthUnit, ReadRequest, count_frames};

use super::kit::{bytes, check, error, fixture};

#[test]
fn files_of_ase_are_read_as_it_reads_them() {
    check("poscar", 4);
    let count = |name: &str| count_frames(&fixture(name), &ReadRequest::default()).unwrap();
    assert_eq!((count("poscar/XDATCAR"), count("poscar/direct.vasp")), (2, 1));
}

const HEAD: &str = "cubic\n2.0\n1 0 0\n0 1 0\n0 0 1\n";

#[test]
fn scales_and_symbols_are_heeded() {
    let found = bytes(format!(
        "{HEAD}Fe_pv O\n1 2\nSelective\nDirect\n0 0 0 T T F\n.5 .5 .5 T T T\n1 0 0 F F F\n\n0 0 0\n"
    ))
    .unwrap();
    assert_eq!(found.unit, Some(LengthUnit::Angstrom));
    assert_eq!(found.positions.get(1).to_array(), [1.0, 1.0, 1.0]);
    let shown = |row| found.column("element").unwrap().data.show(row);
    assert_eq!((shown(0), shown(2)), ("Fe".into(), "O".into()));
    // A negative scale is the volume; VASP 4 has no symbols.
    let text = format!("{HEAD}1 1\nCartesian\n1 0 0\n0 0.5 0\n").replace("2.0", "-27");
    let found = bytes(text).unwrap();
    assert_eq!(found.positions.get(0).to_array(), [3.0, 0.0, 0.0]);
    assert_eq!(found.column("type").unwrap().data.show(1), "2");
    assert_eq!(found.cell.unwrap().volume(), 27.0);
}

#[test]
fn mistakes_have_their_line() {
    for (text, message) in [
        (
            format!("{HEAD}O\n2\nDirect\n0 0 0\n"),
            "memory:10: expected 2 lines with particles, found 1",
        ),
        (format!("{HEAD}O\n2\nIndirect\n0 0 0\n"), "memory:8: expected `Direct` or `Cartesian`"),
        (
            format!("{HEAD}O H\n2\nDirect\n0 0 0\n"),
            "memory:7: expected the number of atoms of each",
        ),
        (
            format!("{HEAD}O\n1\nDirect\n0 0\n"),
            "memory:9: expected 3 values, found 2 (z is missing)",
        ),
        (
            format!("{HEAD}O\n1152921504606846976\nDirect\n0 0 0\n"),
            "memory:10: expected 1152921504606846976 lines with particles",
        ),
        (
            format!("{HEAD}O\n1\nDirect\n0 0 0\n").replace("2.0", "0.0"),
            "memory:2: expected a scale",
        ),
    ] {
        let found = error(text);
        assert!(found.starts_with(message), "{found}");
    }
}
