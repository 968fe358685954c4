//! What the user wrote, as plain data: every key of a scene file, in its own units, with the
//! defaults filled in and nothing else changed. `docs/scene-format.md` is the reference for users.

use std::path::PathBuf;

use crate::color::Rgb;
use crate::material::{Metal, PrincipledParameters};
use crate::math::DVec3;

pub use crate::light::LightChoice;
pub use crate::sampling::{FilterKind, Hemisphere, SamplerKind};

/// A whole scene file.
#[derive(Clone, Debug, PartialEq)]
pub struct Description {
    /// `[image]`.
    pub image: Image,
    /// `[camera]`.
    pub camera: Camera,
    /// `[background]`: what a ray sees that meets nothing.
    pub background: Background,
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
    /// The part that is rendered; `None` is all of it.
    pub crop: Option<Window>,
    /// The pixel's weight h(p).
    pub filter: FilterKind,
    /// Half the filter's extent in pixels.
    pub filter_radius: f64,
}

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// Its first column.
    pub x: u32,
    /// Its first row.
    pub y: u32,
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
}

impl Image {
    /// The part of the picture that is rendered.
    pub fn window(&self) -> Window {
        let Self { width, height, .. } = *self;
        self.crop.unwrap_or(Window { x: 0, y: 0, width, height })
    }
}

/// `[camera]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Where the camera is: the middle of the lens or of the picture's plane.
    pub position: DVec3,
    /// A point in the middle of the picture.
    pub look_at: DVec3,
    /// The direction that is up in the picture.
    pub up: DVec3,
    /// Camera rays start where their depth along the view axis is this; in a panorama, their
    /// distance.
    pub near: f64,
    /// `type` and its keys.
    pub projection: Projection,
}

/// How directions become places in the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// `type = "perspective"`.
    Perspective {
        /// The angle from the bottom to the top of the picture.
        vertical_fov_degrees: f64,
        /// `None` is a pinhole.
        lens: Option<Lens>,
    },
    /// `type = "orthographic"`: parallel rays.
    Orthographic {
        /// What fits between the bottom and the top of the picture, in scene units.
        height: f64,
    },
    /// `type = "panoramic"`: columns are longitudes, rows are latitudes.
    Panoramic {
        /// The angle from the left to the right of the picture.
        horizontal_degrees: f64,
        /// The angle from the bottom to the top.
        vertical_degrees: f64,
    },
}

/// A thin lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// Of its opening, in scene units.
    pub radius: f64,
    /// Along the view axis to the plane in focus: as said, or found by `focus_on`.
    pub focus_distance: f64,
    /// Corners of the opening; 0 for a disk.
    pub blades: u32,
    /// Turns the opening counter-clockwise, as seen in the picture's axes.
    pub rotation_degrees: f64,
}

/// `[background]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Background {
    /// Light from all directions.
    pub dome: Dome,
    /// The unit direction of the zenith.
    pub up: DVec3,
    /// `[background.sun]`.
    pub sun: Option<Sun>,
    /// Whether camera rays that meet nothing see the background, or black.
    pub camera_visible: bool,
    /// Whether pictures have an alpha channel that is 0 where camera rays meet nothing.
    pub transparent: bool,
}

/// The light of the background.
#[derive(Clone, Debug, PartialEq)]
pub enum Dome {
    /// `radiance`: the same from everywhere.
    Constant {
        /// W/(sr m^2).
        radiance: Rgb,
    },
    /// `[background.gradient]`: linear in the sine of the elevation.
    Gradient {
        /// From above.
        zenith: Rgb,
        /// From the sides.
        horizon: Rgb,
        /// From below.
        nadir: Rgb,
    },
    /// `[background.image]`: a picture in latitude and longitude.
    Image {
        /// The file, already joined to the scene's folder.
        file: PathBuf,
        /// Turns it about `up`, counterclockwise when seen from above.
        rotation_degrees: f64,
        /// A factor on its radiance.
        scale: f64,
    },
    /// `[background.sky]`: a clear sky.
    Sky {
        /// The air's turbidity, from 2 to 10.
        turbidity: f64,
        /// The albedo of the ground below the horizon.
        ground_albedo: Rgb,
        /// A factor on its radiance.
        scale: f64,
    },
}

/// `[background.sun]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sun {
    /// Unit direction towards it.
    pub direction: DVec3,
    /// How wide it is seen.
    pub angular_diameter_degrees: f64,
    /// W/m^2 on a surface that faces it.
    pub irradiance: Rgb,
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
    /// The probability that the surface is there for light, in `[0, 1]`.
    pub opacity: f64,
}

/// What a material does with light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Surface {
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
        /// Its complex index of refraction.
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
    /// `type = "plastic"`: a matt base under a clear coat.
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
    /// `colors`: how the rows' colours are kept, where there are some.
    pub colors: ColorStorage,
}

/// How the colours of a table are kept in memory.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ColorStorage {
    /// `"exact"`: as they are in the file.
    #[default]
    Exact,
    /// `"packed"`: rounded, in a third of the memory.
    Packed,
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
    /// How lights are found by `path` and `direct`.
    pub estimator: Estimator,
    /// Samples of each pixel.
    pub samples_per_pixel: u32,
    /// The longest path, in edges: 1 is lamps seen directly, 2 direct light. `None`: no limit.
    pub max_depth: Option<u32>,
    /// The most that one path may add to a channel of indirect light, in W/(sr m^2): biased.
    /// `None`: no limit.
    pub clamp_indirect: Option<f64>,
    /// Chooses the random numbers.
    pub seed: u64,
    /// How random numbers are spread over a pixel's samples.
    pub sampler: SamplerKind,
    /// `light_choice`: which lamp a point aims at.
    pub light_choice: LightChoice,
}

/// The estimators.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Integrator {
    /// `"path"`: next-event estimation and hemisphere sampling, combined.
    Path,
    /// `"direct"`: the same for light that was scattered once at most.
    Direct,
    /// `"ambient-occlusion"`: how open each point is.
    AmbientOcclusion {
        /// How near things must be to count; may be infinite.
        distance: f64,
    },
    /// `"normals"`: the normals as colours.
    Normals,
    /// `"paper"`: the paper's own, lamps found by chance.
    Paper(Paper),
    /// `"raycast"`: one ray and a shading model, the paper's starting point.
    Raycast {
        /// Whether lamps cast shadows.
        shadows: bool,
    },
}

/// How lights are found. All give the same mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Estimator {
    /// `"mis"`: aimed at and met by chance, combined by multiple importance sampling.
    #[default]
    Mis,
    /// `"light"`: aimed at only, where they can be.
    Light,
    /// `"bsdf"`: met by chance only.
    Bsdf,
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
