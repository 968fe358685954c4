//! Encodes rows in parallel and writes them in order.

use std::io::{self, Write};

use rayon::prelude::*;

use super::{GeneratedSphere, Recipe};

/// Rows encoded at a time; only their bytes are held in memory.
const ROWS_PER_CHUNK: u64 = 1 << 18;

/// Writes the rows of a table, encoded on the current rayon pool: little-endian f32 x, y, z, radius
/// and, if the recipe has colors, r, g, b. Calls `progress` with the number of rows written.
///
/// # Errors
/// When the writer fails.
pub fn write_rows(recipe: &Recipe, to: &mut dyn Write, progress: &dyn Fn(u64)) -> io::Result<()> {
    let columns = if recipe.has_colors() { 7 } else { 4 };
    let mut bytes = Vec::new();
    for first in (0..recipe.count()).step_by(ROWS_PER_CHUNK as usize) {
        let rows = ROWS_PER_CHUNK.min(recipe.count() - first) as usize;
        bytes.resize(rows * columns * size_of::<f32>(), 0);
        let slots = bytes.par_chunks_exact_mut(columns * size_of::<f32>()).enumerate();
        slots
            .with_min_len(256)
            .for_each(|(i, slot)| encode_row(recipe.sphere(first + i as u64), slot));
        to.write_all(&bytes)?;
        progress(first + rows as u64);
    }
    Ok(())
}

/// Writes as many of the row's numbers as fit into the slot.
fn encode_row(row: GeneratedSphere, slot: &mut [u8]) {
    let numbers = row.sphere.into_iter().chain(row.color);
    for (place, number) in slot.chunks_exact_mut(size_of::<f32>()).zip(numbers) {
        place.copy_from_slice(&number.to_le_bytes());
    }
}

#[cfg(test)]
mod tests {
    use super::super::Arrangement;
    use super::*;

    fn bytes(threads: usize, colors: bool) -> Vec<u8> {
        let recipe = Recipe::new(Arrangement::Clusters, 300_000, 3, colors).expect("a good count");
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let mut bytes = Vec::new();
        pool.install(|| write_rows(&recipe, &mut bytes, &|_| ())).expect("memory is writable");
        bytes
    }

    #[test]
    fn any_number_of_threads_writes_the_same_bytes() {
        let alone = bytes(1, true);
        assert_eq!(alone.len(), 300_000 * 28);
        assert!(alone == bytes(3, true));
        let plain = bytes(2, false);
        assert!(plain.chunks_exact(16).zip(alone.chunks_exact(28)).all(|(a, b)| a == &b[..16]));
    }
}
