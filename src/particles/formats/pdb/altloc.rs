//! Chooses among alternate locations of an atom: the one with the highest occupancy stays.

use std::collections::HashMap;

use crate::particles::column::{Categories, ColumnData};
use crate::particles::model::{Particles, Positions};
use crate::particles::trouble::plural;

/// The columns that tell atoms apart.
pub(in crate::particles) struct AtomColumns<'n> {
    /// The letter of the location; blank, `.` or `?` for atoms with only one.
    pub(in crate::particles) location: &'n str,
    pub(in crate::particles) occupancy: &'n str,
    /// Chain, residue and name.
    pub(in crate::particles) keys: &'n [&'n str],
}

/// Leaves out all but the best location of each atom, and says so.
pub(in crate::particles) fn keep_best(particles: &mut Particles, names: &AtomColumns<'_>) {
    let best = best(particles, names);
    let Some(best) = best else { return };
    let kept = best.iter().filter(|kept| **kept).count();
    let dropped = plural((best.len() - kept) as u64, "alternate location");
    match &mut particles.positions {
        Positions::F32(all) => retain(all, &best),
        Positions::F64(all) => retain(all, &best),
    }
    for column in &mut particles.columns {
        match &mut column.data {
            ColumnData::U8(values) => retain(values, &best),
            ColumnData::I32(values) => retain(values, &best),
            ColumnData::I64(values) => retain(values, &best),
            ColumnData::F32(values) => retain(values, &best),
            ColumnData::F64(values) => retain(values, &best),
            ColumnData::Text(words) => retain(&mut words.codes, &best),
        }
    }
    particles.first_line = None;
    particles.notes.push(format!("{dropped} of lower occupancy left out"));
}

fn retain<T>(values: &mut Vec<T>, kept: &[bool]) {
    let mut kept = kept.iter();
    values.retain(|_| *kept.next().unwrap_or(&true));
}

/// Which atoms stay; `None` if all do.
fn best(particles: &Particles, names: &AtomColumns<'_>) -> Option<Vec<bool>> {
    let ColumnData::Text(locations) = &particles.column(names.location)?.data else {
        return None;
    };
    let is_blank = |word: &str| matches!(word, "" | "." | "?");
    if locations.names.iter().all(|word| is_blank(word)) {
        return None;
    }
    let occupancy = particles.column(names.occupancy);
    let columns: Vec<&ColumnData> =
        names.keys.iter().filter_map(|key| particles.column(key)).map(|c| &c.data).collect();
    let key = |row: usize| -> Vec<u64> { columns.iter().map(|data| code(data, row)).collect() };
    let mut kept = vec![true; particles.len()];
    let mut best: HashMap<Vec<u64>, usize> = HashMap::new();
    for row in 0..particles.len() {
        if is_blank(word(locations, row)) {
            continue;
        }
        let value = |row| occupancy.map_or(0.0, |column| column.number(row));
        let entry = best.entry(key(row)).or_insert(row);
        if *entry != row {
            let loser =
                if value(row) > value(*entry) { std::mem::replace(entry, row) } else { row };
            kept[loser] = false;
        }
    }
    kept.contains(&false).then_some(kept)
}

fn word(words: &Categories, row: usize) -> &str {
    words.word(row)
}

/// A number that is equal for equal values.
fn code(data: &ColumnData, row: usize) -> u64 {
    match data {
        ColumnData::Text(words) => u64::from(words.codes[row]),
        other => other.number(row).to_bits(),
    }
}
