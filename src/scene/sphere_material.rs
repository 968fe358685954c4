//! What spheres are made of: from the description of a material to its model, and from a sphere to
//! what light finds there.

use crate::color::Rgb;
use crate::geometry::Side;
use crate::material::{
    Coat, Conductor, Dielectric, Diffuse, Material, Medium, MediumStack, Mirror, Model, OrenNayar,
    Phong, Plastic, Principled,
};
use crate::sampling::ln;

use super::description::{MaterialDescription, SurfaceModel as Described};

/// The least light that is left behind coloured glass.
const MIN_TRANSMITTANCE: f64 = 1e-30;

/// What a sphere is made of.
#[derive(Clone, Copy, Debug)]
pub struct SphereMaterial<'a> {
    /// Its material.
    pub material: &'a Material,
    /// Its own colour, where a table gives one.
    pub albedo: Option<Rgb>,
    /// What its inside absorbs per unit length.
    pub absorption: Rgb,
}

impl<'a> SphereMaterial<'a> {
    /// A sphere of a material, with its own colour where it has one. The colour of a ball of nothing
    /// but glass is that of light which has crossed it along a diameter.
    pub(super) fn new(
        material: &'a Material,
        color: Option<Rgb>,
        radius: impl Fn() -> f64,
    ) -> Self {
        let absorption = match (&material.model, color) {
            (Model::Dielectric(_), Some(color)) => {
                let per_length = 0.5 / radius();
                let of =
                    |left: f32| (-ln(f64::from(left).max(MIN_TRANSMITTANCE)) * per_length) as f32;
                Rgb::from_array(color.to_array().map(of))
            }
            _ => material.absorption,
        };
        Self { material, albedo: color, absorption }
    }

    /// The medium inside a sphere that light can enter; `None` for others, and for a sphere that is
    /// never there.
    pub fn medium(&self, sphere: u32) -> Option<Medium> {
        let glass = self.material.dielectric().filter(|_| self.material.opacity > 0.0);
        let of = |&Dielectric { ior, priority, .. }: &Dielectric| Medium {
            sphere,
            priority,
            ior,
            absorption: self.absorption,
        };
        glass.map(of)
    }

    /// The probability that this sphere is there for light that meets it from `side` in `media`.
    /// Glass is there as a whole or not at all: that is decided where it is entered.
    pub fn opacity(&self, sphere: u32, side: Side, media: &MediumStack) -> f32 {
        let opacity = self.material.opacity;
        if opacity < 1.0 && side == Side::Inside && self.medium(sphere).is_some() {
            return if media.contains(sphere) { 1.0 } else { 0.0 };
        }
        opacity
    }
}

/// The materials of a scene.
pub(super) fn build_materials(described: &[MaterialDescription]) -> Vec<Material> {
    let media = distinct_iors(described);
    described.iter().map(|named| build_material(named, &media)).collect()
}

/// The indices of refraction of all media, vacuum first, each once.
fn distinct_iors(described: &[MaterialDescription]) -> Vec<f64> {
    let mut indices = vec![1.0];
    for named in described {
        let ior = match named.surface {
            Described::Dielectric { ior, .. } => ior,
            Described::Principled(parameters) => parameters.ior,
            _ => continue,
        };
        if !indices.contains(&ior) {
            indices.push(ior);
        }
    }
    indices
}

fn build_material(named: &MaterialDescription, media: &[f64]) -> Material {
    let model = match named.surface {
        Described::Diffuse { albedo, roughness: 0.0 } => Model::Diffuse(Diffuse { albedo }),
        Described::Diffuse { albedo, roughness } => {
            Model::OrenNayar(OrenNayar { albedo, roughness })
        }
        Described::Mirror { reflectance } => Model::Mirror(Mirror { reflectance }),
        Described::Conductor { metal, roughness } => {
            Model::Conductor(Conductor::new(metal, roughness))
        }
        Described::Dielectric { ior, priority, roughness, .. } => {
            Model::Dielectric(Dielectric::new(ior, priority, roughness, media))
        }
        Described::Plastic { albedo, ior, roughness } => {
            Model::Plastic(Plastic { albedo, coat: Coat::new(ior, roughness) })
        }
        Described::Principled(parameters) => Model::Principled(Principled::new(parameters, media)),
        Described::Phong { albedo, specular, exponent, normalized } => {
            Model::Phong(Phong { albedo, specular, exponent, normalized })
        }
    };
    let absorption = match named.surface {
        Described::Dielectric { absorption, .. } => absorption,
        _ => Rgb::ZERO,
    };
    Material { model, emission: named.emission, opacity: named.opacity as f32, absorption }
}
