//! Materials of several layers.

use crate::material::PrincipledParameters;
use crate::scene::description::Surface;
use crate::scene::document::Table;
use crate::scene::values::{Limits, Number};

use super::{PART, ROUGHNESS, SHARE};

/// The index of a coat, relative to what is around it.
const COAT_IOR: Number = Number(Limits::FromTo(1.0, 10.0));

/// Most plastics, lacquers and glazes.
const USUAL_IOR: f64 = 1.5;

pub(super) fn plastic(table: &Table<'_>) -> Option<Surface> {
    let albedo = table.required("albedo", SHARE);
    let ior = table.optional("ior", COAT_IOR).unwrap_or(USUAL_IOR);
    let roughness = table.optional("roughness", ROUGHNESS).unwrap_or(0.0);
    Some(Surface::Plastic { albedo: albedo?, ior, roughness })
}

/// Satin, as in other renderers.
const USUAL_ROUGHNESS: f64 = 0.5;

pub(super) fn principled(table: &Table<'_>) -> Option<Surface> {
    let base_color = table.required("base_color", SHARE);
    let part = |key, usual| table.optional(key, PART).unwrap_or(usual);
    let parameters = PrincipledParameters {
        base_color: base_color.unwrap_or_default(),
        metallic: part("metallic", 0.0),
        roughness: table.optional("roughness", ROUGHNESS).unwrap_or(USUAL_ROUGHNESS),
        specular: part("specular", 0.5),
        ior: table.optional("ior", COAT_IOR).unwrap_or(USUAL_IOR),
        coat: part("coat", 0.0),
        coat_roughness: table.optional("coat_roughness", ROUGHNESS).unwrap_or(0.0),
        transmission: part("transmission", 0.0),
    };
    base_color.map(|_| Surface::Principled(parameters))
}
