//! Whatever the bytes are, they are read or refused: the body that the fuzzers run, on random
//! changes of the fixtures of each format.

#[path = "../../fuzz/src/targets/particles.rs"]
#[allow(dead_code, reason = "the fuzzers use the other functions")]
mod target;

use photosphere::particles::Format;
use proptest::prelude::*;

use super::kit::fixture;

/// A change of a file.
#[derive(Clone, Debug)]
enum Change {
    /// Other bytes at a place.
    Replace(prop::sample::Index, Vec<u8>),
    /// More bytes at a place.
    Insert(prop::sample::Index, Vec<u8>),
    /// Fewer bytes from a place on.
    Remove(prop::sample::Index, usize),
    /// A part of the file once more, somewhere else.
    Repeat(prop::sample::Index, prop::sample::Index, usize),
}

fn bytes() -> impl Strategy<Value = Vec<u8>> {
    let odd = prop::sample::select(vec![
        &b"nan"[..],
        b"1e999",
        b"\r\n",
        b"\n\n",
        b"-1",
        b"18446744073709551615",
        b"1152921504606846976",
        b"\xff\xff\xff\xff",
        b"\0\0\0\0\0\0\0\x10",
        b"\"",
        b" ",
        b"<",
    ]);
    prop_oneof![odd.prop_map(<[u8]>::to_vec), prop::collection::vec(any::<u8>(), 1..9),]
}

fn change() -> impl Strategy<Value = Change> {
    let index = || any::<prop::sample::Index>();
    prop_oneof![
        (index(), bytes()).prop_map(|(at, with)| Change::Replace(at, with)),
        (index(), bytes()).prop_map(|(at, more)| Change::Insert(at, more)),
        (index(), 1..200usize).prop_map(|(at, count)| Change::Remove(at, count)),
        (index(), index(), 1..200usize).prop_map(|(at, to, count)| Change::Repeat(at, to, count)),
    ]
}

fn apply(file: &mut Vec<u8>, change: Change) {
    if file.is_empty() {
        return;
    }
    let len = file.len();
    match change {
        Change::Replace(at, with) => {
            let at = at.index(len);
            let end = (at + with.len()).min(len);
            file.splice(at..end, with);
        }
        Change::Insert(at, more) => {
            let at = at.index(len);
            file.splice(at..at, more);
        }
        Change::Remove(at, count) => {
            let at = at.index(len);
            file.drain(at..(at + count).min(len));
        }
        Change::Repeat(at, to, count) => {
            let at = at.index(len);
            let part = file[at..(at + count).min(len)].to_vec();
            let to = to.index(len);
            file.splice(to..to, part);
        }
    }
}

/// Reads random changes of these files as their format and as what they look like.
fn changed(format: Format, files: &[&str], cases: u32) {
    let seeds: Vec<Vec<u8>> =
        files.iter().map(|name| std::fs::read(fixture(name)).expect("a fixture")).collect();
    for seed in &seeds {
        assert!(target::read(Some(format), seed) && target::read(None, seed));
    }
    let config = ProptestConfig { cases, failure_persistence: None, ..ProptestConfig::default() };
    let seeds = prop::sample::select(seeds);
    let changes = prop::collection::vec(change(), 1..5);
    proptest!(config, |(seed in seeds, changes in changes, is_known in any::<bool>())| {
        let mut file = seed;
        for change in changes {
            apply(&mut file, change);
        }
        target::read(is_known.then_some(format), &file);
    });
}

macro_rules! readers {
    ($($name:ident: $format:ident [$($file:literal),+];)+) => {
        $(#[test]
        fn $name() {
            changed(Format::$format, &[$($file),+], 200);
        })+
    };
}

readers! {
    npy: Npy ["numpy/five.npy", "numpy/fortran.npy", "numpy/records.npy", "numpy/frames.npy"];
    npz: Npz ["numpy/stored.npz", "numpy/deflated.npz", "numpy/axes.npz"];
    csv: Csv ["table/comma.csv", "table/semicolon.csv", "table/tab.tsv"];
    table: Table ["table/savetxt.txt", "table/cloud.xyz", "table/cloud.pts"];
    xyz: Xyz ["xyz/plain.xyz", "xyz/extended.xyz", "xyz/ovito.xyz"];
    lammps_dump: LammpsDump ["lammps/ovito.dump"];
    lammps_data: LammpsData ["lammps/full.data", "lammps/ovito.data"];
    pdb: Pdb ["pdb/gemmi.pdb", "pdb/mda.pdb"];
    mmcif: Mmcif ["mmcif/gemmi.cif"];
    gro: Gro ["gro/mda.gro"];
    poscar: Poscar ["poscar/direct.vasp", "poscar/XDATCAR"];
    ply: Ply ["ply/text.ply", "ply/little.ply", "ply/big.ply", "ply/splats.ply"];
    gsd: Gsd ["gsd/three.gsd"];
    vtp: Vtp ["vtk/ascii.vtp", "vtk/appended-raw.vtp", "vtk/zlib-inline-64.vtp", "vtk/zlib.vtp"];
    vtu: Vtu ["vtk/appended-raw.vtu", "vtk/zlib.vtu", "vtk/meshio.vtu"];
    vtk: Vtk ["vtk/poly-binary-51.vtk", "vtk/grid-binary-42.vtk", "vtk/grid-text-51.vtk"];
    xtc: Xtc ["xtc/mda.xtc", "xtc/few.xtc", "xtc/many.xtc"];
}
