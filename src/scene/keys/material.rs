//! The keys of `[materials.NAME]`: those that every material has, those of each reflection model,
//! and which value of a [`SurfaceModel`] stands under which key.

use crate::material::{Metal, NAMED_IORS};
use crate::scene::surface::{SurfaceKind, SurfaceModel};
use crate::scene::value_types::{
    Boolean, Color, EnumValue, Integer, NamedValue, Number, NumberRange,
};

use super::key::DefaultValue::{Derived, Required, Toml};
use super::key::{DynKey, Key, KeyVisitor, key, keys};
use super::limits::{RADIANCE, UNIT_COLOR, UNIT_INTERVAL};

keys! {
    TYPE: EnumValue<SurfaceKind> = key("type", EnumValue::NEW, Required, "the reflection model");
    EMISSION: Color = key("emission", RADIANCE, Toml("[0, 0, 0]"), "emitted radiance on both sides, in W/(sr m^2)");
    OPACITY: Number = key("opacity", UNIT_INTERVAL, Toml("1"), "the fraction of light that interacts with the surface");
}

pub(in crate::scene) mod diffuse {
    use super::*;
    keys! {
        ALBEDO: Color = key("albedo", UNIT_COLOR, Required, "the fraction of light that is scattered");
        ROUGHNESS: Number = key("roughness", UNIT_INTERVAL, Toml("0"), "0 is Lambertian, 1 looks as flat as chalk");
    }
}

pub(in crate::scene) mod mirror {
    use super::*;
    keys! {
        REFLECTANCE: Color = key("reflectance", UNIT_COLOR, Required, "the fraction of light that is reflected");
    }
}

pub(in crate::scene) mod conductor {
    use super::*;
    const INDEX: Color = Color(NumberRange::Closed(0.0, 100.0));
    keys! {
        METAL: NamedValue<Metal> = key("metal", NamedValue(&Metal::NAMED), Derived("required, or ior and extinction"), "a metal, by name");
        IOR: Color = key("ior", INDEX, Derived("from metal"), "the real part of the complex index of refraction");
        EXTINCTION: Color = key("extinction", INDEX, Derived("from metal"), "the imaginary part of the index of refraction");
        ROUGHNESS: Number = key("roughness", UNIT_INTERVAL, Toml("0"), "the square root of the GGX distribution's alpha");
    }
}

pub(in crate::scene) mod dielectric {
    use super::*;
    keys! {
        IOR: Number = key("ior", Number(NumberRange::Closed(0.1, 10.0)), Derived("required, or glass"),
            "index of refraction relative to vacuum");
        GLASS: NamedValue<f64> = key("glass", NamedValue(&NAMED_IORS), Derived("from ior"), "instead of ior: a glass, crystal or liquid by name");
        ROUGHNESS: Number = key("roughness", UNIT_INTERVAL, Toml("0"), "the square root of the GGX distribution's alpha");
        PRIORITY: Integer<i32> = key("priority", Integer(i32::MIN..=i32::MAX), Toml("0"),
            "where such spheres overlap, the one with the higher priority fills the common part");
        ABSORPTION: Color = key("absorption", Color(NumberRange::Closed(0.0, 1e15)), Toml("[0, 0, 0]"), "the absorption coefficient per unit of length");
    }
}

/// The index of a coat, relative to what is around it.
const COAT_IOR: Number = Number(NumberRange::Closed(1.0, 10.0));

pub(in crate::scene) mod plastic {
    use super::*;
    keys! {
        ALBEDO: Color = key("albedo", UNIT_COLOR, Required, "the albedo of the diffuse base under the coat");
        IOR: Number = key("ior", COAT_IOR, Toml("1.5"), "index of refraction of the coat");
        ROUGHNESS: Number = key("roughness", UNIT_INTERVAL, Toml("0"), "the roughness of the coat");
    }
}

