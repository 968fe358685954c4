//! `[[particles]]`.

use std::collections::BTreeMap;
use std::path::Path;

use crate::appearance::{Appearance, ColorChoice, RadiusChoice, RangeChoice};
use crate::scene::data::SphereData;
use crate::scene::description::{ColorStorage, SphereTable};
use crate::scene::keys::particles as keys;
use crate::scene::particle_file::ParticleTable;
use crate::scene::toml::document::{Table, TableValues};
use crate::scene::value_types::MaterialName;

/// Reads one entry. Relative paths start at `folder`.
pub(super) fn read(
    table: &Table<'_>,
    index_of: &BTreeMap<&str, usize>,
    folder: &Path,
) -> SphereTable {
    let name = table.get(&keys::NAME);
    let file = table.get(&keys::FILE).unwrap_or_default();
    let material = table.required(keys::MATERIAL.name, &MaterialName(index_of));
    let colors = table.get(&keys::COLORS).unwrap_or(ColorStorage::Packed);
    let names = table.get(&keys::COLUMNS).unwrap_or_default();
    let particles = ParticleTable {
        // Standard input keeps its name.
        path: if file == "-" { file.into() } else { folder.join(file) },
        format: table.get(&keys::FORMAT),
        frame: table.get(&keys::FRAME).unwrap_or_default(),
        columns: names
            .split([',', ' '])
            .map(|name| name.trim().to_owned())
            .filter(|name| !name.is_empty())
            .collect(),
        topology: table.get(&keys::TOPOLOGY).map(|file| folder.join(file)),
        appearance: read_appearance(table),
    };
    SphereTable {
        name,
        data: SphereData::Particles(Box::new(particles)),
        material: material.unwrap_or_default(),
        colors,
        ..SphereTable::default()
    }
}

fn read_appearance(table: &Table<'_>) -> Appearance {
    let mut appearance = Appearance::default();
    keys::visit_keys(&mut appearance, &mut TableValues(table));
    if let Some(text) = table.get(&keys::RADIUS) {
        appearance.radius = RadiusChoice::from(text);
    }
    if let RadiusChoice::Number(radius) = appearance.radius {
        if !(radius > 0.0 && radius.is_finite()) {
            let message = format!("`{}` must be above 0, not {radius}", table.path_to("radius"));
            table.error_at("radius", message, None);
        }
    }
    if let Some(text) = table.get(&keys::COLOR) {
        appearance.color = ColorChoice::from(text);
    }
    if let Some(text) = table.get(&keys::RANGE) {
        match RangeChoice::parse(&text) {
            Some(range) => appearance.range = range,
            None => {
                let key = table.path_to("range");
                let message = format!("`{key}` must be two numbers or percentiles, not {text:?}");
                let help = "such as \"0,1.5\", or \"p1,p99\" to leave outliers out".to_owned();
                table.error_at("range", message, help);
            }
        }
    }
    if let Some(counts) = table.get(&keys::REPLICATE) {
        match <[u32; 3]>::try_from(counts) {
            Ok(counts) => appearance.replicate = counts,
            Err(counts) => {
                let key = table.path_to("replicate");
                let message = format!("`{key}` must be three numbers, not {}", counts.len());
                table.error_at("replicate", message, None);
            }
        }
    }
    appearance
}
