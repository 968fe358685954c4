//! `type = "conductor"`.

use crate::material::Metal;
use crate::scene::description::Surface;
use crate::scene::document::Table;
use crate::scene::values::{Choice, Color, Limits};

use super::ROUGHNESS;

/// Parts of a complex index of refraction.
const INDEX: Color = Color(Limits::FromTo(0.0, 100.0));

/// A metal by its name, or by the two parts of its index of refraction.
pub(super) fn read(table: &Table<'_>) -> Option<Surface> {
    let roughness = table.optional("roughness", ROUGHNESS).unwrap_or(0.0);
    let is_told = ["ior", "extinction"].into_iter().any(|key| table.span_of(key).is_some());
    let metal = if is_told && table.span_of("metal").is_none() {
        let (ior, extinction) = (table.required("ior", INDEX), table.required("extinction", INDEX));
        Metal { ior: ior?, extinction: extinction? }
    } else {
        let metal = table.required("metal", Choice(&Metal::NAMED));
        for key in ["ior", "extinction"] {
            if table.optional(key, INDEX).is_some() {
                let message =
                    format!("`{}` says again what `metal` says already", table.path_to(key));
                let help = "remove `metal`, or both `ior` and `extinction`".to_owned();
                table.report().add(table.wrong(key, message).help(help));
            }
        }
        metal?
    };
    Some(Surface::Conductor { metal, roughness })
}
