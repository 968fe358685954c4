//! Readers of particle files, in bytes per second beside a plain copy of the file:
//!
//!     cargo bench --bench particles
//!     cargo bench --bench particles -- xyz
//!
//! The files are made in a temporary folder and are in the page cache when they are read.

use std::fmt::Write;
use std::fs;
use std::hint::black_box;
use std::path::{Path, PathBuf};

use criterion::{Criterion, Throughput};
use photosphere::particles::{ReadRequest, read};

/// Particles of a file.
const ROWS: usize = 500_000;

/// A number of a row, the same in every run.
fn number(row: usize, column: usize) -> f64 {
    let bits = (row * 7 + column) as u64;
    let mixed = bits.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 11;
    mixed as f64 / (1u64 << 53) as f64 * 200.0 - 100.0
}

fn xyz() -> Vec<u8> {
    let mut text = format!("{ROWS}\nProperties=species:S:1:pos:R:3:c_pe:R:1\n");
    for row in 0..ROWS {
        let [x, y, z, e] = [0, 1, 2, 3].map(|column| number(row, column));
        let element = ["O", "H", "Si"][row % 3];
        let _ = writeln!(text, "{element} {x:.8} {y:.8} {z:.8} {e:.6}");
    }
    text.into_bytes()
}

fn csv() -> Vec<u8> {
    let mut text = "id,x,y,z,c_pe\n".to_owned();
    for row in 0..ROWS {
        let [x, y, z, e] = [0, 1, 2, 3].map(|column| number(row, column));
        let _ = writeln!(text, "{row},{x},{y},{z},{e}");
    }
    text.into_bytes()
}

fn lammps() -> Vec<u8> {
    let mut text = format!(
        "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n{ROWS}\nITEM: BOX BOUNDS pp pp pp\n-100 100\n-100 \
         100\n-100 100\nITEM: ATOMS id type x y z c_pe\n"
    );
    for row in 0..ROWS {
        let [x, y, z, e] = [0, 1, 2, 3].map(|column| number(row, column));
        let _ = writeln!(text, "{row} {} {x:.6} {y:.6} {z:.6} {e:.5}", 1 + row % 3);
    }
    text.into_bytes()
}

fn npy() -> Vec<u8> {
    let header = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({}, 4)}}", 8 * ROWS);
    let length = (header.len() as u16).to_le_bytes();
    let mut bytes = [&b"\x93NUMPY\x01\x00"[..], &length, header.as_bytes()].concat();
    for row in 0..8 * ROWS {
        bytes.extend([0, 1, 2, 3].map(|c| (number(row, c) as f32).to_le_bytes()).concat());
    }
    bytes
}

fn ply() -> Vec<u8> {
    let mut bytes = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float \
         y\nproperty float z\nproperty uchar red\nproperty uchar green\nproperty uchar \
         blue\nend_header\n",
        8 * ROWS
    )
    .into_bytes();
    for row in 0..8 * ROWS {
        bytes.extend([0, 1, 2].map(|c| (number(row, c) as f32).to_le_bytes()).concat());
        bytes.extend([row as u8, (row >> 8) as u8, (row >> 16) as u8]);
    }
    bytes
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    use std::io::Write;
    let mut packer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    packer.write_all(bytes).expect("memory can be written");
    packer.finish().expect("memory can be written")
}

/// Measures a file with all columns, with positions alone, and a copy into memory.
fn measure(criterion: &mut Criterion, folder: &Path, name: &str, bytes: &[u8], size: usize) {
    let path: PathBuf = folder.join(name);
    fs::write(&path, bytes).expect("the file can be written");
    let mut group = criterion.benchmark_group(format!("particles {name}"));
    group.throughput(Throughput::Bytes(size as u64)).sample_size(10);
    let all = ReadRequest::default();
    group.bench_function("all columns", |b| b.iter(|| black_box(read(&path, &all)).is_ok()));
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    group.bench_function("one thread", |b| {
        b.iter(|| one.install(|| black_box(read(&path, &all)).is_ok()));
    });
    group.bench_function("copy", |b| b.iter(|| black_box(fs::read(&path)).is_ok()));
    group.finish();
}

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let files = [
        ("a.xyz", xyz()),
        ("a.csv", csv()),
        ("a.dump", lammps()),
        ("a.npy", npy()),
        ("a.ply", ply()),
    ];
    for (name, bytes) in files {
        measure(&mut criterion, folder.path(), name, &bytes, bytes.len());
    }
    let text = xyz();
    measure(&mut criterion, folder.path(), "a.xyz.gz", &gzip(&text), text.len());
    criterion.final_summary();
}
