//! GROMACS GRO.

use photosphere::math::DVec3;
use photosphere::particles::{LengthUnit, read_bytes};

use super::kit::{bytes, check, error, frame};

#[test]
fn files_of_mdanalysis_are_read_as_it_reads_them() {
    check("gro", 1);
}

const WATER: &str = "Water t=  2.50000 step= 3\n    2\n    1SOL     OW    1   0.126   1.624   1.679\n    \
                     1SOL    HW199999   0.190  -1.661   1.747\n   1.82060   1.82060   1.82060\n";

#[test]
fn frames_follow_each_other() {
    let two = WATER.repeat(2).replace("Water", "Again");
    let found = read_bytes("a".as_ref(), two.as_bytes(), &frame(-1)).unwrap();
    assert_eq!((found.frame, found.time, found.unit), (1, Some(2.5), Some(LengthUnit::Nanometre)));
    assert_eq!(found.positions.get(1).to_array(), [0.190, -1.661, 1.747]);
    let shown = |name: &str| found.column(name).unwrap().data.show(1);
    assert_eq!([shown("name"), shown("atom_id"), shown("resname")], ["HW1", "99999", "SOL"]);
    assert_eq!(found.cell.unwrap().vectors[0], DVec3::X * 1.82060);
}

/// The width of the coordinates follows from the first atom.
#[test]
fn more_decimals_are_read() {
    let text = "title\n1\n    1SOL     OW    1    0.12612    1.62456    1.67998    0.123456    0.2    \
                0.3\n1 2 3 0 0 0.5 0 0.25 0.125\n";
    let found = bytes(text).unwrap();
    assert_eq!(found.positions.get(0).to_array(), [0.12612, 1.62456, 1.67998]);
    let [a, b, c] = found.cell.unwrap().vectors;
    assert_eq!((a, b), (DVec3::new(1.0, 0.0, 0.0), DVec3::new(0.5, 2.0, 0.0)));
    assert_eq!(c, DVec3::new(0.25, 0.125, 3.0));
}

#[test]
fn mistakes_have_their_line() {
    for (text, message) in [
        (WATER.replace("  1.624", "  x.624"), "memory:3: expected y in column 29, found `x.624`"),
        (WATER.replace("    2\n", "    3\n"), "memory:5: expected"),
        (WATER.replace("   1.82060\n", "\n"), "memory:5: expected a box of 3 or 9 numbers"),
        (WATER.replace("    2\n", "1152921504606846976\n"), "memory:5: expected"),
    ] {
        let found = error(text);
        assert!(found.starts_with(message), "{found}");
    }
}