pub(in crate::scene) mod principled {
    use super::*;
    keys! {
        BASE_COLOR: Color = key("base_color", UNIT_COLOR, Required, "the colour of the diffuse part, of metal and of transmitted light");
        METALLIC: Number = key("metallic", UNIT_INTERVAL, Toml("0"), "the fraction that is metal");
        ROUGHNESS: Number = key("roughness", UNIT_INTERVAL, Toml("0.5"), "the roughness of metal, gloss and glass alike");
        SPECULAR: Number = key("specular", UNIT_INTERVAL, Toml("0.5"), "the strength of the gloss: 0.5 as given by ior, 1 twice that");
        IOR: Number = key("ior", COAT_IOR, Toml("1.5"), "index of refraction of gloss and glass");
        COAT: Number = key("coat", UNIT_INTERVAL, Toml("0"), "the strength of a clear coat");
        COAT_ROUGHNESS: Number = key("coat_roughness", UNIT_INTERVAL, Toml("0"), "the roughness of the coat");
        TRANSMISSION: Number = key("transmission", UNIT_INTERVAL, Toml("0"), "the fraction of the non-metal part that is glass");
    }
}

pub(in crate::scene) mod phong {
    use super::*;
    keys! {
        ALBEDO: Color = key("albedo", UNIT_COLOR, Required, "the diffuse albedo");
        SPECULAR: Color = key("specular", UNIT_COLOR, Required, "the specular albedo");
        EXPONENT: Number = key("exponent", Number(NumberRange::Closed(0.0, 1e5)), Required, "larger exponents give narrower highlights");
        NORMALIZED: Boolean = key("normalized", Boolean, Toml("true"), "whether the highlight is scaled to conserve energy");
    }
}

/// The reflection models, each with the keys that only it has.
pub(super) const TYPES: &[(&str, &[&dyn DynKey])] = &[
    (SurfaceKind::Diffuse.name(), diffuse::ALL),
    (SurfaceKind::Mirror.name(), mirror::ALL),
    (SurfaceKind::Conductor.name(), conductor::ALL),
    (SurfaceKind::Dielectric.name(), dielectric::ALL),
    (SurfaceKind::Plastic.name(), plastic::ALL),
    (SurfaceKind::Principled.name(), principled::ALL),
    (SurfaceKind::Phong.name(), phong::ALL),
];

impl SurfaceModel {
    /// Visits the keys of this model with their values.
    pub(in crate::scene) fn visit_keys(&mut self, visitor: &mut impl KeyVisitor) {
        match self {
            Self::Diffuse { albedo, roughness } => {
                visitor.visit(&diffuse::ALBEDO, albedo);
                visitor.visit(&diffuse::ROUGHNESS, roughness);
            }
            Self::Mirror { reflectance } => visitor.visit(&mirror::REFLECTANCE, reflectance),
            Self::Conductor { metal, roughness } => {
                visitor.visit(&conductor::IOR, &mut metal.ior);
                visitor.visit(&conductor::EXTINCTION, &mut metal.extinction);
                visitor.visit(&conductor::ROUGHNESS, roughness);
            }
            Self::Dielectric { ior, roughness, priority, absorption } => {
                visitor.visit(&dielectric::IOR, ior);
                visitor.visit(&dielectric::ROUGHNESS, roughness);
                visitor.visit(&dielectric::PRIORITY, priority);
                visitor.visit(&dielectric::ABSORPTION, absorption);
            }
            Self::Plastic { albedo, ior, roughness } => {
                visitor.visit(&plastic::ALBEDO, albedo);
                visitor.visit(&plastic::IOR, ior);
                visitor.visit(&plastic::ROUGHNESS, roughness);
            }
            Self::Principled(parameters) => {
                visitor.visit(&principled::BASE_COLOR, &mut parameters.base_color);
                visitor.visit(&principled::METALLIC, &mut parameters.metallic);
                visitor.visit(&principled::ROUGHNESS, &mut parameters.roughness);
                visitor.visit(&principled::SPECULAR, &mut parameters.specular);
                visitor.visit(&principled::IOR, &mut parameters.ior);
                visitor.visit(&principled::COAT, &mut parameters.coat);
                visitor.visit(&principled::COAT_ROUGHNESS, &mut parameters.coat_roughness);
                visitor.visit(&principled::TRANSMISSION, &mut parameters.transmission);
            }
            Self::Phong { albedo, specular, exponent, normalized } => {
                visitor.visit(&phong::ALBEDO, albedo);
                visitor.visit(&phong::SPECULAR, specular);
                visitor.visit(&phong::EXPONENT, exponent);
                visitor.visit(&phong::NORMALIZED, normalized);
            }
        }
    }
}
