//! Materials and BSDFs: one file per model, each with eval, sample and pdf.
//!
//! A [`Material`] is a surface as the scene describes it. At a point it becomes a [`Bsdf`], a
//! function of two directions in the local frame there: z is the normal on the side of `wo`; `wo`
//! points to the previous vertex, `wi` is sampled, both are unit vectors leaving the surface.
//! `eval` is the BSDF without the cosine; pdfs are per solid angle.

mod coat;
mod conductor;
mod dielectric;
mod diffuse;
mod energy_compensation;
mod fresnel;
mod ggx;
mod medium_stack;
mod metals;
mod mirror;
mod named_iors;
mod oren_nayar;
mod phong;
mod plastic;
mod principled;
mod sample;

pub use coat::Coat;
pub use conductor::{Conductor, ConductorBsdf, fresnel_conductor};
pub use dielectric::{Dielectric, DielectricBsdf};
pub use diffuse::Diffuse;
pub use energy_compensation::{
    DielectricCompensation, DielectricCompensationSide, EnergyCompensation,
};
pub use fresnel::fresnel;
pub use ggx::{Ggx, half_vector};
pub use medium_stack::{Boundary, Crossing, Medium, MediumStack};
pub use metals::Metal;
pub use mirror::Mirror;
pub use named_iors::NAMED_IORS;
pub use oren_nayar::OrenNayar;
pub use phong::Phong;
pub use plastic::{Plastic, PlasticBsdf};
pub use principled::{Principled, PrincipledBsdf, PrincipledParameters};
pub use sample::{BsdfSample, ExtraUniforms, Lobe};

use crate::color::Rgb;
use crate::math::DVec3;
use crate::sampling::Hemisphere;

/// A surface as the scene describes it. Scatters and emits on both sides of a sphere.
#[derive(Clone, Debug)]
pub struct Material {
    /// The reflection model with its parameters.
    pub model: Model,
    /// Emitted radiance, in W/(sr m^2) per channel.
    pub emission: Rgb,
    /// The probability that light interacts with the surface rather than passing straight through,
    /// in `[0, 1]`.
    pub opacity: f32,
    /// Absorption inside a dielectric per unit length: the Beer-Lambert coefficient.
    pub absorption: Rgb,
}

/// The reflection models.
#[derive(Clone, Debug)]
pub enum Model {
    /// Lambertian diffuse.
    Diffuse(Diffuse),
    /// A rough diffuse surface.
    OrenNayar(OrenNayar),
    /// A perfect mirror.
    Mirror(Mirror),
    /// Metal.
    Conductor(Conductor),
    /// A dielectric such as glass.
    Dielectric(Dielectric),
    /// A diffuse base under a clear coat.
    Plastic(Plastic),
    /// A mixture of the other models.
    Principled(Principled),
    /// Phong's shading model.
    Phong(Phong),
}

