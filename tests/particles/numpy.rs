//! NumPy arrays and archives.

use super::kit::{bytes, check, error};

#[test]
fn files_of_numpy_are_read_to_the_bit() {
    check("numpy", 15);
}

fn array(header: &str, data: &[u8]) -> Vec<u8> {
    let length = (header.len() as u16).to_le_bytes();
    [&b"\x93NUMPY\x01\x00"[..], &length, header.as_bytes(), data].concat()
}

#[test]
fn mistakes_are_named() {
    let of = |dtype: &str, shape: &str| {
        let text = format!("{{'descr': {dtype}, 'fortran_order': False, 'shape': {shape}}}");
        error(array(&text, &[0; 24]))
    };
    for (found, message) in [
        (
            of("'<f8'", "(1152921504606846976, 3)"),
            "the file ends too early: 1152921504606846976 rows",
        ),
        (of("'<f8'", "(2, 3)"), "the file ends too early: 2 rows of 24 bytes needs 48 bytes"),
        (of("'<f8'", "(18446744073709551615, 3)"), "the file ends too early"),
        (of("'|O'", "(1, 3)"), "its array has the type `|O`, which is not a number"),
        (of("'<f8'", "(3,)"), "its array has the shape (3)"),
        (of("'<f8'", "(1, 2)"), "its array has the shape (1, 2)"),
        (of("[('a', '<f8')]", "(1,)"), "there are no columns x, y and z among `a`"),
        (error(array("{}", &[])), "whose header does not give `descr`"),
    ] {
        assert!(found.contains(message), "{found}");
    }
    let nan = [1.0f64, f64::NAN, 0.0].map(f64::to_le_bytes).concat();
    let text = "{'descr': '<f8', 'fortran_order': False, 'shape': (1, 3)}";
    let found = error(array(text, &nan));
    assert!(found.contains("row 0 (the first is 0) is at (1.0, NaN, 0.0)"), "{found}");
}

#[test]
fn no_rows_are_no_particles() {
    let text = "{'descr': '<f4', 'fortran_order': False, 'shape': (0, 3)}";
    assert!(bytes(array(text, &[])).unwrap().is_empty());
}

#[test]
fn archives_need_positions() {
    // An end of the archive without its parts.
    let empty = [&b"PK\x05\x06"[..], &[0; 18]].concat();
    assert!(error(empty).contains("no array has positions"));
}
