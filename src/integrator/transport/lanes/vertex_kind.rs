//! The kinds of surfaces that are shaded together.

use crate::material::Model;
use crate::sampling::Hemisphere;

/// A kind of surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum VertexKind {
    /// Lambertian, sampled by the cosine.
    Diffuse,
    Mirror,
    /// A dielectric without microfacets.
    SmoothDielectric,
    /// All others.
    Other,
}

impl VertexKind {
    pub(super) const COUNT: usize = 4;
    pub(super) const ALL: [Self; Self::COUNT] =
        [Self::Diffuse, Self::Mirror, Self::SmoothDielectric, Self::Other];

    pub(super) fn of_model(model: &Model, hemisphere: Hemisphere) -> Self {
        match model {
            Model::Diffuse(_) if hemisphere == Hemisphere::Cosine => Self::Diffuse,
            Model::Mirror(_) => Self::Mirror,
            Model::Dielectric(glass) if glass.is_smooth() => Self::SmoothDielectric,
            _ => Self::Other,
        }
    }

    /// Returns true if surfaces of this kind may sample lights.
    pub(super) fn samples_lights(self) -> bool {
        matches!(self, Self::Diffuse | Self::Other)
    }
}
