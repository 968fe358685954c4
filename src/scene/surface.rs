//! The surfaces that a scene may describe, and the reflection models that are built from them.

use serde::{Deserialize, Serialize};

use crate::color::Rgb;
use crate::material::{
    Coat, Conductor, Dielectric, Diffuse, Metal, Mirror, Model, OrenNayar, Phong, Plastic,
    Principled, PrincipledParameters,
};
use crate::names::named_enum;

/// How far the sum of two shares may exceed 1 by rounding.
pub(super) const SHARE_ROUNDING: f32 = 1e-6;

/// Two shares of light that a surface sends on.
pub(super) struct AddedShares {
    /// Their keys.
    pub(super) keys: [&'static str; 2],
    /// Their sum in each channel.
    pub(super) sum: Rgb,
    /// What to do if that is more than 1.
    pub(super) help: &'static str,
}

/// What a material does with light.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "kebab-case", deny_unknown_fields)]
pub enum SurfaceModel {
    /// `type = "diffuse"`: Lambert, or Oren and Nayar.
    Diffuse {
        /// The share of light that is scattered, in `[0, 1]`.
        albedo: Rgb,
        /// From 0, Lambert, to 1, the flattest look.
        roughness: f64,
    },
    /// `type = "mirror"`.
    Mirror {
        /// The share of light that is reflected, in `[0, 1]`.
        reflectance: Rgb,
    },
    /// `type = "conductor"`: metal.
    Conductor {
        /// The complex index of refraction.
        metal: Metal,
        /// From 0, smooth, to 1; the square root of the microsurface's alpha.
        roughness: f64,
    },
    /// `type = "dielectric"`: glass.
    Dielectric {
        /// Index of refraction relative to vacuum.
        ior: f64,
        /// From 0, smooth, to 1; the square root of the microsurface's alpha.
        roughness: f64,
        /// Where glass spheres overlap, the higher priority fills the common part.
        priority: i32,
        /// What the inside absorbs, per unit length.
        absorption: Rgb,
    },
    /// `type = "plastic"`: a diffuse base under a clear coat.
    Plastic {
        /// The share of light that the base scatters.
        albedo: Rgb,
        /// Index of refraction of the coat, relative to what is around it.
        ior: f64,
        /// The coat's roughness, from 0, smooth, to 1.
        roughness: f64,
    },
    /// `type = "principled"`: a mixture of the others.
    Principled(PrincipledParameters),
    /// `type = "phong"`: the shading model of the paper's section 1.1, for teaching.
    Phong {
        /// The diffuse share.
        albedo: Rgb,
        /// The glossy share.
        specular: Rgb,
        /// How narrow the highlight is.
        exponent: f64,
        /// True if the lobe is scaled to conserve energy (Lafortune and Willems 1994) or left as
        /// Phong wrote it.
        normalized: bool,
    },
}

impl Default for SurfaceModel {
    /// Lambert's, scattering half of the light.
    fn default() -> Self {
        Self::Diffuse { albedo: Rgb::splat(0.5), roughness: 0.0 }
    }
}

impl SurfaceModel {
    /// The model of a kind where all of its keys are left out, required ones included.
    pub(super) fn with_defaults(kind: SurfaceKind) -> Self {
        let (black, roughness) = (Rgb::ZERO, 0.0);
        match kind {
            SurfaceKind::Diffuse => Self::Diffuse { albedo: black, roughness },
            SurfaceKind::Mirror => Self::Mirror { reflectance: black },
            SurfaceKind::Conductor => Self::Conductor { metal: Metal::NAMED[0].1, roughness },
            SurfaceKind::Dielectric => {
                Self::Dielectric { ior: 1.5, roughness, priority: 0, absorption: black }
            }
            SurfaceKind::Plastic => Self::Plastic { albedo: black, ior: 1.5, roughness },
            SurfaceKind::Principled => Self::Principled(PrincipledParameters::default()),
            SurfaceKind::Phong => {
                Self::Phong { albedo: black, specular: black, exponent: 0.0, normalized: true }
            }
        }
    }

