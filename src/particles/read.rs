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
use super::formats::xyz::Xyz;
use super::formats::{lammps_data, mmcif, pdb, ply};
use super::frames;
use super::model::Particles;
use super::request::{ReadRequest, Survey};
use super::source::Source;
use super::trouble::{Outcome, Trouble};

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
        _ => todo(format),
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
        _ => todo(format),
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
        Format::Gro => frames::count(Gro, source),
        Format::Pdb => pdb::count(source),
        Format::Npy => count_npy(&source, request),
        _ => todo(format),
    }
}

/// Refuses frames of a format that has one.
fn only_frame(frame: u64) -> Outcome<()> {
    if frame == 0 {
        return Ok(());
    }
    Err(Trouble::new(format!("it has 1 frame, and no frame {frame} (the first is 0)")).into())
}

fn todo<T>(format: Format) -> Outcome<T> {
    Err(Trouble::new(format!("{} cannot be read yet", format.name())).into())
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
