//! Recognises a format by the beginning of a file.

use super::format::Format;
use super::source::Source;
use super::text::{float, integer, tokens};
use super::trouble::{Outcome, Trouble};

/// Recognises the format.
pub(super) fn detect(source: &Source) -> Outcome<Format> {
    let head = &source.head[..];
    if head.is_empty() {
        return Err(Trouble::new("the file is empty").into());
    }
    if let Some(format) = by_magic(head) {
        return Ok(format);
    }
    let head = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head);
    if head.contains(&0) {
        let names: Vec<&str> = Format::NAMES.iter().map(|(name, _)| *name).collect();
        return Err(Trouble::new("it has no known format")
            .with_help(format!("these can be read: {}", names.join(", ")))
            .into());
    }
    let lines: Vec<&[u8]> = head.split(|&byte| byte == b'\n').take(400).collect();
    let filled = lines.iter().find(|line| !line.trim_ascii().is_empty());
    let Some(first) = filled else {
        return Err(Trouble::new("the file is empty").into());
    };
    Ok(by_text(head, first, &lines))
}

/// Formats that begin with a fixed word or number.
fn by_magic(head: &[u8]) -> Option<Format> {
    let is_xtc = |magic: i32| head.starts_with(&magic.to_be_bytes());
    match head {
        [0x93, b'N', b'U', b'M', b'P', b'Y', ..] => Some(Format::Npy),
        [b'P', b'K', 3 | 5, 4 | 6, ..] => Some(Format::Npz),
        [b'p', b'l', b'y', b'\n' | b'\r', ..] => Some(Format::Ply),
        [0xdf, 0x65, 0xdf, 0x65, 0xdf, 0x65, 0xdf, 0x65, ..] => Some(Format::Gsd),
        _ if is_xtc(1995) || is_xtc(2023) => Some(Format::Xtc),
        _ if head.starts_with(b"# vtk DataFile") => Some(Format::Vtk),
        _ => by_xml(head),
    }
}

fn by_xml(head: &[u8]) -> Option<Format> {
    let start = &head[..head.len().min(4096)];
    let text = String::from_utf8_lossy(start);
    let (_, tag) = text.split_once("<VTKFile")?;
    let tag = tag.split('>').next()?.replace('\'', "\"");
    [("PolyData", Format::Vtp), ("UnstructuredGrid", Format::Vtu), ("Collection", Format::Pvd)]
        .into_iter()
        .find(|(name, _)| tag.contains(&format!("type=\"{name}\"")))
        .map(|(_, format)| format)
}

fn by_text(head: &[u8], first: &[u8], lines: &[&[u8]]) -> Format {
    if first.starts_with(b"ITEM: ") {
        return Format::LammpsDump;
    }
    if first.starts_with(b"data_") || (first.starts_with(b"#") && has(head, b"\n_atom_site.")) {
        return Format::Mmcif;
    }
    if is_pdb(first) {
        return Format::Pdb;
    }
    if is_lammps_data(lines) {
        return Format::LammpsData;
    }
    if is_gro(lines) {
        return Format::Gro;
    }
    if is_xyz(lines) {
        return Format::Xyz;
    }
    if is_poscar(lines) {
        return Format::Poscar;
    }
    if is_delimited(lines) { Format::Csv } else { Format::Table }
}

fn has(text: &[u8], part: &[u8]) -> bool {
    memchr::memmem::find(text, part).is_some()
}

/// Names of records at the beginning of PDB files.
const PDB_RECORDS: [&str; 22] = [
    "HEADER", "TITLE ", "COMPND", "SOURCE", "KEYWDS", "EXPDTA", "AUTHOR", "REVDAT", "JRNL  ",
    "REMARK", "CRYST1", "ORIGX1", "SCALE1", "MODEL ", "ATOM  ", "HETATM", "SEQRES", "HELIX ",
    "SHEET ", "SSBOND", "NUMMDL", "OBSLTE",
];

fn is_pdb(first: &[u8]) -> bool {
    let name = first.get(..6).map(<[u8]>::to_vec).unwrap_or_else(|| {
        let mut name = first.trim_ascii_end().to_vec();
        name.resize(6, b' ');
        name
    });
    PDB_RECORDS.iter().any(|record| record.as_bytes() == name) && first.len() > 6
}

fn is_lammps_data(lines: &[&[u8]]) -> bool {
    let has_words = |words: &[&[u8]]| {
        lines.iter().any(|line| {
            let found: Vec<&[u8]> =
                tokens(line.split(|&b| b == b'#').next().unwrap_or_default()).collect();
            found.len() >= words.len()
                && found[found.len() - words.len()..] == *words
                && found[..found.len() - words.len()].iter().all(|token| float(token).is_some())
        })
    };
    has_words(&[b"atoms"])
        && (has_words(&[b"xlo", b"xhi"])
            || has_words(&[b"avec"])
            || has_words(&[b"atom", b"types"]))
}

fn count_of(line: &[u8]) -> Option<i64> {
    let mut tokens = tokens(line);
    let count = integer(tokens.next()?)?;
    (tokens.next().is_none() && count >= 0).then_some(count)
}

/// A title, the number of atoms, and atoms in columns of fixed width.
fn is_gro(lines: &[&[u8]]) -> bool {
    let [_, count, atom, ..] = lines else { return false };
    let atom = atom.trim_ascii_end();
    match count_of(count) {
        Some(0) => tokens(atom).filter_map(float).count() >= 3,
        Some(_) => {
            let has_number = |range: std::ops::Range<usize>| {
                atom.get(range).is_some_and(|part| integer(part.trim_ascii()).is_some())
            };
            let points = atom.iter().skip(20).filter(|&&byte| byte == b'.').count();
            has_number(0..5) && has_number(15..20) && points >= 3
        }
        None => false,
    }
}

/// The number of atoms, a comment, and atoms with at least three coordinates.
fn is_xyz(lines: &[&[u8]]) -> bool {
    let [count, comment, atom, ..] = lines else { return false };
    let Some(count) = count_of(count) else { return false };
    if count == 0 {
        return true;
    }
    let numbers = |line: &[u8]| tokens(line).filter(|token| float(token).is_some()).count();
    let values = |line: &[u8]| tokens(line).count();
    // Below a count, a point cloud has points at once.
    let is_cloud = |line: &[u8]| values(line) >= 3 && numbers(line) == values(line);
    let are_points = is_cloud(comment) && is_cloud(atom) && values(comment) == values(atom);
    !are_points && numbers(atom) >= 3
}

/// A comment, a scale, and three vectors.
fn is_poscar(lines: &[&[u8]]) -> bool {
    let [_, scale, a, b, c, _, _, ..] = lines else { return false };
    let numbers = |line: &[u8]| -> Option<Vec<f64>> { tokens(line).map(float).collect() };
    let is_vector = |line: &&[u8]| numbers(line).is_some_and(|numbers| numbers.len() == 3);
    let is_scale = numbers(scale).is_some_and(|numbers| numbers.len() == 1);
    is_scale && [a, b, c].into_iter().all(is_vector)
}

/// Values separated by commas, semicolons, tabs or bars.
fn is_delimited(lines: &[&[u8]]) -> bool {
    let is_filled = |line: &&&[u8]| !matches!(line.trim_ascii().first(), None | Some(b'#'));
    let line = lines.iter().find(is_filled);
    line.is_some_and(|line| line.iter().any(|byte| b",;\t|".contains(byte)))
}