    /// The index of refraction of the inside, if light can enter it.
    pub(super) fn ior(&self) -> Option<f64> {
        match self {
            Self::Dielectric { ior, .. } => Some(*ior),
            Self::Principled(parameters) => Some(parameters.ior),
            _ => None,
        }
    }

    /// What the inside absorbs per unit length.
    pub(super) fn absorption(&self) -> Rgb {
        match self {
            Self::Dielectric { absorption, .. } => *absorption,
            _ => Rgb::ZERO,
        }
    }

    /// The two shares of light that must not add up to more than 1, where there are two.
    pub(super) fn added_shares(&self) -> Option<AddedShares> {
        match *self {
            Self::Phong { albedo, specular, normalized: true, .. } => Some(AddedShares {
                keys: ["specular", "albedo"],
                sum: specular + albedo,
                help: "lower one of them, or set `normalized = false` for Phong's original form",
            }),
            _ => None,
        }
    }

    /// The largest colour that a row of a sphere table may have.
    pub(super) fn max_row_color(&self) -> [f32; 3] {
        match self {
            Self::Phong { specular, normalized: true, .. } => {
                specular.to_array().map(|share| 1.0 - share + SHARE_ROUNDING)
            }
            _ => [1.0; 3],
        }
    }

    /// The reflection model, in a scene whose media have these indices of refraction.
    pub(super) fn build(&self, media: &[f64]) -> Model {
        match *self {
            Self::Diffuse { albedo, roughness: 0.0 } => Model::Diffuse(Diffuse { albedo }),
            Self::Diffuse { albedo, roughness } => {
                Model::OrenNayar(OrenNayar { albedo, roughness })
            }
            Self::Mirror { reflectance } => Model::Mirror(Mirror { reflectance }),
            Self::Conductor { metal, roughness } => {
                Model::Conductor(Conductor::new(metal, roughness))
            }
            Self::Dielectric { ior, priority, roughness, .. } => {
                Model::Dielectric(Dielectric::new(ior, priority, roughness, media))
            }
            Self::Plastic { albedo, ior, roughness } => {
                Model::Plastic(Plastic { albedo, coat: Coat::new(ior, roughness) })
            }
            Self::Principled(parameters) => Model::Principled(Principled::new(parameters, media)),
            Self::Phong { albedo, specular, exponent, normalized } => {
                Model::Phong(Phong { albedo, specular, exponent, normalized })
            }
        }
    }
}

/// The reflection models without their parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SurfaceKind {
    /// [`SurfaceModel::Diffuse`].
    Diffuse,
    /// [`SurfaceModel::Mirror`].
    Mirror,
    /// [`SurfaceModel::Conductor`].
    Conductor,
    /// [`SurfaceModel::Dielectric`].
    Dielectric,
    /// [`SurfaceModel::Plastic`].
    Plastic,
    /// [`SurfaceModel::Principled`].
    Principled,
    /// [`SurfaceModel::Phong`].
    Phong,
}

named_enum! {
    SurfaceKind {
        Diffuse = "diffuse",
        Mirror = "mirror",
        Conductor = "conductor",
        Dielectric = "dielectric",
        Plastic = "plastic",
        Principled = "principled",
        Phong = "phong",
    }
}

impl SurfaceModel {
    /// The reflection model of this surface.
    pub fn kind(&self) -> SurfaceKind {
        match self {
            Self::Diffuse { .. } => SurfaceKind::Diffuse,
            Self::Mirror { .. } => SurfaceKind::Mirror,
            Self::Conductor { .. } => SurfaceKind::Conductor,
            Self::Dielectric { .. } => SurfaceKind::Dielectric,
            Self::Plastic { .. } => SurfaceKind::Plastic,
            Self::Principled(_) => SurfaceKind::Principled,
            Self::Phong { .. } => SurfaceKind::Phong,
        }
    }
}
