//! PDBx/mmCIF: the loop of `_atom_site`, whose columns may have any order. Lengths are in Å.
//!
//! Small-molecule CIF, which lists the atoms of a cell before symmetry, is something else and is
//! not read.

use crate::particles::budget::Budget;
use crate::particles::column::ColumnData;
use crate::particles::format::Format;
use crate::particles::model::{Cell, LengthUnit, Particles};
use crate::particles::request::{ReadRequest, Survey, Wanted};
use crate::particles::source::Source;
use crate::particles::text::{
    Batch, Field, FieldUse, Fields, Input, Kind, LineParser, Section, SpacedRows, float, read_rows,
    skip_section, tokens,
};
use crate::particles::trouble::{Outcome, Trouble, plural, shown};

use super::pdb::altloc::{AtomColumns, keep_best};

/// The columns that tell atoms with alternate locations apart.
const ATOM: AtomColumns<'static> = AtomColumns {
    location: "label_alt_id",
    occupancy: "occupancy",
    keys: &[
        "label_asym_id",
        "auth_asym_id",
        "auth_seq_id",
        "label_seq_id",
        "pdbx_PDB_ins_code",
        "label_atom_id",
    ],
};

/// The column with the number of the model.
const MODEL: &str = "pdbx_PDB_model_num";

/// What stands before the atoms.
struct Head {
    title: Option<String>,
    cell: Option<Cell>,
    fields: Fields,
}

/// Reads a model.
pub(in crate::particles) fn read(
    source: Source,
    frame: u64,
    request: &ReadRequest,
) -> Outcome<Particles> {
    let path = source.path.clone();
    let budget = Budget::new(request.memory_limit);
    let mut input = Input::new(source);
    let head = find(&mut input)?;
    let model = model_column(&head.fields);
    let model = match (model, frame) {
        (None, 0) => None,
        (None, _) => return Err(no_frame(1, frame)),
        (Some(at), _) => Some((at, model_of(&mut input, at)?.saturating_add(frame as i64))),
    };
    let names: Vec<String> = head.fields.names().map(str::to_owned).collect();
    let wanted = match &request.columns {
        Wanted::All => Wanted::All,
        Wanted::Only(wanted) => {
            request.columns.check(names.iter().map(|name| &**name))?;
            let keys = ATOM.keys.iter().chain([&ATOM.location, &ATOM.occupancy]);
            let keys = keys.filter(|key| names.iter().any(|name| name == *key));
            Wanted::Only(wanted.iter().cloned().chain(keys.map(|key| (*key).to_owned())).collect())
        }
    };
    let fields = head.fields.select(&wanted)?;
    let spaced = SpacedRows::new(&fields, false).with_quotes();
    let rows = ModelRows { rows: spaced, model };
    let mut batch = Batch::new(fields.kinds());
    let first_line = input.line_number();
    let lines = read_rows(&mut input, &rows, Section::Until(end_of_loop), budget, &mut batch)?;
    if batch.positions.is_empty() && frame > 0 {
        return Err(no_frame(frame, frame));
    }
    let (positions, columns) = batch.finish(fields.names());
    let is_dense = lines == positions.len() as u64;
    let mut particles = Particles {
        columns,
        cell: head.cell,
        frame,
        title: head.title,
        unit: Some(LengthUnit::Angstrom),
        first_line: is_dense.then_some(first_line),
        ..Particles::new(path, Format::Mmcif, positions)
    };
    keep_best(&mut particles, &ATOM);
    particles.columns.retain(|column| request.columns.has(&column.name));
    Ok(particles)
}

/// Tells what the atoms are.
pub(in crate::particles) fn survey(source: Source) -> Outcome<Survey> {
    let survey = Survey::new(&source, Format::Mmcif);
    let head = find(&mut Input::new(source))?;
    Ok(Survey {
        columns: head.fields.infos(),
        cell: head.cell,
        title: head.title,
        unit: Some(LengthUnit::Angstrom),
        ..survey
    })
}

/// Counts the models.
pub(in crate::particles) fn count(source: Source, request: &ReadRequest) -> Outcome<u64> {
    let budget = Budget::new(request.memory_limit);
    let mut input = Input::new(source);
    let head = find(&mut input)?;
    if model_column(&head.fields).is_none() {
        skip_section(&mut input, Section::Until(end_of_loop))?;
        return Ok(1);
    }
    let fields = head.fields.select(&Wanted::Only(vec![MODEL.to_owned()]))?;
    let rows = SpacedRows::new(&fields, false).with_quotes();
    let mut batch = Batch::new(fields.kinds());
    read_rows(&mut input, &rows, Section::Until(end_of_loop), budget, &mut batch)?;
    let models = batch.columns.pop().map(|values| values.finish());
    let models = models.unwrap_or(ColumnData::I32(Vec::new()));
    let changes = (1..models.len()).filter(|&row| models.number(row) != models.number(row - 1));
    Ok(changes.count() as u64 + 1)
}

fn no_frame(has: u64, frame: u64) -> crate::particles::trouble::Failure {
    let has = plural(has, "model");
    Trouble::new(format!("it has {has}, and no frame {frame} (the first is 0)")).into()
}

