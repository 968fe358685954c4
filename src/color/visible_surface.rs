//! The first visible surface of a camera ray, for AOVs.

use glam::Vec3;

use super::Rgb;

/// The first surface that a sample sees, after opacity tests. For a mirror or glass this is the
/// surface itself, not what is seen in it or through it, except for denoising.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VisibleSurface {
    /// Directly visible radiance, without any scattering, reflection or refraction: emitters and
    /// the environment.
    pub emission: Rgb,
    /// Colour of the surface's material, in `[0, 1]`; black on a miss.
    pub albedo: Rgb,
    /// Unit normal on the visible side; 0 on a miss.
    pub normal: Vec3,
    /// Distance along the camera ray, in scene units; 0 on a miss.
    pub distance: f32,
    /// Position in the scene's coordinates; 0 on a miss.
    pub position: Vec3,
    /// Row of the sphere in the scene; [`NO_ROW`] on a miss.
    pub row: u32,
    /// Colour of the first surface that is no mirror or smooth glass, as seen in those before it,
    /// in `[0, 1]`; that of the mirrors alone if there is none behind them.
    pub denoising_albedo: Rgb,
    /// Unit normal of that surface, or of the last mirror or glass.
    pub denoising_normal: Vec3,
    /// True while the path has met only mirrors and smooth glass.
    pub sees_through: bool,
}

/// The row that means "no sphere".
pub const NO_ROW: u32 = u32::MAX;

impl VisibleSurface {
    /// The record of a ray that misses.
    pub const NONE: Self = Self {
        emission: Rgb::ZERO,
        albedo: Rgb::ZERO,
        normal: Vec3::ZERO,
        distance: 0.0,
        position: Vec3::ZERO,
        row: NO_ROW,
        denoising_albedo: Rgb::ZERO,
        denoising_normal: Vec3::ZERO,
        sees_through: false,
    };

    /// Returns true if a surface is visible.
    pub fn is_surface(&self) -> bool {
        self.row != NO_ROW
    }
}

impl Default for VisibleSurface {
    fn default() -> Self {
        Self::NONE
    }
}
