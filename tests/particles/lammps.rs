//! LAMMPS dumps and data files.

use photosphere::math::DVec3;
use photosphere::particles::{Format, ReadRequest, read, read_bytes};

use super::kit::{bytes, check, error, fixture, frame};

#[test]
fn files_of_lammps_ase_and_ovito_are_read_as_they_read_them() {
    check("lammps", 8);
}

/// One run dumped in four conventions, in three kinds of box: wrapped coordinates, and unwrapped
/// ones where image flags say how far an atom went.
#[test]
fn all_conventions_give_the_same_positions() {
    for name in ["ortho", "tilted", "general"] {
        let of = |kind: &str, step: i64| {
            let path = fixture(&format!("lammps/{name}-{kind}.dump"));
            read(&path, &frame(step)).unwrap_or_else(|error| panic!("{error}"))
        };
        for step in [0, 1] {
            let [x, xs, xu, xsu] = ["x", "xs", "xu", "xsu"].map(|kind| of(kind, step));
            let cell = x.cell.expect("a box");
            assert!([&xs, &xu, &xsu].iter().all(|other| other.cell == x.cell));
            let image = |row: usize, name: &str| x.column(name).unwrap().number(row);
            for row in 0..x.len() {
                let wrapped = x.positions.get(row);
                let [a, b, c] = cell.vectors;
                let shift = a * image(row, "ix") + b * image(row, "iy") + c * image(row, "iz");
                let near = |found: DVec3, expected: DVec3| {
                    let off = (found - expected).abs().max_element();
                    assert!(off <= 1e-6, "{name} frame {step} row {row}: off by {off}");
                };
                near(xs.positions.get(row), wrapped);
                near(xu.positions.get(row), wrapped + shift);
                near(xsu.positions.get(row), wrapped + shift);
            }
        }
        let moved = |name: &str| of("x", 1).column(name).unwrap().range() != Some([0.0, 0.0]);
        assert!(["ix", "iy", "iz"].iter().any(|name| moved(name)), "no atom left the box");
    }
}

const HEAD: &str = "ITEM: TIMESTEP\n7\nITEM: NUMBER OF ATOMS\n2\n";

/// The bounds of a tilted box are those of its bounding box.
#[test]
fn a_tilted_box_lies_within_its_bounds() {
    let text = format!(
        "{HEAD}ITEM: BOX BOUNDS xy xz yz pp ff ps\n-1.5 8.5 2\n-3 5 -1.5\n0 4 -1\nITEM: ATOMS id xs \
         ys zs c_a[2]\n1 0 0 0 3\n2 1 1 1 4.5\n"
    );
    let found = bytes(text).unwrap();
    let cell = found.cell.unwrap();
    assert_eq!(cell.origin, DVec3::new(0.0, -2.0, 0.0));
    let expected =
        [DVec3::new(6.5, 0.0, 0.0), DVec3::new(2.0, 7.0, 0.0), DVec3::new(-1.5, -1.0, 4.0)];
    assert_eq!(cell.vectors, expected);
    assert_eq!(cell.periodic, [true, false, true]);
    assert_eq!(found.positions.get(0), cell.origin);
    assert_eq!(found.positions.get(1), cell.origin + expected[0] + expected[1] + expected[2]);
    assert_eq!(found.column("c_a[2]").unwrap().number(1), 4.5);
    assert_eq!((found.time, found.format), (Some(7.0), Format::LammpsDump));
}

#[test]
fn identifiers_have_64_bits() {
    let text = format!("{HEAD}ITEM: ATOMS id x y z\n9007199254740993 0 0 0\n1 1 1 1\n");
    let found = bytes(text).unwrap();
    assert_eq!(found.column("id").unwrap().data.show(0), "9007199254740993");
}

#[test]
fn mistakes_in_dumps_have_their_line() {
    let atoms = |columns: &str| format!("{HEAD}ITEM: ATOMS {columns}\n1 0 0 0\n2 1 1 1\n");
    for (text, message) in [
        (atoms("id a b c"), "memory:5: expected coordinates x y z, xs ys zs"),
        (atoms("id xs ys zs"), "memory:5: expected `ITEM: BOX BOUNDS` before scaled coordinates"),
        (atoms("id x y z vx"), "memory:6: expected 5 values, found 4 (vx is missing)"),
        (atoms("id x y"), "memory:5: expected coordinates"),
        (format!("{HEAD}ITEM: ATOM x y z\n"), "memory:5: expected TIMESTEP, UNITS"),
        (format!("{HEAD}garbage\n"), "memory:5: expected `ITEM: ...`, found `garbage`"),
        (
            "ITEM: NUMBER OF ATOMS\nmany\n".to_owned(),
            "memory:2: expected the number of atoms, found `many`",
        ),
        (
            atoms("id x y z").replace("ATOMS\n2", "ATOMS\n1152921504606846976"),
            "memory:8: expected 1152921504606846976 lines with particles, found 2 and the end",
        ),
        (
            format!("{HEAD}ITEM: BOX BOUNDS pp pp pp\n0 1\n0\n"),
            "memory:7: expected 2 numbers that bound the box, found `0`",
        ),
    ] {
        let found = error(text);
        assert!(found.starts_with(message), "{found}");
    }
}

