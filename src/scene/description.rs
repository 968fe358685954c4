//! What the user wrote, as plain data: every key of a scene file, in its own units, with the
//! defaults filled in and nothing else changed. `docs/scene-format.md` is the reference for users.

use std::path::PathBuf;

use crate::color::Rgb;
use crate::math::DVec3;

pub use crate::sampling::{FilterKind, Hemisphere};

/// A whole scene file.
#[derive(Clone, Debug, PartialEq)]
pub struct Description {
    /// `[image]`.
    pub image: Image,
    /// `[camera]`.
    pub camera: Camera,
    /// `[background]`, `radiance`: what a ray sees that meets nothing.
    pub background: Rgb,
    /// `[materials.NAME]`, in the order of the file.
    pub materials: Vec<NamedMaterial>,
    /// `[[spheres]]`.
    pub spheres: Vec<SphereRow>,
    /// `[[sphere_tables]]`.
    pub tables: Vec<SphereTable>,
    /// `[render]`.
    pub render: Render,
}

/// `[image]`: the picture's size and the pixel's weight function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Image {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// The pixel's weight h(p).
    pub filter: FilterKind,
    /// Half the filter's extent in pixels.
    pub filter_radius: f64,
}

/// `[camera]`: a pinhole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Where the pinhole is.
    pub position: DVec3,
    /// A point in the middle of the picture.
    pub look_at: DVec3,
    /// The direction that is up in the picture.
    pub up: DVec3,
    /// The angle from the bottom to the top of the picture.
    pub vertical_fov_degrees: f64,
    /// Camera rays start where their depth along the view axis is this.
    pub near: f64,
}

/// `[materials.NAME]`.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedMaterial {
    /// The table's name.
    pub name: String,
    /// `type` and its keys.
    pub surface: Surface,
    /// Radiance that the surface sends out on both sides.
    pub emission: Rgb,
}

/// What a material does with light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Surface {
    /// `type = "diffuse"`: Lambert.
    Diffuse {
        /// The share of light that is scattered, in `[0, 1]`.
        albedo: Rgb,
    },
    /// `type = "mirror"`.
    Mirror {
        /// The share of light that is reflected, in `[0, 1]`.
        reflectance: Rgb,
    },
    /// `type = "dielectric"`: smooth glass.
    Dielectric {
        /// Index of refraction relative to vacuum.
        ior: f64,
        /// Where glass spheres overlap, the higher priority fills the common part.
        priority: i32,
    },
    /// `type = "phong"`: the shading model of the paper's section 1.1, for teaching.
    Phong {
        /// The diffuse share.
        albedo: Rgb,
        /// The glossy share.
        specular: Rgb,
        /// How narrow the highlight is.
        exponent: f64,
        /// Whether the lobe is scaled to conserve energy (Lafortune and Willems 1994) or left as
        /// Phong wrote it.
        normalized: bool,
    },
}

/// One `[[spheres]]`.
#[derive(Clone, Debug, PartialEq)]
pub struct SphereRow {
    /// Used in messages.
    pub name: Option<String>,
    /// Centre.
    pub center: DVec3,
    /// Radius, positive.
    pub radius: f64,
    /// Index into [`Description::materials`].
    pub material: usize,
}

/// One `[[sphere_tables]]`: many spheres from one file of raw little-endian f32 rows.
#[derive(Clone, Debug, PartialEq)]
pub struct SphereTable {
    /// The file, already joined to the scene's folder.
    pub file: PathBuf,
    /// What each f32 of a row is.
    pub columns: Vec<Column>,
    /// Index into [`Description::materials`].
    pub material: usize,
}

/// A column of a sphere table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Column {
    /// Centre, x.
    X,
    /// Centre, y.
    Y,
    /// Centre, z.
    Z,
    /// Radius.
    Radius,
    /// Linear albedo, red.
    Red,
    /// Linear albedo, green.
    Green,
    /// Linear albedo, blue.
    Blue,
}

impl Column {
    /// What the columns are called in scene files.
    pub const NAMES: [(&'static str, Self); 7] = [
        ("x", Self::X),
        ("y", Self::Y),
        ("z", Self::Z),
        ("radius", Self::Radius),
        ("r", Self::Red),
        ("g", Self::Green),
        ("b", Self::Blue),
    ];

    /// Whether the column is one of the three channels of a colour.
    pub fn is_color(self) -> bool {
        matches!(self, Self::Red | Self::Green | Self::Blue)
    }
}

/// `[render]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Render {
    /// `integrator`, with the keys of its own table.
    pub integrator: Integrator,
    /// Samples of each pixel.
    pub samples_per_pixel: u32,
    /// The longest path, in edges: 1 is lamps seen directly, 2 direct light. `None`: no limit.
    pub max_depth: Option<u32>,
    /// Chooses the random numbers.
    pub seed: u64,
}

/// The estimators.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Integrator {
    /// `"path"`: next-event estimation and hemisphere sampling, combined.
    Path,
    /// `"paper"`: the paper's own, lamps found by chance.
    Paper(Paper),
    /// `"raycast"`: one ray and a shading model, the paper's starting point.
    Raycast {
        /// Whether lamps cast shadows.
        shadows: bool,
    },
}

/// `[render.paper]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Paper {
    /// Sub-pixels along each side of a pixel, k.
    pub subpixels: u32,
    /// Paths of each sub-pixel, N.
    pub samples: u32,
    /// How directions over the hemisphere are drawn.
    pub hemisphere: Hemisphere,
    /// When a path ends.
    pub stop: Stop,
    /// What becomes of a camera ray that meets nothing.
    pub miss: Miss,
    /// The size of the random shift in a sub-pixel: 1 covers it, 0 stays at its centre.
    pub jitter: f64,
}

/// When a path ends, beside `max_depth`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Stop {
    /// Russian roulette: unbiased.
    #[default]
    Roulette,
    /// At `max_depth` only: biased by what longer paths carry.
    Depth,
    /// When the largest component of the path's weight falls below this: biased.
    Threshold(f64),
}

/// What becomes of a camera ray that meets nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Miss {
    /// It sees the background.
    #[default]
    Background,
    /// It is drawn again, as the paper's text says: biased at silhouettes.
    Redraw,
}
