//! Reads archives of NumPy arrays (`.npz`): one array with the positions, or three with x, y and z,
//! and columns in arrays of the same length.

use std::io::{self, Read};

use zip::ZipArchive;
use zip::result::ZipError;

use crate::particles::binary::{Data, DataReader, Slot, Slots, named, read_plan};
use crate::particles::budget::Budget;
use crate::particles::column::component_name;
use crate::particles::format::Format;
use crate::particles::formats::table::axis_of;
use crate::particles::model::{Particles, Positions};
use crate::particles::request::{ColumnInfo, ColumnKind, ReadRequest, Survey, Wanted};
use crate::particles::source::Source;
use crate::particles::trouble::{Failure, Outcome, Trouble, plural};

use super::array::{is_position, number};
use super::header::{Dtype, NpyHeader, read_header};

/// The most arrays that an archive may have.
const MAX_ARRAYS: usize = 4096;

/// An array of an archive.
struct Member {
    /// Index in the archive.
    index: usize,
    name: String,
    header: NpyHeader,
    rows: u64,
    /// Numbers in a row.
    width: u64,
}

/// The arrays that make particles.
struct Contents {
    rows: u64,
    /// One member with three columns, or three with one.
    positions: Vec<usize>,
    members: Vec<Member>,
}

/// Reads an archive.
pub(in crate::particles) fn read_npz(source: Source, request: &ReadRequest) -> Outcome<Particles> {
    let path = source.path.clone();
    let budget = Budget::new(request.memory_limit);
    let data = Data::new(source, budget)?;
    let mut archive = open(&data)?;
    let contents = contents(&data, &mut archive)?;
    let infos = contents.infos();
    request.columns.check(infos.iter().map(|info| &*info.name))?;
    let mut axes = Vec::new();
    for &at in &contents.positions {
        let array = load(&data, &mut archive, &contents.members[at], budget)?;
        axes.push((array, &contents.members[at]));
    }
    let positions = positions(&axes, contents.rows, budget)?;
    drop(axes);
    let mut columns = Vec::new();
    for (at, member) in contents.members.iter().enumerate() {
        let names = member.names();
        let is_wanted = names.iter().any(|name| request.columns.has(name));
        if contents.positions.contains(&at) || !is_wanted {
            continue;
        }
        let array = load(&data, &mut archive, member, budget)?;
        let (slots, rows) = (member.slots(&names, &[])?, contents.rows);
        let mut wanted = names;
        wanted.retain(|name| request.columns.has(name));
        let (plan, names) = slots.plan(rows, &Wanted::Only(wanted))?;
        let (_, values) = read_plan(&array, &plan, budget)?;
        columns.extend(named(names, values));
    }
    Ok(Particles { columns, ..Particles::new(path, Format::Npz, positions) })
}

/// Tells what is in an archive.
pub(in crate::particles) fn survey_npz(source: Source, request: &ReadRequest) -> Outcome<Survey> {
    let mut survey = Survey::new(&source, Format::Npz);
    let data = Data::new(source, Budget::new(request.memory_limit))?;
    let mut archive = open(&data)?;
    let contents = contents(&data, &mut archive)?;
    survey.frames = Some(1);
    survey.count = Some(contents.rows);
    survey.columns = contents.infos();
    let mut positions = contents.positions.iter().map(|&at| &contents.members[at]);
    let fits = positions.all(|member| member.number().is_some_and(|n| n.kind.fits_f32()));
    survey.position_bytes = if fits { 12 } else { 24 };
    Ok(survey)
}

fn open(data: &Data) -> Outcome<ZipArchive<DataReader>> {
    let reader = data.reader().map_err(|error| data.failure(error))?;
    ZipArchive::new(reader).map_err(|error| damaged(data, error))
}

fn damaged(data: &Data, error: ZipError) -> Failure {
    match error {
        ZipError::Io(error) if error.kind() == io::ErrorKind::UnexpectedEof => data.failure(error),
        other => Trouble::new(format!("the archive is damaged: {other}")).into(),
    }
}

impl Member {
    fn number(&self) -> Option<crate::particles::binary::Number> {
        match &self.header.dtype {
            Dtype::Simple(dtype) => number(dtype),
            Dtype::Record(_) => None,
        }
    }

    /// The names of its columns.
    fn names(&self) -> Vec<String> {
        let width = self.width as usize;
        (0..width).map(|at| component_name(&self.name, at, width)).collect()
    }

    /// The columns; `axes` are the coordinates among them.
    fn slots(&self, names: &[String], axes: &[usize]) -> Outcome<Slots> {
        let Some(number) = self.number() else {
            return Err(Trouble::new(format!("the array `{}` has no numbers", self.name)).into());
        };
        let (start, size) = (self.header.data_start, number.kind.bytes());
        let is_apart = self.header.is_column_major;
        let column_bytes = self.rows.saturating_mul(size);
        let groups = match is_apart {
            true => {
                (0..self.width).map(|at| (start + at.saturating_mul(column_bytes), size)).collect()
            }
            false => vec![(start, self.width * size)],
        };
        let slot = |(at, name): (usize, &String)| Slot {
            name: name.clone(),
            number,
            group: if is_apart { at } else { 0 },
            offset: if is_apart { 0 } else { at as u64 * size },
            axis: axes.get(at).copied(),
        };
        Ok(Slots { groups, slots: names.iter().enumerate().map(slot).collect() })
    }
}