/// A material at a point: scatters light from `wi` to `wo`.
#[derive(Clone, Copy, Debug)]
pub enum Bsdf<'a> {
    /// Lambertian diffuse, with its sampling method.
    Diffuse(Diffuse, Hemisphere),
    /// A rough diffuse surface, with its sampling method.
    OrenNayar(OrenNayar, Hemisphere),
    /// A perfect mirror.
    Mirror(Mirror),
    /// Metal.
    Conductor(ConductorBsdf<'a>),
    /// An interface between transparent media.
    Dielectric(DielectricBsdf<'a>),
    /// A diffuse base under a clear coat.
    Plastic(PlasticBsdf<'a>),
    /// A mixture of the other models.
    Principled(PrincipledBsdf<'a>),
    /// Phong's shading model.
    Phong(Phong),
}

impl From<Model> for Material {
    /// Creates an opaque, non-emissive material.
    fn from(model: Model) -> Self {
        Self { model, emission: Rgb::ZERO, opacity: 1.0, absorption: Rgb::ZERO }
    }
}

impl Material {
    /// Returns the BSDF at a point. `albedo` is the sphere's own colour, if it has one; `eta` is
    /// the index of refraction beyond the surface over the index on this side; `hemisphere` selects
    /// how diffuse directions are sampled.
    pub fn bsdf(&self, albedo: Option<Rgb>, eta: f64, hemisphere: Hemisphere) -> Bsdf<'_> {
        match &self.model {
            Model::Diffuse(diffuse) => Bsdf::Diffuse(diffuse.with_color(albedo), hemisphere),
            Model::OrenNayar(rough) => Bsdf::OrenNayar(rough.with_color(albedo), hemisphere),
            Model::Mirror(mirror) => Bsdf::Mirror(mirror.with_color(albedo)),
            Model::Conductor(conductor) => Bsdf::Conductor(conductor.bsdf(albedo)),
            Model::Dielectric(dielectric) => Bsdf::Dielectric(dielectric.bsdf(eta)),
            Model::Plastic(plastic) => Bsdf::Plastic(plastic.bsdf(albedo)),
            Model::Principled(principled) => Bsdf::Principled(principled.bsdf(albedo, eta)),
            Model::Phong(phong) => Bsdf::Phong(phong.with_color(albedo)),
        }
    }

    /// Returns the surface's own colour, in `[0, 1]`, for AOVs and denoisers: the albedo or
    /// reflectance, for metal the reflectance at normal incidence, and white for glass. `albedo` is
    /// the sphere's own colour, if it has one.
    pub fn base_color(&self, albedo: Option<Rgb>) -> Rgb {
        match &self.model {
            Model::Diffuse(diffuse) => diffuse.with_color(albedo).albedo,
            Model::OrenNayar(rough) => rough.with_color(albedo).albedo,
            Model::Mirror(mirror) => mirror.with_color(albedo).reflectance,
            Model::Conductor(conductor) => conductor.bsdf(albedo).reflectance(1.0),
            Model::Dielectric(_) => Rgb::ONE,
            Model::Plastic(plastic) => albedo.unwrap_or(plastic.albedo),
            Model::Principled(principled) => albedo.unwrap_or(principled.base_color()),
            Model::Phong(phong) => {
                let Phong { albedo, specular, .. } = phong.with_color(albedo);
                (albedo + specular).min(Rgb::ONE)
            }
        }
    }

    /// Returns the maximum directional albedo: 1 or less, except for the classic form of Phong's
    /// model, which does not conserve energy.
    pub fn max_albedo(&self) -> Rgb {
        match &self.model {
            Model::Phong(phong) => phong.max_albedo(),
            _ => Rgb::ONE,
        }
    }

    /// Returns the dielectric that fills a sphere of this material, if light may enter it.
    pub fn dielectric(&self) -> Option<&Dielectric> {
        match &self.model {
            Model::Dielectric(glass) => Some(glass),
            Model::Principled(principled) => principled.dielectric(),
            _ => None,
        }
    }

    /// Returns true if the surface emits light.
    pub fn is_emissive(&self) -> bool {
        self.emission.max_element() > 0.0
    }
}

impl Bsdf<'_> {
    /// Evaluates the BSDF without the cosine. Delta lobes are left out.
    pub fn eval(&self, wo: DVec3, wi: DVec3) -> Rgb {
        match self {
            Self::Diffuse(diffuse, _) => diffuse.eval(wi),
            Self::OrenNayar(rough, _) => rough.eval(wo, wi),
            Self::Phong(phong) => phong.eval(wo, wi),
            Self::Plastic(plastic) => plastic.eval(wo, wi),
            Self::Conductor(conductor) => conductor.eval(wo, wi),
            Self::Dielectric(interface) => Rgb::splat(interface.eval(wo, wi) as f32),
            Self::Principled(principled) => principled.eval(wo, wi),
            Self::Mirror(_) => Rgb::ZERO,
        }
    }

    /// Returns the pdf with which [`Self::sample`] samples `wi`. Delta lobes are left out.
    pub fn pdf(&self, wo: DVec3, wi: DVec3) -> f64 {
        match self {
            Self::Diffuse(_, hemisphere) | Self::OrenNayar(_, hemisphere) => {
                diffuse::pdf(*hemisphere, wi)
            }
            Self::Phong(phong) => phong.pdf(wo, wi),
            Self::Plastic(plastic) => plastic.pdf(wo, wi),
            Self::Conductor(conductor) => conductor.pdf(wo, wi),
            Self::Dielectric(interface) => interface.pdf(wo, wi),
            Self::Principled(principled) => principled.pdf(wo, wi),
            Self::Mirror(_) => 0.0,
        }
    }

    /// Samples a direction, from `u_lobe` and `u` in `[0, 1)`; `None` if no light can come from it.
    /// `extra` returns a second pair of numbers in `[0, 1)`, always the same, for surfaces whose
    /// first pair may be consumed by a facet that scatters no light out.
    pub fn sample(
        &self,
        wo: DVec3,
        u_lobe: f64,
        u: [f64; 2],
        extra: ExtraUniforms<'_>,
    ) -> Option<BsdfSample> {
        match self {
            Self::Diffuse(diffuse, hemisphere) => diffuse.sample(*hemisphere, u),
            Self::OrenNayar(rough, hemisphere) => rough.sample(*hemisphere, wo, u),
            Self::Mirror(mirror) => Some(mirror.sample(wo)),
            Self::Dielectric(interface) => interface.sample(wo, u_lobe, u, extra),
            Self::Principled(principled) => principled.sample(wo, u_lobe, u, extra),
            Self::Phong(phong) => phong.sample(wo, u_lobe, u),
            Self::Plastic(plastic) => plastic.sample(wo, u_lobe, u),
            Self::Conductor(conductor) => conductor.sample(wo, u_lobe, u, extra),
        }
    }

    /// Returns true if light may be transmitted from behind the surface in a non-delta lobe.
    pub fn is_rough_transmissive(&self) -> bool {
        match self {
            Self::Dielectric(interface) => !interface.is_delta(),
            Self::Principled(principled) => principled.is_rough_transmissive(),
            _ => false,
        }
    }

    /// Returns true if the surface is Lambertian and sampled by the cosine.
    pub fn is_lambertian(&self) -> bool {
        matches!(self, Self::Diffuse(_, Hemisphere::Cosine))
    }

    /// Returns true if [`Self::sample`] uses `u_lobe`.
    pub fn needs_lobe_sample(&self) -> bool {
        !matches!(self, Self::Diffuse(..) | Self::OrenNayar(..) | Self::Mirror(_))
    }

    /// Returns true if there are only delta lobes, so that light sampling does not apply.
    pub fn is_delta(&self) -> bool {
        match self {
            Self::Mirror(_) => true,
            Self::Dielectric(interface) => interface.is_delta(),
            Self::Principled(principled) => principled.is_delta(),
            Self::Conductor(conductor) => conductor.is_delta(),
            Self::Diffuse(..) | Self::OrenNayar(..) | Self::Plastic(_) | Self::Phong(_) => false,
        }
    }
}
