//! Compressed files.

use photosphere::particles::{ReadRequest, read, read_bytes, survey};

use super::kit::{check, error, fixture, frame};

#[test]
fn packed_files_are_read_like_plain_ones() {
    check("packed", 16);
    let told = |name: &str| survey(&fixture(name), &frame(0)).unwrap().compression;
    assert_eq!(told("packed/comma.csv.gz"), Some("gzip"));
    assert_eq!(told("packed/comma.csv.zst"), Some("zstd"));
    assert_eq!(told("table/comma.csv"), None);
}

#[test]
fn truncated_and_damaged_ones_are_refused() {
    for name in ["packed/comma.csv.gz", "packed/comma.csv.zst"] {
        let whole = std::fs::read(fixture(name)).unwrap();
        let rows = read(&fixture(name), &frame(0)).unwrap().len();
        for end in 1..whole.len() {
            // Between two members the text itself ends within a row.
            match read_bytes("memory".as_ref(), &whole[..end], &ReadRequest::default()) {
                Ok(found) => assert!(found.len() < rows, "{name} {end}"),
                Err(error) => assert!(!error.to_string().is_empty()),
            }
        }
    }
    let mut damaged = std::fs::read(fixture("packed/little.ply.gz")).unwrap();
    let at = damaged.len() - 20;
    damaged[at] ^= 0x55;
    assert!(!error(damaged).is_empty());
}

/// A small file that becomes a large one is read as far as the limit goes.
#[test]
fn bombs_do_not_go_off() {
    use std::io::Write;
    let mut text = b"x,y,z\n".to_vec();
    text.extend(b"1,2,3\n".repeat(3_000_000));
    let mut packer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    packer.write_all(&text).unwrap();
    let packed = packer.finish().unwrap();
    assert!(packed.len() < text.len() / 50);
    let request = ReadRequest { memory_limit: Some(16 << 20), ..ReadRequest::default() };
    let told = read_bytes("memory".as_ref(), &packed, &request).unwrap_err().to_string();
    assert_eq!(told, "memory: its particles do not fit into 16 MiB of memory");
    let mut bytes =
        b"\x93NUMPY\x01\x00\x40\x00{'descr': '<f8', 'fortran_order': False, 'shape': (9000000, 3)}"
            .to_vec();
    bytes.resize(10 + 64, b' ');
    bytes.resize(40 << 20, 0);
    let mut packer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    packer.write_all(&bytes).unwrap();
    let packed = packer.finish().unwrap();
    let told = read_bytes("memory".as_ref(), &packed, &request).unwrap_err().to_string();
    assert_eq!(told, "memory: its particles do not fit into 16 MiB of memory");
}
