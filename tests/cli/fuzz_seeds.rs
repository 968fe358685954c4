//! The inputs in `fuzz/seeds`, seeds of the fuzzers and what once was a finding, do no harm.

#[path = "../../fuzz/src/targets/mod.rs"]
mod targets;

use std::collections::BTreeSet;
use std::fs;
use std::path::PathBuf;

use targets::TARGETS;

fn folder(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("fuzz/seeds").join(name)
}

fn names(folder: PathBuf) -> BTreeSet<String> {
    let entries = fs::read_dir(&folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    entries.map(|entry| entry.expect("readable").file_name().into_string().expect("text")).collect()
}

/// Takes the inputs of one target. A name that begins with `bad-` is that of an input that is
/// refused, and one that begins with `past-` of a former finding; all others are accepted, so that
/// no seed loses its use unnoticed.
#[allow(clippy::print_stdout, reason = "a panic names no seed")]
fn replay(name: &str) {
    let seeds = names(folder(name));
    assert!(seeds.iter().any(|seed| !seed.starts_with("past-")), "{name} has no seeds");
    for seed in seeds {
        let input = fs::read(folder(name).join(&seed)).expect("readable");
        println!("{name}/{seed}");
        let is_accepted = targets::run(name, &input);
        if !seed.starts_with("past-") {
            assert_eq!(is_accepted, !seed.starts_with("bad-"), "{name}/{seed}");
        }
    }
}

#[test]
fn every_target_has_a_folder_and_a_program() {
    let targets: BTreeSet<String> = TARGETS.iter().map(|target| target.name.to_owned()).collect();
    assert_eq!(names(folder("")), targets);
    let programs = names(folder("../src/bin"));
    assert_eq!(programs, targets.iter().map(|name| format!("{name}.rs")).collect());
}

macro_rules! replays {
    ($($name:ident)*) => {
        $(#[test]
        fn $name() {
            replay(stringify!($name));
        })*

        #[test]
        fn every_target_is_replayed() {
            let replayed = [$(stringify!($name)),*];
            assert_eq!(TARGETS.map(|target| target.name), replayed);
        }
    };
}

replays! {
    scene
    overrides
    render
    table_rows
    table_npy
    checkpoint
    checkpoint_shaped
    picture
    environment
    metadata
    arguments
    viewer
    particles_npy
    particles_npz
    particles_csv
    particles_table
    particles_xyz
    particles_lammps_dump
    particles_lammps_data
    particles_pdb
    particles_mmcif
    particles_gro
    particles_poscar
    particles_ply
    particles_gsd
    particles_vtk_xml
    particles_vtk_legacy
    particles_xtc
    particles_any
}
