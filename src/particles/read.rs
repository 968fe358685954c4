//! The ways in: reading, surveying and counting, for all formats.

use std::path::Path;

use crate::error::Result;

use super::detect::detect;
use super::format::Format;
use super::formats::gro::Gro;
use super::formats::lammps_dump::LammpsDump;
use super::formats::npy::{count_npy, read_npy, read_npz, survey_npy, survey_npz};
use super::formats::poscar::Poscar;
use super::formats::table;
use super::formats::vtk::{
    count_pvd, part_of_pvd, read_legacy, read_xml, survey_legacy, survey_xml,
};
use super::formats::xyz::Xyz;
use super::formats::{gsd, lammps_data, mmcif, pdb, ply, xtc};
use super::frames;
use super::model::Particles;
use super::request::{ReadRequest, Survey};
use super::source::Source;
use super::trouble::{Outcome, Trouble, plural};

/// Reads one frame of a file; `-` is standard input.
///
/// # Errors
/// If the file cannot be read, is damaged, lacks a column that is asked for, or does not fit into
/// memory. A message about contents begins with the path and the line, as in `a.xyz:12: ...`.
pub fn read(path: &Path, request: &ReadRequest) -> Result<Particles> {
    read_from(&|| Source::open(path), request).map_err(|failure| failure.into_error(path))
}

/// Reads one frame of a file in memory. `name` stands for it in messages.
///
/// # Errors
/// Like those of [`read`].
pub fn read_bytes(name: &Path, bytes: &[u8], request: &ReadRequest) -> Result<Particles> {
    let open = || Source::from_bytes(name, bytes.to_vec());
    read_from(&open, request).map_err(|failure| failure.into_error(name))
}

/// Tells what is in a file: its format, the columns of a frame, its number of particles and its
/// cell, without reading what the format lets it skip.
///
/// # Errors
/// Like those of [`read`]; standard input cannot be surveyed, because it can be read only once.
pub fn survey(path: &Path, request: &ReadRequest) -> Result<Survey> {
    let outcome = refuse_pipe(path).and_then(|()| survey_from(&|| Source::open(path), request));
    outcome.map_err(|failure| failure.into_error(path))
}

/// Tells what is in a file in memory. `name` stands for it in messages.
///
/// # Errors
/// Like those of [`survey`].
pub fn survey_bytes(name: &Path, bytes: &[u8], request: &ReadRequest) -> Result<Survey> {
    let open = || Source::from_bytes(name, bytes.to_vec());
    survey_from(&open, request).map_err(|failure| failure.into_error(name))
}

/// Counts the frames of a file. Where the format has no index, this reads the whole file.
///
/// # Errors
/// Like those of [`survey`].
pub fn count_frames(path: &Path, request: &ReadRequest) -> Result<u64> {
    let count = |()| {
        let source = Source::open(path)?;
        let format = format_of(&source, request)?;
        count(format, source, request)
    };
    refuse_pipe(path).and_then(count).map_err(|failure| failure.into_error(path))
}

/// Opens what is read; once more for a second pass.
type Opener<'a> = dyn Fn() -> Outcome<Source> + 'a;

fn read_from(open: &Opener<'_>, request: &ReadRequest) -> Outcome<Particles> {
    let source = open()?;
    let format = format_of(&source, request)?;
    let (source, frame) = frame_of(source, format, open, request)?;
    let names = || request.names.clone();
    match format {
        Format::Xyz => frames::read(Xyz { names: names() }, source, frame, request),
        Format::LammpsDump => frames::read(LammpsDump { names: names() }, source, frame, request),
        Format::Csv | Format::Table => {
            only_frame(frame)?;
            let can_reopen = source.path != Path::new("-");
            table::read(source, open, can_reopen, request)
        }
        Format::Poscar => frames::read(Poscar::default(), source, frame, request),
        Format::LammpsData => {
            only_frame(frame)?;
            lammps_data::read(source, request)
        }
        Format::Mmcif => mmcif::read(source, frame, request),
        Format::Gsd => gsd::read(source, frame, request),
        Format::Xtc => with_topology(xtc::read(source, frame, request)?, request),
        Format::Vtp | Format::Vtu => {
            only_frame(frame)?;
            read_xml(source, format, request)
        }
        Format::Vtk => {
            only_frame(frame)?;
            read_legacy(source, request)
        }
        Format::Pvd => {
            let (path, time) = part_of_pvd(&source, frame)?;
            let particles = read(&path, &part_request(&path, request)?)?;
            Ok(Particles { time: time.or(particles.time), frame, ..particles })
        }
        Format::Gro => frames::read(Gro, source, frame, request),
        Format::Pdb => pdb::read(source, frame, request),
        Format::Ply => {
            only_frame(frame)?;
            ply::read(source, request)
        }
        Format::Npy => read_npy(source, frame, request),
        Format::Npz => {
            only_frame(frame)?;
            read_npz(source, request)
        }
    }
}

