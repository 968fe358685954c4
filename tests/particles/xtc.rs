//! GROMACS XTC.

use photosphere::particles::{ReadRequest, read};

use super::kit::{check, error, fixture, frame};

#[test]
fn files_of_mdanalysis_are_read_to_the_bit() {
    check("xtc", 5);
}

#[test]
fn names_are_those_of_the_topology() {
    let path = fixture("xtc/mda.xtc");
    let topology = Some(fixture("xtc/mda.gro"));
    let with = ReadRequest { topology, ..frame(-1) };
    let found = read(&path, &with).unwrap();
    assert_eq!((found.frame, found.time), (2, Some(3.0)));
    assert_eq!(found.column("resname").unwrap().data.show(0), "SOL");
    assert!(read(&path, &frame(0)).unwrap().columns.is_empty());
    let other = ReadRequest { topology: Some(fixture("xyz/plain.xyz")), ..frame(0) };
    let told = read(&path, &other).unwrap_err().to_string();
    assert!(told.contains("it has 12 atoms, but"), "{told}");
}

#[test]
fn promises_are_not_believed() {
    let mut bytes = std::fs::read(fixture("xtc/many.xtc")).unwrap();
    for at in [4, 52] {
        bytes[at..at + 4].copy_from_slice(&u32::MAX.to_be_bytes());
    }
    let found = error(bytes);
    assert!(found.contains("4294967295 atoms are promised in"), "{found}");
}
