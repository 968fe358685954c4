//! PDBx/mmCIF.

use photosphere::particles::Role;

use super::kit::{bytes, check, error};

#[test]
fn files_of_gemmi_are_read_as_it_reads_them() {
    check("mmcif", 2);
}

const LOOP: &str = "data_x\n_cell.length_a 10\n_cell.length_b 11\n_cell.length_c 12\n#\nloop_\n\
                    _atom_site.label_atom_id\n_atom_site.Cartn_z\n_atom_site.Cartn_x\n\
                    _atom_site.type_symbol\n_atom_site.Cartn_y\n_atom_site.occupancy\n";

#[test]
fn columns_have_any_order_and_quotes() {
    let found = bytes(format!("{LOOP}\"O5'\" 3 1 O 2 1.0\n'a b' 6 4 C 5 ?\n#\nloop_\n")).unwrap();
    let shown = |row| found.column("label_atom_id").unwrap().data.show(row);
    assert_eq!((shown(0), shown(1)), ("O5'".into(), "a b".into()));
    assert_eq!(found.positions.get(1).to_array(), [4.0, 5.0, 6.0]);
    assert_eq!(found.role(Role::Element).unwrap().data.show(1), "C");
    assert!(found.column("occupancy").unwrap().number(1).is_nan());
    assert_eq!(found.cell.unwrap().vectors[1].y, 11.0);
}

#[test]
fn mistakes_have_their_line() {
    for (text, message) in [
        (
            format!("{LOOP}O 3 1 O 2\n#\n"),
            "memory:13: expected 6 values, found 5 (occupancy is missing)",
        ),
        (format!("{LOOP}O 3 1 O ? 1\n#\n"), "memory:13: expected a finite number for `Cartn_y`"),
        ("data_x\n#\n".to_owned(), "memory: it has no loop with `_atom_site.` columns"),
        (
            "data_x\nloop_\n_atom_site_label\nC1\n".to_owned(),
            "memory: it is a CIF file of a small molecule",
        ),
        (LOOP.replace("Cartn_y", "y") + "O 1 2 C 3 1\n", "memory: expected `_atom_site.Cartn_x`"),
    ] {
        let found = error(text);
        assert!(found.starts_with(message), "{found}");
    }
}
