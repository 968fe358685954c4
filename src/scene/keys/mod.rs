//! The table of scene file keys. Each key is declared once: its name, value type, default and
//! meaning. The scene file reader, the validation of values from a program, the command line
//! options, the JSON schema for editors and the manual are generated from this table or tested
//! against it.

pub(super) mod background;
mod entries;
mod key;
mod limits;
pub(super) mod material;
pub(super) mod particles;
pub(super) mod render;
mod schema;
mod sections;

pub use key::{CliOption, DefaultValue, KeyInfo};
pub use schema::schema;

pub(super) use entries::{camera, image, light, root, sphere, table};
pub(super) use key::{Key, KeyVisitor};
pub(super) use limits::{MAX_RADIANCE, MIN_RADIUS};

pub(super) use sections::is_list;

use key::{DynKey, TableSchema};

/// The keys that only other types of a table have than this one: of `camera` or `materials.NAME`.
pub(super) fn of_other_types(table: &str, name: &str) -> Vec<&'static str> {
    let is_it = |section: &&TableSchema| section.path == table;
    let Some(section) = sections::tables().find(is_it) else { return Vec::new() };
    let keys_of = |keys: &[&'static dyn DynKey]| -> Vec<&'static str> {
        keys.iter().map(|key| key.info(section.path, None).name).collect()
    };
    let is_named = |(other, _): &&(&str, &[&dyn DynKey])| *other == name;
    let Some((_, own)) = section.types.iter().find(is_named) else { return Vec::new() };
    let own = [keys_of(own), keys_of(section.keys)].concat();
    let others = section.types.iter().flat_map(|(_, keys)| keys_of(keys));
    others.filter(|key| !own.contains(key)).collect()
}

/// Every key of a scene file, table by table.
pub fn all() -> Vec<KeyInfo> {
    let of_section = |section: &'static TableSchema| {
        let common = section.keys.iter().map(|key| key.info(section.path, None));
        let typed = section
            .types
            .iter()
            .flat_map(|(name, keys)| keys.iter().map(|key| key.info(section.path, Some(name))));
        common.chain(typed)
    };
    sections::tables().flat_map(of_section).collect()
}
