//! What spheres are made of: the materials of a scene, and what light finds on a sphere.

use std::ops::Deref;

use crate::color::Rgb;
use crate::geometry::Side;
use crate::material::{Boundary, Dielectric, Material, Medium, MediumStack, Model};
use crate::sampling::{exp, ln};

use super::description::MaterialDescription;

/// Minimum transmittance of coloured glass.
const MIN_TRANSMITTANCE: f64 = 1e-30;

/// The material of one sphere, with its own colour and emission.
#[derive(Clone, Copy, Debug)]
pub struct SphereMaterial<'a> {
    /// The material.
    pub material: EmissiveMaterial<'a>,
    /// The sphere's own colour, if a table gives one.
    pub albedo: Option<Rgb>,
    /// Absorption inside, per unit length.
    pub absorption: Rgb,
}

/// A material with the emission of one sphere, which may differ from that of the material: use
/// [`Self::emission`] rather than the field of the dereferenced [`Material`], which it hides.
#[derive(Clone, Copy, Debug)]
pub struct EmissiveMaterial<'a> {
    material: &'a Material,
    /// Emitted radiance, in W/(sr m^2) per channel: the sphere's own, if a table gives one.
    pub emission: Rgb,
}

impl<'a> EmissiveMaterial<'a> {
    pub(super) fn new(material: &'a Material, own_emission: Option<Rgb>) -> Self {
        Self { material, emission: own_emission.unwrap_or(material.emission) }
    }

    /// Returns true if the sphere emits light.
    pub fn is_emissive(&self) -> bool {
        self.emission.max_element() > 0.0
    }
}

impl Deref for EmissiveMaterial<'_> {
    type Target = Material;

    fn deref(&self) -> &Material {
        self.material
    }
}

/// The parts of a [`SphereMaterial`]: only references and what a table gives.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Surface<'a> {
    pub(crate) material: &'a Material,
    /// The sphere's own colour, if a table gives one.
    pub(crate) color: Option<Rgb>,
    /// The sphere's own emission, if a table gives one.
    pub(crate) emission: Option<Rgb>,
}

impl Surface<'_> {
    /// Emitted radiance, in W/(sr m^2) per channel.
    #[inline(always)]
    pub(crate) fn emission(&self) -> Rgb {
        self.emission.unwrap_or(self.material.emission)
    }
}

impl<'a> SphereMaterial<'a> {
    /// Combines a material with a sphere's own colour. For a pure dielectric, the colour is the
    /// transmittance along a diameter.
    pub(super) fn new(
        material: EmissiveMaterial<'a>,
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

    /// The medium inside the sphere; `None` if light cannot enter, or if the opacity is 0.
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

    /// Returns true if light passes this boundary in a straight line and undiminished: one that is
    /// hidden in another medium, or has media of the same index on both sides. A principled surface
    /// of the same index still tints light.
    pub fn is_straight(&self, boundary: &Boundary) -> bool {
        let is_matched = || matches!(self.material.model, Model::Dielectric(_));
        boundary.eta.is_none() || (boundary.eta == Some(1.0) && is_matched())
    }

    /// Returns the fraction of light from the far wall that passes the near one, and that fraction
    /// behind what a chord of mean length absorbs: `4 r / 3`. Of dielectrics, only those of index 1
    /// count, which are straight wherever no other medium is.
    pub(super) fn far_wall_fractions(&self, radius: f64) -> [f32; 2] {
        let opacity = self.material.opacity;
        match (&self.material.model, self.material.dielectric()) {
            (_, None) => [1.0 - opacity; 2],
            (Model::Dielectric(Dielectric { ior: 1.0, .. }), _) if opacity >= 1.0 => {
                let left = |absorption: f32| exp(-f64::from(absorption) * (4.0 / 3.0) * radius);
                let left = self.absorption.to_array().map(left);
                [1.0, (left.iter().sum::<f64>() / 3.0) as f32]
            }
            _ => [0.0; 2],
        }
    }

    /// Returns true if no light passes through the surface.
    pub fn is_opaque(&self) -> bool {
        self.material.opacity >= 1.0 && self.material.dielectric().is_none()
    }

    /// Probability that light arriving from `side` within `media` interacts with the sphere. A
    /// glass sphere is present or absent as a whole; that is decided on entry.
    pub fn opacity(&self, sphere: u32, side: Side, media: &MediumStack) -> f32 {
        let opacity = self.material.opacity;
        if opacity < 1.0 && side == Side::Inside && self.medium(sphere).is_some() {
            return if media.contains(sphere) { 1.0 } else { 0.0 };
        }
        opacity
    }
}

/// Builds the materials of a scene.
pub(super) fn build_materials(described: &[MaterialDescription]) -> Vec<Material> {
    let media = distinct_iors(described);
    described.iter().map(|named| build_material(named, &media)).collect()
}

/// The distinct indices of refraction of all media, vacuum first.
fn distinct_iors(described: &[MaterialDescription]) -> Vec<f64> {
    let mut indices = vec![1.0];
    for ior in described.iter().filter_map(|named| named.surface.ior()) {
        if !indices.contains(&ior) {
            indices.push(ior);
        }
    }
    indices
}

fn build_material(named: &MaterialDescription, media: &[f64]) -> Material {
    let MaterialDescription { name: _, surface, emission, opacity } = named;
    Material {
        model: surface.build(media),
        emission: *emission,
        opacity: *opacity as f32,
        absorption: surface.absorption(),
    }
}
