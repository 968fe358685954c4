//! The key under which a table stands.

use super::data::SphereData;
use super::description::SphereTable;
use super::validation_errors::KeyPath;

/// The key of a table: `sphere_tables.3`, or `particles.0` for particles, which come last.
pub(super) fn table_path(tables: &[SphereTable], index: usize) -> KeyPath {
    let is_particles = |table: &SphereTable| matches!(table.data, SphereData::Particles(_));
    let before = tables[..index].iter().filter(|table| is_particles(table)).count();
    match is_particles(&tables[index]) {
        true => KeyPath::root("particles").entry(before, None),
        false => KeyPath::root("sphere_tables").entry(index - before, None),
    }
}
