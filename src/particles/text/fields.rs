//! What the values of a row are, where a header says it.

use crate::particles::request::{ColumnInfo, ColumnKind, Wanted};
use crate::particles::trouble::Trouble;

use super::number::{float, tokens};
use super::values::Kind;

/// The values of a row.
#[derive(Clone, Debug, Default, PartialEq)]
pub(in crate::particles) struct Fields(pub(in crate::particles) Vec<Field>);

/// One value of a row.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::particles) struct Field {
    /// The name.
    pub(in crate::particles) name: String,
    /// What becomes of it.
    pub(in crate::particles) is: FieldUse,
}

/// What a value of a row is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::particles) enum FieldUse {
    /// A coordinate: 0 for x, 1 for y, 2 for z.
    Position(usize),
    /// A value of a column.
    Column(Kind),
    /// Left out.
    Skipped,
}

impl Field {
    /// A value of a column.
    pub(in crate::particles) fn column(name: impl Into<String>, kind: Kind) -> Self {
        Self { name: name.into(), is: FieldUse::Column(kind) }
    }

    /// A coordinate.
    pub(in crate::particles) fn position(axis: usize) -> Self {
        Self { name: ["x", "y", "z"][axis].to_owned(), is: FieldUse::Position(axis) }
    }
}

impl Fields {
    /// Describes the columns, without the positions.
    pub(in crate::particles) fn infos(&self) -> Vec<ColumnInfo> {
        let info = |field: &Field| {
            let FieldUse::Column(kind) = field.is else { return None };
            let kind = match kind {
                Kind::I32 | Kind::I64 => ColumnKind::Integer,
                Kind::F64 => ColumnKind::Float,
                Kind::Text => ColumnKind::Text,
            };
            Some(ColumnInfo { name: field.name.clone(), kind, range: None })
        };
        self.0.iter().filter_map(info).collect()
    }

    /// Changes numbers to words, and integers to floats, where the values of a row are such.
    pub(in crate::particles) fn refine(&mut self, row: &[u8]) {
        for (field, token) in self.0.iter_mut().zip(tokens(row)) {
            if let FieldUse::Column(kind) = &mut field.is {
                if float(token).is_none() {
                    *kind = Kind::Text;
                } else if *kind == Kind::I32 && super::number::integer(token).is_none() {
                    *kind = Kind::F64;
                }
            }
        }
    }

    /// Leaves out the columns that are not wanted.
    ///
    /// # Errors
    /// If a wanted one does not exist.
    pub(in crate::particles) fn select(mut self, wanted: &Wanted) -> Result<Self, Trouble> {
        wanted.check(self.infos().iter().map(|info| &*info.name))?;
        for field in &mut self.0 {
            if matches!(field.is, FieldUse::Column(_)) && !wanted.has(&field.name) {
                field.is = FieldUse::Skipped;
            }
        }
        Ok(self)
    }

    /// The kinds of the columns.
    pub(in crate::particles) fn kinds(&self) -> impl Iterator<Item = Kind> {
        let kind = |field: &Field| match field.is {
            FieldUse::Column(kind) => Some(kind),
            _ => None,
        };
        self.0.iter().filter_map(kind)
    }

    /// The names of the columns.
    pub(in crate::particles) fn names(&self) -> impl Iterator<Item = &str> {
        let is_column = |field: &&Field| matches!(field.is, FieldUse::Column(_));
        self.0.iter().filter(is_column).map(|field| &*field.name)
    }
}
