//! Leaves particles out.

use crate::particles::{Categories, ColumnData, Particles, Positions};

/// Keeps the chosen particles, and returns their rows.
pub(super) fn keep_rows(particles: &mut Particles, chosen: &[bool]) -> Vec<u32> {
    match &mut particles.positions {
        Positions::F32(centers) => retain(centers, chosen),
        Positions::F64(centers) => retain(centers, chosen),
    }
    for column in &mut particles.columns {
        match &mut column.data {
            ColumnData::U8(values) => retain(values, chosen),
            ColumnData::I32(values) => retain(values, chosen),
            ColumnData::I64(values) => retain(values, chosen),
            ColumnData::F32(values) => retain(values, chosen),
            ColumnData::F64(values) => retain(values, chosen),
            ColumnData::Text(words) => keep_words(words, chosen),
        }
    }
    (0..chosen.len() as u32).filter(|row| chosen[*row as usize]).collect()
}

/// Keeps the words of the chosen rows, and forgets those that no row has.
fn keep_words(words: &mut Categories, chosen: &[bool]) {
    retain(&mut words.codes, chosen);
    let mut is_used = vec![false; words.names.len()];
    words.codes.iter().for_each(|code| is_used[*code as usize] = true);
    let mut new_code = vec![0; words.names.len()];
    let mut names = Vec::new();
    for (code, name) in words.names.iter().enumerate().filter(|(code, _)| is_used[*code]) {
        new_code[code] = names.len() as u32;
        names.push(name.clone());
    }
    words.codes.iter_mut().for_each(|code| *code = new_code[*code as usize]);
    words.names = names;
}

/// Keeps the values of the chosen rows.
pub(super) fn retain<T>(values: &mut Vec<T>, chosen: &[bool]) {
    let mut row = 0;
    values.retain(|_| {
        row += 1;
        chosen[row - 1]
    });
}