impl Contents {
    fn infos(&self) -> Vec<ColumnInfo> {
        let columns = self.members.iter().enumerate();
        let columns = columns.filter(|(at, _)| !self.positions.contains(at));
        let info = |(_, member): (usize, &Member)| {
            let is_float = member.number().is_some_and(|number| number.kind.is_float());
            let kind = if is_float { ColumnKind::Float } else { ColumnKind::Integer };
            let names = member.names().into_iter();
            names.map(move |name| ColumnInfo { name, kind, range: None }).collect::<Vec<_>>()
        };
        columns.flat_map(info).collect()
    }
}

/// Finds the arrays that make particles.
fn contents(data: &Data, archive: &mut ZipArchive<DataReader>) -> Outcome<Contents> {
    if archive.len() > MAX_ARRAYS {
        let message = format!("it has {} files, more than {MAX_ARRAYS}", archive.len());
        return Err(Trouble::new(message).into());
    }
    let mut members = Vec::new();
    for index in 0..archive.len() {
        let file = archive.by_index(index).map_err(|error| damaged(data, error))?;
        let Some(name) = file.name().strip_suffix(".npy").map(str::to_owned) else { continue };
        let header = read_header(file).map_err(|error| data.failure(error))?;
        let Some(Ok(header)) = header else { continue };
        let (rows, width) = match header.shape[..] {
            [rows] => (rows, 1),
            [rows, width @ 1..=4096] => (rows, width),
            _ => continue,
        };
        let member = Member { index, name, header, rows, width };
        if member.number().is_some() {
            members.push(member);
        }
    }
    let Some(positions) = find_positions(&members) else {
        let names: Vec<String> =
            members.iter().map(|member| format!("`{}`", member.name)).collect();
        let message = format!("no array has positions among {}", names.join(", "));
        let help = "expected an array (n, 3) called `positions`, or arrays `x`, `y` and `z`";
        return Err(Trouble::new(message).with_help(help).into());
    };
    let rows = members[positions[0]].rows;
    if let Some(&odd) = positions.iter().find(|&&at| members[at].rows != rows) {
        let (name, has) = (&members[odd].name, plural(members[odd].rows, "row"));
        return Err(Trouble::new(format!("`{name}` has {has}, expected {rows}")).into());
    }
    let mut kept = Vec::new();
    let mut members: Vec<Option<Member>> = members.into_iter().map(Some).collect();
    let mut all: Vec<Member> = Vec::new();
    for at in positions {
        kept.push(all.len());
        all.extend(members[at].take());
    }
    all.extend(members.into_iter().flatten().filter(|member| member.rows == rows));
    Ok(Contents { rows, positions: kept, members: all })
}

/// The array with the positions: by its name, or the only one with three columns; or three arrays.
fn find_positions(members: &[Member]) -> Option<Vec<usize>> {
    let is_wide = |member: &&(usize, &Member)| member.1.width == 3;
    let all: Vec<(usize, &Member)> = members.iter().enumerate().collect();
    let named = all.iter().filter(is_wide).find(|(_, member)| is_position(&member.name));
    if let Some((at, _)) = named {
        return Some(vec![*at]);
    }
    let flat: Vec<(usize, &Member)> =
        all.iter().filter(|(_, member)| member.width == 1).copied().collect();
    let names: Vec<&str> = flat.iter().map(|(_, member)| &*member.name).collect();
    if let Some(places) = axis_of(&names) {
        return Some(places.map(|place| flat[place].0).to_vec());
    }
    let wide: Vec<usize> = all.iter().filter(is_wide).map(|(at, _)| *at).collect();
    (!wide.is_empty()).then(|| vec![wide[0]])
}

/// The bytes of an array: its place in the file if it is stored as it is, or else decompressed.
fn load(
    data: &Data,
    archive: &mut ZipArchive<DataReader>,
    member: &Member,
    budget: Budget,
) -> Outcome<Data> {
    let mut file = archive.by_index(member.index).map_err(|error| damaged(data, error))?;
    if file.compression() == zip::CompressionMethod::Stored && !file.encrypted() {
        if let Some(start) = file.data_start() {
            return data.part(start, file.size(), &format!("the array `{}`", member.name));
        }
    }
    let path = data.path().to_owned();
    let limit = file.size();
    let bytes = Data::collect(&path, Vec::new(), file.by_ref().take(limit), budget)?;
    Ok(Data::from_bytes(path, bytes))
}

/// The positions, from one array with three columns or from three arrays.
fn positions(axes: &[(Data, &Member)], rows: u64, budget: Budget) -> Outcome<Positions> {
    if let [(array, member)] = axes {
        let slots = member.slots(&member.names(), &[0, 1, 2])?;
        let (plan, _) = slots.plan(rows, &Wanted::Only(Vec::new()))?;
        return Ok(read_plan(array, &plan, budget)?.0);
    }
    let mut parts = Vec::new();
    for (array, member) in axes {
        let (plan, _) = member.slots(&member.names(), &[])?.plan(rows, &Wanted::All)?;
        let (_, mut columns) = read_plan(array, &plan, budget)?;
        parts.extend(columns.pop());
    }
    Ok(Positions::from_columns(&parts)?)
}
