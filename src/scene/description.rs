//! A scene as plain values: what is to be seen, in the user's own units. Whoever builds a scene, a
//! program or the reader of scene files, fills these in; [`Scene::build`](super::Scene::build) checks them and
//! makes a scene of them. `docs/scene-format.md` explains the same keys to users.

use serde::{Deserialize, Serialize};

use crate::color::Rgb;
use crate::math::DVec3;
use crate::names::named_enum;

use super::data::SphereData;

pub use super::environment::{BackgroundDescription, EnvironmentDescription, SunDescription};
pub use super::surface::{SurfaceKind, SurfaceModel};

/// A scene: camera, background, materials and spheres.
///
/// How it is rendered (size, samples, integrator) is no part of it: see [`Settings`](super::Settings).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SceneDescription {
    /// Where the picture is seen from.
    pub camera: CameraDescription,
    /// What a ray sees that meets nothing.
    pub background: BackgroundDescription,
    /// The surfaces; spheres name them by their index here.
    pub materials: Vec<MaterialDescription>,
    /// Spheres one by one.
    pub spheres: Vec<SphereDescription>,
    /// Many spheres at once, from files or from memory.
    pub tables: Vec<SphereTable>,
}

/// `[camera]`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CameraDescription {
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
    pub projection: ProjectionDescription,
}

impl Default for CameraDescription {
    /// At (0, 0, 10), looking at the origin, with a pinhole of 36 degrees; y is up.
    fn default() -> Self {
        Self {
            position: DVec3::new(0.0, 0.0, 10.0),
            look_at: DVec3::ZERO,
            up: DVec3::Y,
            near: 0.0,
            projection: ProjectionDescription::default(),
        }
    }
}

/// How directions become places in the picture.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "kebab-case", deny_unknown_fields)]
pub enum ProjectionDescription {
    /// `type = "perspective"`.
    Perspective {
        /// The angle from the bottom to the top of the picture.
        vertical_fov_degrees: f64,
        /// `None` is a pinhole.
        lens: Option<LensDescription>,
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

impl Default for ProjectionDescription {
    /// A pinhole of 36 degrees.
    fn default() -> Self {
        Self::Perspective { vertical_fov_degrees: 36.0, lens: None }
    }
}

/// The projections without their numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ProjectionKind {
    /// [`ProjectionDescription::Perspective`].
    #[default]
    Perspective,
    /// [`ProjectionDescription::Orthographic`].
    Orthographic,
    /// [`ProjectionDescription::Panoramic`].
    Panoramic,
}

named_enum! {
    ProjectionKind {
        Perspective = "perspective",
        Orthographic = "orthographic",
        Panoramic = "panoramic",
    }
}

impl ProjectionDescription {
    /// The kind of this projection.
    pub fn kind(&self) -> ProjectionKind {
        match self {
            Self::Perspective { .. } => ProjectionKind::Perspective,
            Self::Orthographic { .. } => ProjectionKind::Orthographic,
            Self::Panoramic { .. } => ProjectionKind::Panoramic,
        }
    }
}

/// A thin lens.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LensDescription {
    /// Of its opening, in scene units.
    pub radius: f64,
    /// Along the view axis to the plane in focus: as said, or found by `focus_on`.
    pub focus_distance: f64,
    /// Corners of the opening; 0 for a disk.
    pub blades: u32,
    /// Turns the opening counter-clockwise, as seen in the picture's axes.
    pub rotation_degrees: f64,
}

/// `[materials.NAME]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MaterialDescription {
    /// The table's name.
    pub name: String,
    /// `type` and its keys.
    pub surface: SurfaceModel,
    /// Radiance that the surface sends out on both sides.
    pub emission: Rgb,
    /// The probability that the surface is there for light, in `[0, 1]`.
    pub opacity: f64,
}

impl Default for MaterialDescription {
    /// Grey and diffuse, without a name.
    fn default() -> Self {
        let surface = SurfaceModel::default();
        Self { name: String::new(), surface, emission: Rgb::ZERO, opacity: 1.0 }
    }
}

/// One `[[spheres]]`: a sphere of its own.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SphereDescription {
    /// Used in messages.
    pub name: Option<String>,
    /// Centre.
    pub center: DVec3,
    /// Radius, positive.
    pub radius: f64,
    /// Index into [`SceneDescription::materials`].
    pub material: usize,
}

/// One `[[sphere_tables]]`: many spheres of one material.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SphereTable {
    /// The name in the layers of Cryptomatte; see [`SceneDescription::name_of_table`] where there is none.
    pub name: Option<String>,
    /// Where the numbers are.
    pub data: SphereData,
    /// Index into [`SceneDescription::materials`].
    pub material: usize,
    /// `colors`: how the rows' colours are kept, where there are some.
    pub colors: ColorStorage,
}

/// How the colours of a table are kept in memory.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ColorStorage {
    /// As they are given, 12 bytes each.
    #[default]
    Exact,
    /// Rounded, in a third of the memory.
    Packed,
}

named_enum! { ColorStorage { Exact = "exact", Packed = "packed" } }

impl ColorStorage {
    /// Bytes that one colour takes in memory.
    pub fn bytes_per_color(self) -> usize {
        match self {
            Self::Exact => size_of::<[f32; 3]>(),
            Self::Packed => size_of::<u32>(),
        }
    }
}

impl SceneDescription {
    /// The name of a table: its own; or the name of its file without the folder; or `table 3` for the
    /// fourth table, where that is in memory.
    ///
    /// # Panics
    /// Panics where there is no table of that index.
    pub fn name_of_table(&self, index: usize) -> String {
        let SphereTable { name, data, .. } = &self.tables[index];
        let of_file = || match data {
            SphereData::File { path, .. } => {
                path.file_name().map(|name| name.to_string_lossy().into_owned())
            }
            SphereData::Memory(_) => None,
        };
        name.clone().or_else(of_file).unwrap_or_else(|| format!("table {index}"))
    }

    /// Brings values that mean the same into one form, in which they are rendered: a lens without an
    /// opening is a pinhole, and a place or an angle of -0 is 0.
    pub(super) fn make_canonical(&mut self) {
        let Self { camera, background, materials: _, spheres, tables: _ } = self;
        let CameraDescription { position, look_at, up, near: _, projection } = camera;
        if let ProjectionDescription::Perspective { lens, .. } = projection {
            *lens = lens.filter(|lens| lens.radius > 0.0);
            if let Some(lens) = lens {
                lens.rotation_degrees += 0.0;
            }
        }
        let BackgroundDescription { dome, up: zenith, sun, .. } = background;
        if let EnvironmentDescription::Image { rotation_degrees, .. } = dome {
            *rotation_degrees += 0.0;
        }
        let sun = sun.as_mut().map(|sun| &mut sun.direction);
        let centers = spheres.iter_mut().map(|sphere| &mut sphere.center);
        let vectors = [position, look_at, up, zenith].into_iter().chain(sun).chain(centers);
        vectors.for_each(|vector| *vector += 0.0);
    }
}

/// The direction of a vector however long or short, if it has one.
pub(crate) fn normalize_robust(v: DVec3) -> Option<DVec3> {
    (v / v.abs().max_element()).try_normalize()
}
