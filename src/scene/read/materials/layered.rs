//! Materials with a clear coat.

use crate::scene::description::Surface;
use crate::scene::document::Table;
use crate::scene::values::{Limits, Number};

use super::{ROUGHNESS, SHARE};

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
