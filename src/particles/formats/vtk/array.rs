//! Arrays of VTK files as columns.

use crate::particles::binary::{Data, Number, NumberKind, Slot, Slots, named, read_plan};
use crate::particles::budget::Budget;
use crate::particles::column::{Column, component_name};
use crate::particles::model::Positions;
use crate::particles::request::{ColumnInfo, ColumnKind, Wanted};
use crate::particles::text::{float, integer, tokens};
use crate::particles::trouble::{Outcome, Trouble, shown};

/// The most components that an array may have.
pub(super) const MAX_COMPONENTS: u64 = 64;

/// An array of a file.
#[derive(Clone, Debug)]
pub(super) struct Array {
    pub(super) name: String,
    pub(super) kind: NumberKind,
    pub(super) components: u64,
    pub(super) range: Option<[f64; 2]>,
}

impl Array {
    /// The names of its columns.
    pub(super) fn names(&self) -> Vec<String> {
        let count = self.components as usize;
        (0..count).map(|at| component_name(&self.name, at, count)).collect()
    }

    /// Describes its columns.
    pub(super) fn infos(&self) -> Vec<ColumnInfo> {
        let kind = if self.kind.is_float() { ColumnKind::Float } else { ColumnKind::Integer };
        let range = self.range.filter(|_| self.components == 1);
        self.names().into_iter().map(|name| ColumnInfo { name, kind, range }).collect()
    }

    /// Reads the wanted columns of the numbers in `data`.
    pub(super) fn columns(
        &self,
        data: &Data,
        is_big_endian: bool,
        rows: u64,
        wanted: &Wanted,
        budget: Budget,
    ) -> Outcome<Vec<Column>> {
        let own: Vec<String> = self.names().into_iter().filter(|name| wanted.has(name)).collect();
        let slots = self.slots(is_big_endian, false);
        let (plan, names) = slots.plan(rows, &Wanted::Only(own))?;
        Ok(named(names, read_plan(data, &plan, budget)?.1))
    }

    /// Reads the numbers in `data` as positions.
    pub(super) fn positions(
        &self,
        data: &Data,
        is_big_endian: bool,
        rows: u64,
        budget: Budget,
    ) -> Outcome<Positions> {
        if self.components != 3 {
            let message = format!("its points have {} coordinates, expected 3", self.components);
            return Err(Trouble::new(message).into());
        }
        let slots = self.slots(is_big_endian, true);
        let (plan, _) = slots.plan(rows, &Wanted::Only(Vec::new()))?;
        Ok(read_plan(data, &plan, budget)?.0)
    }

    fn slots(&self, is_big_endian: bool, are_positions: bool) -> Slots {
        let (number, size) = (Number { kind: self.kind, is_big_endian }, self.kind.bytes());
        let slot = |(at, name): (usize, String)| Slot {
            name,
            number,
            group: 0,
            offset: at as u64 * size,
            axis: are_positions.then_some(at),
        };
        let slots = self.names().into_iter().enumerate().map(slot).collect();
        Slots { groups: vec![(0, self.components * size)], slots }
    }
}

/// Numbers as text, as little-endian bytes of their type.
pub(super) fn encode(text: &[u8], kind: NumberKind) -> Result<Vec<u8>, Trouble> {
    let mut bytes = Vec::new();
    for token in tokens(text) {
        let wrong = || Trouble::new(format!("expected a number, found {}", shown(token)));
        if kind.is_float() {
            let value = float(token).ok_or_else(wrong)?;
            match kind {
                NumberKind::F64 => bytes.extend(value.to_le_bytes()),
                _ => bytes.extend((value as f32).to_le_bytes()),
            }
        } else {
            let value = integer(token).ok_or_else(wrong)?;
            bytes.extend(&value.to_le_bytes()[..kind.bytes() as usize]);
        }
    }
    Ok(bytes)
}