fn data(style: &str, atoms: &str) -> String {
    format!(
        "title\n\n2 atoms\n1 bonds\n2 atom types\n\n-1 5 xlo xhi\n0 6 ylo yhi\n0 7 zlo zhi\n1 2 3 xy \
         xz yz\n\nMasses\n\n1 15.999 # O\n2 1.008 # H\n\nAtoms{style}\n\n{atoms}\nBonds\n\n1 1 1 2\n"
    )
}

#[test]
fn data_files_tell_their_style_or_have_it_guessed() {
    let text = data(" # full", "1 1 1 -0.8 0 1 2\n2 1 2 0.4 3 4 5 # a comment\n");
    let found = bytes(&text).unwrap();
    assert_eq!(found.format, Format::LammpsData);
    let shown = |name: &str| found.column(name).unwrap().data.show(1);
    assert_eq!([shown("id"), shown("mol"), shown("type")], ["2", "1", "2"]);
    assert_eq!([shown("q"), shown("mass"), shown("element")], ["0.4", "1.008", "H"]);
    assert_eq!(found.positions.get(1), DVec3::new(3.0, 4.0, 5.0));
    let cell = found.cell.unwrap();
    assert_eq!((cell.origin.x, cell.vectors[2]), (-1.0, DVec3::new(2.0, 3.0, 7.0)));
    for (atoms, columns) in [
        ("1 1 0 1 2\n2 2 3 4 5\n", &["id", "type"][..]),
        ("1 1 0.5 0 1 2\n2 2 0.5 3 4 5\n", &["id", "type", "q"]),
        ("1 1 1 0 1 2\n2 1 2 3 4 5\n", &["id", "mol", "type"]),
        ("1 1 1 0.5 0 1 2\n2 1 2 0.5 3 4 5\n", &["id", "mol", "type", "q"]),
        ("1 1 0.5 2.5 0 1 2\n2 2 0.5 2.5 3 4 5\n", &["id", "type", "diameter", "density"]),
        ("1 1 0 1 2 0 0 -1\n2 2 3 4 5 1 0 0\n", &["id", "type", "ix", "iy", "iz"]),
    ] {
        let found = bytes(data("", atoms)).unwrap();
        let names: Vec<&str> = found.columns.iter().map(|column| &*column.name).collect();
        assert_eq!(names[..columns.len()], *columns);
        assert_eq!(found.positions.get(1), DVec3::new(3.0, 4.0, 5.0), "{names:?}");
        assert!(
            found.notes[0].contains("the style of the atoms is not named"),
            "{:?}",
            found.notes
        );
    }
}

#[test]
fn mistakes_in_data_files_have_their_line() {
    let plain = "1 1 0 1 2\n2 2 3 4 5\n";
    for (text, message) in [
        (data(" # sperm", plain), "memory:19: the style `sperm` of the atoms is not known"),
        (data(" # atomic", "1 1 0 1 2\n"), "memory:20: expected 5 values, found 0"),
        (
            data("", "1 a b\n"),
            "memory:19: the style of the atoms is not named, and 3 values fit none",
        ),
        (data("", plain).replace("2 atoms", "x atoms"), "memory:3: expected the number of atoms"),
        (data("", plain).replace("-1 5 xlo", "-1 xlo"), "memory:7: expected two bounds of the box"),
        (
            data(" # atomic", plain).replace("2 atoms", "1152921504606846976 atoms"),
            "memory:21: expected 5 values",
        ),
    ] {
        let format = Some(Format::LammpsData);
        let request = ReadRequest { format, ..ReadRequest::default() };
        let found =
            read_bytes("memory".as_ref(), text.as_bytes(), &request).unwrap_err().to_string();
        assert!(found.starts_with(message), "{found}");
    }
    let names = ["id", "_", "x", "y", "z"].map(str::to_owned).to_vec();
    let request = ReadRequest { names, ..ReadRequest::default() };
    let found = read_bytes("a".as_ref(), data("", plain).as_bytes(), &request).unwrap();
    assert!(found.column("type").is_none());
}
