//! Columns: one number or word for each particle.

use std::sync::Arc;

/// One number or word for each particle.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// The name in the file. Components of a vector have the suffix `_x`, `_y`, `_z` if there are
    /// three, and otherwise `_1`, `_2`, ... A name may repeat that of no other column.
    pub name: String,
    /// The values, in the order of the particles.
    pub data: ColumnData,
}

/// The values of a column, in the type that the file has, or the narrowest one that holds its text.
#[derive(Clone, Debug, PartialEq)]
pub enum ColumnData {
    /// Bytes, such as colours in [0, 255].
    U8(Vec<u8>),
    /// 32-bit integers.
    I32(Vec<i32>),
    /// 64-bit integers.
    I64(Vec<i64>),
    /// 32-bit floats. NaN stands for a missing value.
    F32(Vec<f32>),
    /// 64-bit floats. NaN stands for a missing value.
    F64(Vec<f64>),
    /// Words.
    Text(Categories),
}

/// Words, each stored once.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Categories {
    /// The word of each particle, as an index into `names`.
    pub codes: Vec<u32>,
    /// The distinct words, in the order of their first appearance.
    pub names: Vec<Arc<str>>,
}

/// What a column means, told from its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Symbol of a chemical element.
    Element,
    /// Atomic number.
    AtomicNumber,
    /// Type of particle: a small integer or a word.
    Type,
    /// Radius, in the unit of the positions.
    Radius,
    /// Diameter, in the unit of the positions.
    Diameter,
    /// Identifier of a particle.
    Id,
    /// Molecule or residue number.
    Molecule,
    /// Mass.
    Mass,
    /// Charge.
    Charge,
    /// Red: sRGB in [0, 255] in integers, in [0, 1] in floats.
    Red,
    /// Green, like red.
    Green,
    /// Blue, like red.
    Blue,
    /// Transparency in [0, 1].
    Transparency,
}

/// Names of each role in the files of various programs, in lower case; the first one counts most.
const ROLES: [(Role, &[&str]); 13] = [
    (Role::Element, &["element", "species", "symbol", "type_symbol"]),
    (Role::AtomicNumber, &["z_number", "atomic_number", "numbers", "atomicnum"]),
    (Role::Type, &["type", "typeid", "atom_type", "particle type", "particle_type"]),
    (Role::Radius, &["radius", "radii", "rad"]),
    (Role::Diameter, &["diameter", "diam"]),
    (Role::Id, &["id", "serial", "atom_id", "particle identifier", "particle_id", "tag"]),
    (Role::Molecule, &["mol", "molecule", "resid", "residue", "molecule-id"]),
    (Role::Mass, &["mass", "masses"]),
    (Role::Charge, &["q", "charge", "charges", "initial_charges"]),
    (Role::Red, &["red", "r8", "color_x", "colour_x", "rgb_x", "diffuse_red"]),
    (Role::Green, &["green", "g8", "color_y", "colour_y", "rgb_y", "diffuse_green"]),
    (Role::Blue, &["blue", "b8", "color_z", "colour_z", "rgb_z", "diffuse_blue"]),
    (Role::Transparency, &["transparency"]),
];

/// The name of a component of a vector: `_x`, `_y`, `_z` of three, else `_1`, `_2`, ...
pub(super) fn component_name(name: &str, at: usize, count: usize) -> String {
    match count {
        1 => name.to_owned(),
        3 => format!("{name}_{}", ["x", "y", "z"][at]),
        _ => format!("{name}_{}", at + 1),
    }
}

/// A name without a unit in brackets at its end, as in `x [mm]`.
pub(super) fn base_name(name: &str) -> &str {
    let name = name.trim();
    let open = match name.chars().last() {
        Some(']') => name.rfind('['),
        Some(')') => name.rfind('('),
        _ => None,
    };
    let base = open.map_or(name, |open| name[..open].trim_end());
    // `f_a[2]` is a name as it is.
    let has_gap = open.is_some_and(|open| name[..open].ends_with(char::is_whitespace));
    if has_gap && !base.is_empty() { base } else { name }
}

/// Returns true if a column with this name is meant by `wanted`: case and a unit do not matter.
pub(super) fn is_called(name: &str, wanted: &str) -> bool {
    name.eq_ignore_ascii_case(wanted) || base_name(name).eq_ignore_ascii_case(wanted)
}

impl Role {
    /// The names that columns with this role have, in lower case, the usual one first.
    pub fn names(self) -> &'static [&'static str] {
        ROLES.iter().find(|(role, _)| *role == self).map_or(&[], |(_, names)| names)
    }

    /// The role of a column with this name; case does not matter.
    pub fn of(name: &str) -> Option<Self> {
        let name = base_name(name).to_ascii_lowercase();
        ROLES.iter().find(|(_, names)| names.contains(&&*name)).map(|(role, _)| *role)
    }
}

impl Column {
    /// The number of a row; NaN for a word.
    pub fn number(&self, row: usize) -> f64 {
        self.data.number(row)
    }

    /// The least and the greatest number; `None` for words, or if no value is a number.
    pub fn range(&self) -> Option<[f64; 2]> {
        if matches!(self.data, ColumnData::Text(_)) {
            return None;
        }
        let numbers = (0..self.data.len()).map(|row| self.number(row)).filter(|x| !x.is_nan());
        let widen = |[low, high]: [f64; 2], x: f64| [low.min(x), high.max(x)];
        let range = numbers.fold([f64::INFINITY, f64::NEG_INFINITY], widen);
        (range[0] <= range[1]).then_some(range)
    }
}

impl ColumnData {
    /// Number of values.
    pub fn len(&self) -> usize {
        match self {
            Self::U8(values) => values.len(),
            Self::I32(values) => values.len(),
            Self::I64(values) => values.len(),
            Self::F32(values) => values.len(),
            Self::F64(values) => values.len(),
            Self::Text(words) => words.codes.len(),
        }
    }

    /// Returns true if there are no values.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The number of a row; NaN for a word. 64-bit integers above 2^53 are rounded.
    #[inline]
    pub fn number(&self, row: usize) -> f64 {
        match self {
            Self::U8(values) => f64::from(values[row]),
            Self::I32(values) => f64::from(values[row]),
            Self::I64(values) => values[row] as f64,
            Self::F32(values) => f64::from(values[row]),
            Self::F64(values) => values[row],
            Self::Text(_) => f64::NAN,
        }
    }

    /// Appends other values of the same type; false if the type differs.
    pub(super) fn append(&mut self, more: Self) -> bool {
        match (self, more) {
            (Self::U8(all), Self::U8(more)) => all.extend_from_slice(&more),
            (Self::I32(all), Self::I32(more)) => all.extend_from_slice(&more),
            (Self::I64(all), Self::I64(more)) => all.extend_from_slice(&more),
            (Self::F32(all), Self::F32(more)) => all.extend_from_slice(&more),
            (Self::F64(all), Self::F64(more)) => all.extend_from_slice(&more),
            _ => return false,
        }
        true
    }

    /// The value of a row as the file would show it.
    pub fn show(&self, row: usize) -> String {
        match self {
            Self::U8(values) => values[row].to_string(),
            Self::I32(values) => values[row].to_string(),
            Self::I64(values) => values[row].to_string(),
            Self::F32(values) => values[row].to_string(),
            Self::F64(values) => values[row].to_string(),
            Self::Text(words) => words.word(row).to_owned(),
        }
    }
}

impl Categories {
    /// The word of a row.
    pub fn word(&self, row: usize) -> &str {
        &self.names[self.codes[row] as usize]
    }
}