fn survey_from(open: &Opener<'_>, request: &ReadRequest) -> Outcome<Survey> {
    let source = open()?;
    let format = format_of(&source, request)?;
    let (source, frame) = frame_of(source, format, open, request)?;
    let names = || request.names.clone();
    match format {
        Format::Xyz => frames::survey(Xyz { names: names() }, source, frame),
        Format::LammpsDump => frames::survey(LammpsDump { names: names() }, source, frame),
        Format::Csv | Format::Table => {
            only_frame(frame)?;
            table::survey(&source, request)
        }
        Format::Poscar => frames::survey(Poscar::default(), source, frame),
        Format::LammpsData => {
            only_frame(frame)?;
            lammps_data::survey(source, request)
        }
        Format::Mmcif => mmcif::survey(source),
        Format::Gsd => gsd::survey(source, frame, request),
        Format::Xtc => {
            let survey = xtc::survey(source, frame, request)?;
            let Some(path) = &request.topology else { return Ok(survey) };
            let columns = self::survey(path, &topology_request(request))?.columns;
            Ok(Survey { columns, ..survey })
        }
        Format::Vtp | Format::Vtu => {
            only_frame(frame)?;
            survey_xml(source, format, request)
        }
        Format::Vtk => {
            only_frame(frame)?;
            survey_legacy(source, request)
        }
        Format::Pvd => {
            let (path, time) = part_of_pvd(&source, frame)?;
            let frames = Some(count_pvd(&source)?);
            let survey = survey(&path, &part_request(&path, request)?)?;
            Ok(Survey { time: time.or(survey.time), frames, ..survey })
        }
        Format::Gro => frames::survey(Gro, source, frame),
        Format::Pdb => pdb::survey(source, frame),
        Format::Ply => {
            only_frame(frame)?;
            ply::survey(&source)
        }
        Format::Npy => survey_npy(&source, frame, request),
        Format::Npz => {
            only_frame(frame)?;
            survey_npz(source, request)
        }
    }
}

fn count(format: Format, source: Source, request: &ReadRequest) -> Outcome<u64> {
    let names = || request.names.clone();
    match format {
        Format::Xyz => frames::count(Xyz { names: names() }, source),
        Format::LammpsDump => frames::count(LammpsDump { names: names() }, source),
        Format::Csv | Format::Table | Format::Npz | Format::Ply | Format::LammpsData => Ok(1),
        Format::Poscar => frames::count(Poscar::default(), source),
        Format::Mmcif => mmcif::count(source, request),
        Format::Gsd => gsd::count(source, request),
        Format::Xtc => xtc::count(source, request),
        Format::Pvd => count_pvd(&source),
        Format::Vtp | Format::Vtu | Format::Vtk => Ok(1),
        Format::Gro => frames::count(Gro, source),
        Format::Pdb => pdb::count(source),
        Format::Npy => count_npy(&source, request),
    }
}

/// Refuses frames of a format that has one.
fn only_frame(frame: u64) -> Outcome<()> {
    if frame == 0 {
        return Ok(());
    }
    Err(Trouble::new(format!("it has 1 frame, and no frame {frame} (the first is 0)")).into())
}

/// What is asked of a file that a collection names. It must not be a collection again.
fn part_request(path: &Path, request: &ReadRequest) -> Result<ReadRequest> {
    let format = Source::open(path).and_then(|source| detect(&source));
    let format = format.and_then(|format| match format {
        Format::Vtp | Format::Vtu | Format::Vtk => Ok(Some(format)),
        _ => Err(Trouble::new("expected a VTK file with points").into()),
    });
    let format = format.map_err(|failure| failure.into_error(path))?;
    Ok(ReadRequest { format, frame: 0, ..request.clone() })
}

/// The particles of a trajectory with the columns of its topology.
fn with_topology(mut particles: Particles, request: &ReadRequest) -> Outcome<Particles> {
    let Some(path) = &request.topology else {
        request.columns.check(std::iter::empty())?;
        return Ok(particles);
    };
    let topology = read(path, &topology_request(request))?;
    if topology.len() != particles.len() {
        let (has, expected) = (particles.len() as u64, topology.len());
        let message =
            format!("it has {}, but `{}` has {expected}", plural(has, "atom"), path.display());
        return Err(Trouble::new(message).with_help("name the topology of this trajectory").into());
    }
    particles.columns = topology.columns;
    particles.title = topology.title;
    Ok(particles)
}

/// What is asked of a topology.
fn topology_request(request: &ReadRequest) -> ReadRequest {
    ReadRequest { format: None, frame: 0, topology: None, ..request.clone() }
}

/// The format that the user names, or else the one that the file has.
fn format_of(source: &Source, request: &ReadRequest) -> Outcome<Format> {
    match request.format {
        Some(format) => Ok(format),
        None => detect(source),
    }
}

/// The frame that is asked for. To count from the end, a first pass counts them all.
fn frame_of(
    source: Source,
    format: Format,
    open: &Opener<'_>,
    request: &ReadRequest,
) -> Outcome<(Source, u64)> {
    if let Ok(frame) = u64::try_from(request.frame) {
        return Ok((source, frame));
    }
    refuse_pipe(&source.path)?;
    let frames = count(format, source, request)?;
    let Some(frame) = frames.checked_add_signed(request.frame) else {
        let message = format!("it has {frames} frames, and no frame {}", request.frame);
        return Err(Trouble::new(message).into());
    };
    Ok((open()?, frame))
}

/// Standard input cannot be read twice.
fn refuse_pipe(path: &Path) -> Outcome<()> {
    if path == Path::new("-") {
        let message = "standard input can be read only once: it has no survey, and its frames are \
                       not counted";
        return Err(Trouble::new(message).with_help("write it to a file first").into());
    }
    Ok(())
}