/// Rows of one model.
struct ModelRows {
    rows: SpacedRows,
    /// Place and value of the model's number.
    model: Option<(usize, i64)>,
}

impl LineParser for ModelRows {
    fn parse(&self, line: &[u8], to: &mut Batch) -> Result<(), String> {
        if let Some((at, wanted)) = self.model {
            // Usually the last value, so from the end.
            let found = tokens(line).nth(at).and_then(float);
            let has_quotes = line.iter().any(|byte| b"'\"".contains(byte));
            if found.is_some_and(|model| model != wanted as f64) && !has_quotes {
                return Ok(());
            }
        }
        self.rows.parse(line, to)
    }
}

/// The place of the model's number among the values of a row.
fn model_column(fields: &Fields) -> Option<usize> {
    fields.0.iter().position(|field| field.name == MODEL)
}

/// The model of the first row.
fn model_of(input: &mut Input, at: usize) -> Outcome<i64> {
    let line = input.peek_line()?.unwrap_or_default();
    let model = tokens(line).nth(at).and_then(crate::particles::text::integer);
    Ok(model.unwrap_or(1))
}

/// Finds the rows of `_atom_site`.
fn find(input: &mut Input) -> Outcome<Head> {
    let mut lengths = [f64::NAN; 3];
    let mut angles = [90.0; 3];
    let mut title = None;
    let mut names: Vec<String> = Vec::new();
    loop {
        let Some(line) = input.peek_line()? else { return Err(no_atoms()) };
        let line = String::from_utf8_lossy(line).trim().to_owned();
        if let Some(name) = line.strip_prefix("_atom_site.") {
            names.push(name.split_whitespace().next().unwrap_or_default().to_owned());
        } else if !names.is_empty() {
            break;
        } else if let Some(entry) = line.strip_prefix("_cell.") {
            let mut words = entry.split_whitespace();
            let (key, value) = (words.next().unwrap_or_default(), words.next().unwrap_or_default());
            let value = float(value.as_bytes()).unwrap_or(f64::NAN);
            match key {
                "length_a" => lengths[0] = value,
                "length_b" => lengths[1] = value,
                "length_c" => lengths[2] = value,
                "angle_alpha" => angles[0] = value,
                "angle_beta" => angles[1] = value,
                "angle_gamma" => angles[2] = value,
                _ => {}
            }
        } else if let Some(text) = line.strip_prefix("_struct.title") {
            let text = text.trim().trim_matches(['\'', '"']).to_owned();
            title = Some(text).filter(|text| !text.is_empty());
        } else if line.starts_with("_atom_site_") {
            let message = "it is a CIF file of a small molecule, which cannot be read";
            let help = "convert it to XYZ or POSCAR with its symmetry applied";
            return Err(Trouble::new(message).with_help(help).into());
        }
        input.skip_lines(1)?;
    }
    let is_cell = lengths.iter().chain(&angles).all(|x| x.is_finite());
    let is_dummy = lengths.iter().all(|&length| length <= 1.0);
    let cell = (is_cell && !is_dummy).then(|| Cell::from_lengths_and_angles(lengths, angles));
    let fields = fields(&names)?;
    Ok(Head { title, cell, fields })
}

fn no_atoms() -> crate::particles::trouble::Failure {
    Trouble::new("it has no loop with `_atom_site.` columns").into()
}

fn fields(names: &[String]) -> Outcome<Fields> {
    let cartesian = ["Cartn_x", "Cartn_y", "Cartn_z"];
    let place = |name: &str| names.iter().position(|found| found == name);
    let [Some(x), Some(y), Some(z)] = cartesian.map(place) else {
        let found = shown(names.join(" ").as_bytes());
        let message = format!("expected `_atom_site.Cartn_x`, `_y` and `_z`, found {found}");
        return Err(Trouble::new(message).into());
    };
    let places = [x, y, z];
    let field = |(at, name): (usize, &String)| {
        let axis = places.iter().position(|&place| place == at);
        let is = axis.map_or(FieldUse::Column(kind(name)), FieldUse::Position);
        Field { name: name.clone(), is }
    };
    Ok(Fields(names.iter().enumerate().map(field).collect()))
}

/// What a column holds, by the dictionary.
fn kind(name: &str) -> Kind {
    match name {
        "id" | "label_seq_id" | "auth_seq_id" | "pdbx_PDB_model_num" => Kind::I32,
        "occupancy" | "B_iso_or_equiv" | "pdbx_formal_charge" => Kind::F64,
        _ if name.contains("_esd") || name.starts_with("aniso") => Kind::F64,
        _ => Kind::Text,
    }
}

/// Where a line begins that is no row: a comment, a name, or the next loop or block.
fn end_of_loop(text: &[u8]) -> Option<usize> {
    let is_end = |line: &[u8]| {
        matches!(line.first(), None | Some(b'#' | b'_' | b'\r' | b'\n'))
            || line.starts_with(b"loop_")
            || line.starts_with(b"data_")
    };
    if is_end(text) {
        return Some(0);
    }
    let ends = memchr::memchr_iter(b'\n', text).map(|at| at + 1);
    ends.filter(|&at| at < text.len()).find(|&at| is_end(&text[at..]))
}
