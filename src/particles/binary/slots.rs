//! The columns of a binary file, from which those that are wanted are chosen.

use crate::particles::column::{Column, ColumnData};
use crate::particles::request::{ColumnInfo, ColumnKind, Wanted};
use crate::particles::trouble::Trouble;

use super::number::Number;
use super::rows::{BinaryField, Group, Plan, Target};

/// All columns of a binary file.
#[derive(Clone, Debug, Default)]
pub(in crate::particles) struct Slots {
    /// Position of the first row, and bytes from one row to the next, of each group.
    pub(in crate::particles) groups: Vec<(u64, u64)>,
    pub(in crate::particles) slots: Vec<Slot>,
}

/// One column of a binary file.
#[derive(Clone, Debug)]
pub(in crate::particles) struct Slot {
    pub(in crate::particles) name: String,
    pub(in crate::particles) number: Number,
    /// Index of the group.
    pub(in crate::particles) group: usize,
    /// Position in a row of the group.
    pub(in crate::particles) offset: u64,
    /// The axis, if this is a coordinate.
    pub(in crate::particles) axis: Option<usize>,
}

impl Slots {
    /// Describes the columns, without the positions.
    pub(in crate::particles) fn infos(&self) -> Vec<ColumnInfo> {
        let columns = self.slots.iter().filter(|slot| slot.axis.is_none());
        let info = |slot: &Slot| ColumnInfo {
            name: slot.name.clone(),
            kind: match slot.number.kind.is_float() {
                true => ColumnKind::Float,
                false => ColumnKind::Integer,
            },
            range: None,
        };
        columns.map(info).collect()
    }

    /// Bytes of a position in memory.
    pub(in crate::particles) fn position_bytes(&self) -> u64 {
        let mut positions = self.slots.iter().filter(|slot| slot.axis.is_some());
        if positions.all(|slot| slot.number.kind.fits_f32()) { 12 } else { 24 }
    }

    /// Chooses the positions and the wanted columns, whose names come back in order.
    ///
    /// # Errors
    /// If a wanted column does not exist.
    pub(in crate::particles) fn plan(
        &self,
        rows: u64,
        wanted: &Wanted,
    ) -> Result<(Plan, Vec<String>), Trouble> {
        let columns = || self.slots.iter().filter(|slot| slot.axis.is_none());
        wanted.check(columns().map(|slot| &*slot.name))?;
        let group = |&(start, stride): &(u64, u64)| Group { start, stride, fields: Vec::new() };
        let mut plan =
            Plan { rows, columns: Vec::new(), groups: self.groups.iter().map(group).collect() };
        let mut names = Vec::new();
        for slot in &self.slots {
            let target = match slot.axis {
                Some(axis) => Target::Position(axis),
                None if wanted.has(&slot.name) => {
                    names.push(slot.name.clone());
                    plan.columns.push(slot.number);
                    Target::Column(names.len() - 1)
                }
                None => continue,
            };
            let field = BinaryField { offset: slot.offset, number: slot.number, target };
            plan.groups[slot.group].fields.push(field);
        }
        plan.groups.retain(|group| !group.fields.is_empty());
        Ok((plan, names))
    }
}

/// Columns with their names.
pub(in crate::particles) fn named(names: Vec<String>, data: Vec<ColumnData>) -> Vec<Column> {
    names.into_iter().zip(data).map(|(name, data)| Column { name, data }).collect()
}
