//! What a camera ray meets first, for the layers that show that.

use glam::Vec3;

use super::Rgb;

/// The first thing that a sample sees: a surface that is there, be it a mirror or glass, whose own
/// place and look this is, and not that of what is seen in it or through it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VisibleSurface {
    /// Radiance that the camera sees straight, without any scattering, mirror or refraction: lamps and
    /// the background.
    pub emission: Rgb,
    /// The colour of the surface's material, in `[0, 1]`; black for nothing.
    pub albedo: Rgb,
    /// The unit normal on the side that is seen; 0 for nothing.
    pub normal: Vec3,
    /// Along the camera ray, in scene units; 0 for nothing.
    pub distance: f32,
    /// In the scene's coordinates; 0 for nothing.
    pub position: Vec3,
    /// The sphere, by its row in the scene; [`NO_ROW`] for nothing.
    pub row: u32,
}

/// The row of what is not there.
pub const NO_ROW: u32 = u32::MAX;

impl VisibleSurface {
    /// A ray that meets nothing.
    pub const NONE: Self = Self {
        emission: Rgb::ZERO,
        albedo: Rgb::ZERO,
        normal: Vec3::ZERO,
        distance: 0.0,
        position: Vec3::ZERO,
        row: NO_ROW,
    };

    /// Whether a surface is seen.
    pub fn is_surface(&self) -> bool {
        self.row != NO_ROW
    }
}

impl Default for VisibleSurface {
    fn default() -> Self {
        Self::NONE
    }
}
