//! Particle files. A file that is read has as many values in each column as it has particles, all
//! positions are finite, and a survey agrees; one that is not read has a message.

use std::path::Path;

use photosphere::Error;
use photosphere::particles::{Format, Particles, ReadRequest, read_bytes, survey_bytes};

/// Bytes that a reader may take, more than any input of a fuzzer needs.
const MEMORY: u64 = 256 << 20;

/// Reads bytes as a format, or as what they look like. Returns true if they are accepted.
pub(crate) fn read(format: Option<Format>, input: &[u8]) -> bool {
    let request = ReadRequest { format, memory_limit: Some(MEMORY), ..ReadRequest::default() };
    let name = Path::new("input");
    let survey = survey_bytes(name, input, &request);
    if let Err(error) = &survey {
        told(error);
    }
    match read_bytes(name, input, &request) {
        Ok(particles) => {
            check(&particles);
            let survey = survey.expect("what is read can be surveyed");
            let count = particles.len() as u64;
            // Alternate locations are left out.
            assert!(survey.count.is_none_or(|told| told == count));
            true
        }
        Err(error) => {
            told(&error);
            false
        }
    }
}

/// A message names the file, is short, and does nothing to a terminal.
fn told(error: &Error) {
    let text = error.to_string();
    assert!(text.contains("input") && text.len() < 2000, "{text:?}");
    assert!(!text.contains(char::is_control), "{text:?}");
}

fn check(particles: &Particles) {
    let rows = particles.len();
    for row in 0..rows {
        assert!(particles.positions.get(row).is_finite());
    }
    for column in &particles.columns {
        assert_eq!(column.data.len(), rows, "{}", column.name);
        if rows > 0 {
            column.data.show(rows - 1);
        }
        if let Some([low, high]) = column.range() {
            assert!(low <= high);
        }
    }
}

macro_rules! targets {
    ($($name:ident: $format:expr,)+) => {
        $(pub(crate) fn $name(input: &[u8]) -> bool {
            read($format, input)
        })+
    };
}

targets! {
    npy: Some(Format::Npy),
    npz: Some(Format::Npz),
    csv: Some(Format::Csv),
    table: Some(Format::Table),
    xyz: Some(Format::Xyz),
    lammps_dump: Some(Format::LammpsDump),
    lammps_data: Some(Format::LammpsData),
    pdb: Some(Format::Pdb),
    mmcif: Some(Format::Mmcif),
    gro: Some(Format::Gro),
    poscar: Some(Format::Poscar),
    ply: Some(Format::Ply),
    gsd: Some(Format::Gsd),
    vtk_xml: Some(Format::Vtp),
    vtk_legacy: Some(Format::Vtk),
    xtc: Some(Format::Xtc),
    any: None,
}
