//! `[materials.NAME]`.

use crate::color::Rgb;
use crate::scene::description::{NamedMaterial, Surface};
use crate::scene::document::Table;
use crate::scene::values::{Choice, Color, Flag, Limits, Number, Whole};

use super::RADIANCE;

/// Shares of light.
const SHARE: Color = Color(Limits::FromTo(0.0, 1.0));

/// Indices of refraction: below 1 as well, for bubbles told relative to what is around them.
const IOR: Number = Number(Limits::FromTo(0.1, 10.0));

/// Phong's exponents.
const EXPONENT: Number = Number(Limits::FromTo(0.0, 1e5));

/// How far the sum of two shares may exceed 1 by rounding.
pub(in crate::scene) const SHARE_ROUNDING: f32 = 1e-6;

#[derive(Clone, Copy)]
enum Type {
    Diffuse,
    Mirror,
    Dielectric,
    Phong,
}

const TYPES: Choice<Type> = Choice(&[
    ("diffuse", Type::Diffuse),
    ("mirror", Type::Mirror),
    ("dielectric", Type::Dielectric),
    ("phong", Type::Phong),
]);

/// The names of all materials in the order of the text; without the material where it is broken.
pub(super) fn read<'d>(root: &Table<'d>) -> Vec<(&'d str, Option<NamedMaterial>)> {
    root.named_sections("materials", |name, table| {
        let surface = read_surface(table);
        let emission = table.optional("emission", RADIANCE).unwrap_or(Rgb::ZERO);
        Some(NamedMaterial { name: name.to_owned(), surface: surface?, emission })
    })
}

fn read_surface(table: &Table<'_>) -> Option<Surface> {
    let Some(kind) = table.required("type", TYPES) else {
        table.allow_unknown_keys();
        return None;
    };
    match kind {
        Type::Diffuse => Some(Surface::Diffuse { albedo: table.required("albedo", SHARE)? }),
        Type::Mirror => {
            Some(Surface::Mirror { reflectance: table.required("reflectance", SHARE)? })
        }
        Type::Dielectric => {
            let ior = table.required("ior", IOR);
            let priority = table.optional("priority", Whole(i32::MIN..=i32::MAX));
            Some(Surface::Dielectric { ior: ior?, priority: priority.unwrap_or(0) })
        }
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
