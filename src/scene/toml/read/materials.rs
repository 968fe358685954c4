//! `[materials.NAME]`.

use crate::color::Rgb;
use crate::material::Metal;
use crate::scene::description::{MaterialDescription, SurfaceKind, SurfaceModel};
use crate::scene::keys::material as keys;
use crate::scene::toml::document::{Table, TableValues};
use crate::scene::value_types::{InvalidValue, Number, ParseValue, SpannedValue};

/// Reads the names and descriptions of all materials in text order.
pub(super) fn read<'d>(root: &Table<'d>) -> Vec<(&'d str, MaterialDescription)> {
    root.named_sections("materials", |_, table| {
        let surface = read_surface(table);
        let emission = table.get(&keys::EMISSION).unwrap_or(Rgb::ZERO);
        let opacity = table.get(&keys::OPACITY).unwrap_or(1.0);
        MaterialDescription { name: String::new(), surface, emission, opacity }
    })
}

fn read_surface(table: &Table<'_>) -> SurfaceModel {
    let Some(kind) = table.get(&keys::TYPE) else {
        table.allow_unknown_keys();
        table.mark_all_invalid();
        return SurfaceModel::default();
    };
    match kind {
        SurfaceKind::Conductor => read_conductor(table),
        SurfaceKind::Dielectric => read_dielectric(table),
        _ => {
            let mut surface = SurfaceModel::with_defaults(kind);
            surface.visit_keys(&mut TableValues(table));
            surface
        }
    }
}

/// A metal by its name, or by the two parts of its index of refraction.
fn read_conductor(table: &Table<'_>) -> SurfaceModel {
    use keys::conductor as keys;
    let roughness = table.get(&keys::ROUGHNESS).unwrap_or(0.0);
    let has_index =
        [keys::IOR.name, keys::EXTINCTION.name].into_iter().any(|key| table.span_of(key).is_some());
    let metal = if has_index && table.span_of("metal").is_none() {
        let ior = table.required(keys::IOR.name, &keys::IOR.kind);
        let extinction = table.required(keys::EXTINCTION.name, &keys::EXTINCTION.kind);
        Metal { ior: ior.unwrap_or_default(), extinction: extinction.unwrap_or_default() }
    } else {
        let metal = table.required(keys::METAL.name, &keys::METAL.kind);
        for key in [&keys::IOR, &keys::EXTINCTION] {
            if table.get(key).is_some() {
                let message = format!(
                    "`{}` and `metal` both set the index of refraction",
                    table.path_to(key.name)
                );
                let help = "remove `metal`, or both `ior` and `extinction`".to_owned();
                table.error_at(key.name, message, help);
            }
        }
        metal.unwrap_or(Metal::NAMED[0].1)
    };
    SurfaceModel::Conductor { metal, roughness }
}

fn read_dielectric(table: &Table<'_>) -> SurfaceModel {
    use keys::dielectric as keys;
    let ior = read_ior(table);
    SurfaceModel::Dielectric {
        ior: ior.unwrap_or(1.5),
        roughness: table.get(&keys::ROUGHNESS).unwrap_or(0.0),
        priority: table.get(&keys::PRIORITY).unwrap_or(0),
        absorption: table.get(&keys::ABSORPTION).unwrap_or(Rgb::ZERO),
    }
}

/// Describes what is expected if there is neither a number nor a name.
struct IorOrGlass<'a>(&'a Number);

impl ParseValue for IorOrGlass<'_> {
    type Output = f64;

    fn expects(&self) -> String {
        format!("{}, or `glass = ...`, the name of a glass", self.0.expects())
    }

    fn parse(&self, node: &SpannedValue<'_>) -> Result<f64, InvalidValue> {
        self.0.parse(node)
    }
}

/// Reads the index of refraction, as a number or as the name of a glass.
fn read_ior(table: &Table<'_>) -> Option<f64> {
    use keys::dielectric as keys;
    let ior = &keys::IOR;
    let [glass_span, ior_span] = [keys::GLASS.name, ior.name].map(|key| table.span_of(key));
    match (glass_span, ior_span) {
        (None, None) => return table.required(ior.name, &IorOrGlass(&ior.kind)),
        (None, Some(_)) => return table.required(ior.name, &ior.kind),
        _ => (),
    }
    let glass = table.get(&keys::GLASS);
    if table.get(ior).is_some() {
        let message =
            format!("`{}` and `glass` both set the index of refraction", table.path_to("ior"));
        table.error_at("ior", message, "remove one of them".to_owned());
    }
    glass
}
