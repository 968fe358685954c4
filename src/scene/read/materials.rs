//! `[materials.NAME]`.

mod conductor;
mod dielectric;
mod layered;

use crate::color::Rgb;
use crate::scene::description::{NamedMaterial, Surface};
use crate::scene::document::Table;
use crate::scene::values::{Choice, Color, Flag, Limits, Number};

use super::RADIANCE;

/// Shares of light.
const SHARE: Color = Color(Limits::FromTo(0.0, 1.0));

/// How rough a microsurface is.
const ROUGHNESS: Number = Number(Limits::FromTo(0.0, 1.0));

/// Phong's exponents.
const EXPONENT: Number = Number(Limits::FromTo(0.0, 1e5));

/// Shares that are one number.
const PART: Number = Number(Limits::FromTo(0.0, 1.0));

/// How far the sum of two shares may exceed 1 by rounding.
pub(in crate::scene) const SHARE_ROUNDING: f32 = 1e-6;

#[derive(Clone, Copy)]
enum Type {
    Diffuse,
    Mirror,
    Conductor,
    Dielectric,
    Plastic,
    Principled,
    Phong,
}

const TYPES: Choice<Type> = Choice(&[
    ("diffuse", Type::Diffuse),
    ("mirror", Type::Mirror),
    ("conductor", Type::Conductor),
    ("dielectric", Type::Dielectric),
    ("plastic", Type::Plastic),
    ("principled", Type::Principled),
    ("phong", Type::Phong),
]);

/// The names of all materials in the order of the text; without the material where it is broken.
pub(super) fn read<'d>(root: &Table<'d>) -> Vec<(&'d str, Option<NamedMaterial>)> {
    root.named_sections("materials", |name, table| {
        let surface = read_surface(table);
        let emission = table.optional("emission", RADIANCE).unwrap_or(Rgb::ZERO);
        let opacity = table.optional("opacity", PART).unwrap_or(1.0);
        Some(NamedMaterial { name: name.to_owned(), surface: surface?, emission, opacity })
    })
}

fn read_surface(table: &Table<'_>) -> Option<Surface> {
    let Some(kind) = table.required("type", TYPES) else {
        table.allow_unknown_keys();
        return None;
    };
    match kind {
        Type::Diffuse => {
            let albedo = table.required("albedo", SHARE);
            let roughness = table.optional("roughness", PART).unwrap_or(0.0);
            Some(Surface::Diffuse { albedo: albedo?, roughness })
        }
        Type::Mirror => {
            Some(Surface::Mirror { reflectance: table.required("reflectance", SHARE)? })
        }
        Type::Conductor => conductor::read(table),
        Type::Dielectric => dielectric::read(table),
        Type::Plastic => layered::plastic(table),
        Type::Principled => layered::principled(table),
        Type::Phong => read_phong(table),
    }
}

fn read_phong(table: &Table<'_>) -> Option<Surface> {
    let albedo = table.required("albedo", SHARE);
    let specular = table.required("specular", SHARE);
    let exponent = table.required("exponent", EXPONENT);
    let normalized = table.optional("normalized", Flag).unwrap_or(true);
    let (albedo, specular, exponent) = (albedo?, specular?, exponent?);
    if normalized && (albedo + specular).max_element() > 1.0 + SHARE_ROUNDING {
        let message = format!(
            "`{}` and albedo add up to more than 1, so that the surface would create light",
            table.path_to("specular")
        );
        let help = "lower one of them; `normalized = false` is Phong's own form".to_owned();
        table.report().add(table.wrong("specular", message).help(help));
    }
    Some(Surface::Phong { albedo, specular, exponent, normalized })
}
