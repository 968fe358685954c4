//! XYZ and extended XYZ.

use photosphere::particles::{Format, ReadRequest, Role, Wanted, count_frames, read, read_bytes};

use super::kit::{bytes, check, error, fixture, frame};

#[test]
fn files_of_ase_and_ovito_are_read_as_they_read_them() {
    check("xyz", 4);
}

#[test]
fn frames_have_their_own_number_of_particles() {
    let path = fixture("xyz/extended.xyz");
    assert_eq!(count_frames(&path, &ReadRequest::default()).unwrap(), 2);
    let of = |number: i64| read(&path, &frame(number)).unwrap();
    assert_eq!((of(0).len(), of(1).len()), (7, 4));
    assert_eq!(of(-1), of(1));
    assert_eq!(of(-2), of(0));
    let told = read(&path, &frame(2)).unwrap_err().to_string();
    assert!(told.ends_with("it has 2 frames, and no frame 2 (the first is 0)"), "{told}");
    assert!(read(&path, &frame(-3)).is_err());
}

#[test]
fn plain_files_have_elements_or_types_and_more_columns() {
    let text = "2\ntitle\nO 1 2 3 0.5\nH -1 1.0D+01 .5 1\n";
    let found = bytes(text).unwrap();
    assert_eq!((found.format, found.first_line), (Format::Xyz, Some(3)));
    assert_eq!(found.title.as_deref(), Some("title"));
    assert_eq!(found.positions.get(1).to_array(), [-1.0, 10.0, 0.5]);
    assert_eq!(found.role(Role::Element).unwrap().data.show(1), "H");
    assert_eq!(found.column("column_5").unwrap().number(0), 0.5);
    // LAMMPS writes numbers of types.
    let found = bytes("1\n\n2 1 2 3\n").unwrap();
    assert_eq!(found.role(Role::Type).unwrap().number(0), 2.0);
    assert_eq!(found.title, None);
    let names = ["_", "x", "z", "y"].map(str::to_owned).to_vec();
    let request = ReadRequest { names, ..ReadRequest::default() };
    let found = read_bytes("a".as_ref(), b"1\n\nO 1 2 3\n", &request).unwrap();
    assert_eq!(found.positions.get(0).to_array(), [1.0, 3.0, 2.0]);
    assert!(found.columns.is_empty());
}

#[test]
fn mixed_line_ends_and_odd_spaces_are_read() {
    let found = bytes("2\r\ntitle\nO\t1  2 3 \r\n  H 4 5 6").unwrap();
    assert_eq!(found.positions.get(1).to_array(), [4.0, 5.0, 6.0]);
    assert_eq!(found.column("element").unwrap().data.show(1), "H");
}

#[test]
fn mistakes_have_their_line() {
    for (text, message) in [
        ("3\n\nO 1 2 3\nH 1 2\nH 1 2 3\n", "memory:4: expected 4 values, found 3 (z is missing)"),
        ("2\n\nO 1 2 3\nH 1 two 3\n", "memory:4: expected a finite number for `y`, found `two`"),
        ("2\n\nO 1 2 3\nH 1 nan 3\n", "memory:4: expected a finite number for `y`, found `nan`"),
        ("3\n\nO 1 2 3\n", "memory:4: expected 3 lines with particles, found 1 and the end"),
        ("1\nLattice=\"1 2\"\nO 1 2 3\n", "memory:2: expected nine numbers in `Lattice`"),
        (
            "1152921504606846976\n\nO 1 2 3\n",
            "memory:4: expected 1152921504606846976 lines with particles, found 1 and the end",
        ),
        (
            "1\n\nO 1 2 3\nsecond\n\n",
            "memory:4: expected the number of atoms of another frame, or the",
        ),
    ] {
        let found = match text.ends_with("second\n\n") {
            true => {
                read_bytes("memory".as_ref(), text.as_bytes(), &frame(1)).unwrap_err().to_string()
            }
            false => error(text),
        };
        assert!(found.starts_with(message), "{found}");
    }
}

/// A comment that is missing takes the first atom; the number of those that are left tells it, or
/// a note.
#[test]
fn a_missing_comment_is_told() {
    let told = "line 2 looks like an atom and is read as the comment";
    let frame = "2\nO 1 2 3\nH 1 2 3\n";
    for text in [frame.to_owned(), frame.repeat(2), frame.replace('O', "6")] {
        let error = bytes(&text).unwrap_err();
        assert!(error.to_string().starts_with("memory:"), "{error}");
        assert!(error.help().is_some_and(|help| help.starts_with(told)), "{text}");
    }
    let found = bytes("1\nO 1 2 3\nH 1 2 3\n").unwrap();
    assert!(found.notes[0].starts_with(told), "{:?}", found.notes);
    for comment in ["", "title", "O 1 2", "step 1 2 3", "1 2 3"] {
        let found = bytes(format!("1\n{comment}\nH 1 2 3\n")).unwrap();
        assert_eq!(found.notes, [""; 0], "{comment}");
    }
}

/// A million rows are read by several threads in pieces, in order.
#[test]
fn long_files_are_read_in_order() {
    use std::fmt::Write;
    let count = 400_000;
    let mut text = format!("{count}\nProperties=species:S:1:pos:R:3:id:I:1\n");
    for row in 0..count {
        let word = if row % 1000 == 999 { "Au" } else { "C" };
        writeln!(text, "{word} {row} {}.25 -{row}e-1 {row}", row / 2).unwrap();
    }
    let found = bytes(&text).unwrap();
    assert_eq!(found.len(), count);
    let ids = found.column("id").unwrap();
    for row in 0..count {
        let x = row as f64;
        let expected = [x, (row / 2) as f64 + 0.25, -(format!("{row}e-1").parse::<f64>().unwrap())];
        assert_eq!(found.positions.get(row).to_array(), expected, "{row}");
        assert_eq!(ids.number(row), x);
    }
    let species = found.column("species").unwrap();
    assert_eq!((species.data.show(998), species.data.show(999)), ("C".into(), "Au".into()));
    // A mistake far inside has its line.
    let wrong = text.replacen("\nC 350000 ", "\nC x ", 1);
    assert!(error(wrong).starts_with("memory:350003: expected a finite number for `x`"));
    let one = ReadRequest { columns: Wanted::Only(vec![]), ..ReadRequest::default() };
    assert!(read_bytes("a".as_ref(), text.as_bytes(), &one).unwrap().columns.is_empty());
}
