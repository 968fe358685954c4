//! A scene description: plain values in the user's units, filled in by a program or by the scene
//! file reader. [`Scene::build`](super::Scene::build) validates a description and builds a scene
//! from it. `docs/scene-format.md` explains the corresponding keys.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::color::Rgb;
use crate::math::DVec3;
use crate::names::named_enum;

use super::data::SphereData;

pub use super::environment::{BackgroundDescription, EnvironmentDescription, SunDescription};
pub use super::surface::{SurfaceKind, SurfaceModel};

/// A scene: camera, background, materials and spheres.
///
/// Size, samples and integrator belong to [`Settings`](super::Settings).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SceneDescription {
    /// The camera.
    pub camera: CameraDescription,
    /// The background, which rays that miss all spheres see.
    pub background: BackgroundDescription,
    /// The materials; spheres refer to them by index.
    pub materials: Vec<MaterialDescription>,
    /// Individually described spheres.
    pub spheres: Vec<SphereDescription>,
    /// Sphere tables, from files or from memory.
    pub tables: Vec<SphereTable>,
}

/// The camera (`[camera]`).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CameraDescription {
    /// Camera position: the centre of the lens or of the image plane.
    pub position: DVec3,
    /// The point at the centre of the picture.
    pub look_at: DVec3,
    /// The up direction in the picture.
    pub up: DVec3,
    /// Depth along the view axis at which camera rays start; for a panorama, the distance.
    pub near: f64,
    /// The projection: `type` and its keys.
    pub projection: ProjectionDescription,
}

impl Default for CameraDescription {
    /// At (0, 0, 10), looking at the origin, pinhole with a field of view of 36 degrees, y up.
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

/// The mapping from directions to picture positions.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "kebab-case", deny_unknown_fields)]
pub enum ProjectionDescription {
    /// `type = "perspective"`.
    Perspective {
        /// Vertical field of view, in degrees.
        vertical_fov_degrees: f64,
        /// The lens; `None` is a pinhole.
        lens: Option<LensDescription>,
    },
    /// `type = "orthographic"`: parallel rays.
    Orthographic {
        /// Height of the view, in scene units.
        height: f64,
    },
    /// `type = "panoramic"`: columns are longitudes, rows are latitudes.
    Panoramic {
        /// Horizontal field of view, in degrees.
        horizontal_degrees: f64,
        /// Vertical field of view, in degrees.
        vertical_degrees: f64,
    },
}

impl Default for ProjectionDescription {
    /// A pinhole with a field of view of 36 degrees.
    fn default() -> Self {
        Self::Perspective { vertical_fov_degrees: 36.0, lens: None }
    }
}

/// The projection types, without parameters.
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
    /// The type of this projection.
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
    /// Radius of the aperture, in scene units.
    pub radius: f64,
    /// Distance to the focal plane along the view axis, given directly or by `focus_on`.
    pub focus_distance: f64,
    /// Number of aperture blades; 0 for a disk.
    pub blades: u32,
    /// Rotation of the aperture, counter-clockwise in the picture's axes, in degrees.
    pub rotation_degrees: f64,
}

/// `[materials.NAME]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MaterialDescription {
    /// Name of the material.
    pub name: String,
    /// The reflection model: `type` and its keys.
    pub surface: SurfaceModel,
    /// Radiance emitted on both sides, in W/(sr m^2).
    pub emission: Rgb,
    /// Probability that light interacts with the surface, in `[0, 1]`.
    pub opacity: f64,
}

impl Default for MaterialDescription {
    /// Grey diffuse, without a name.
    fn default() -> Self {
        let surface = SurfaceModel::default();
        Self { name: String::new(), surface, emission: Rgb::ZERO, opacity: 1.0 }
    }
}

/// One `[[spheres]]`: a sphere of its own.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SphereDescription {
    /// Name, for messages and Cryptomatte.
    pub name: Option<String>,
    /// Centre.
    pub center: DVec3,
    /// Radius, positive.
    pub radius: f64,
    /// Index into [`SceneDescription::materials`].
    pub material: usize,
}

/// A sphere table (`[[sphere_tables]]` or `[[particles]]`): many spheres of one material.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SphereTable {
    /// Name in Cryptomatte layers; [`SceneDescription::name_of_table`] gives the fallback.
    pub name: Option<String>,
    /// Source of the values.
    pub data: SphereData,
    /// Index into [`SceneDescription::materials`].
    pub material: usize,
    /// Storage of the rows' colours, if any (`colors`).
    pub colors: ColorStorage,
    /// Added to each centre, in f64.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub offset: DVec3,
}

fn is_zero(offset: &DVec3) -> bool {
    *offset == DVec3::ZERO
}

/// How table colours are stored in memory.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ColorStorage {
    /// Unrounded, 12 bytes each.
    #[default]
    Exact,
    /// Rounded, in a third of the memory.
    Packed,
}

named_enum! { ColorStorage { Exact = "exact", Packed = "packed" } }

impl ColorStorage {
    /// Bytes per colour in memory.
    pub fn bytes_per_color(self) -> usize {
        match self {
            Self::Exact => size_of::<[f32; 3]>(),
            Self::Packed => size_of::<u32>(),
        }
    }
}

impl SceneDescription {
    /// Applies `change` to the path of every file of the scene.
    pub(crate) fn for_each_file(&mut self, mut change: impl FnMut(&mut PathBuf)) {
        for table in &mut self.tables {
            match &mut table.data {
                SphereData::File { path, .. } => change(path),
                SphereData::Particles(particles) => particles.for_each_file(&mut change),
                SphereData::Memory(_) => {}
            }
        }
        if let EnvironmentDescription::Image { file, .. } = &mut self.background.dome {
            change(file);
        }
    }

    /// The name of a table: its own; otherwise its file name without folder; otherwise, for a table
    /// in memory, its index, as in `table 3`.
    ///
    /// # Panics
    /// If there is no table with this index.
    pub fn name_of_table(&self, index: usize) -> String {
        let SphereTable { name, data, .. } = &self.tables[index];
        let of_file = || {
            let path = match data {
                SphereData::File { path, .. } => path,
                SphereData::Particles(particles) => &particles.path,
                SphereData::Memory(_) => return None,
            };
            path.file_name().map(|name| name.to_string_lossy().into_owned())
        };
        name.clone().or_else(of_file).unwrap_or_else(|| format!("table {index}"))
    }

    /// Brings equivalent values into one canonical form: a lens with radius 0 becomes a pinhole,
    /// and a coordinate, offset or angle of -0 becomes 0.
    pub(super) fn make_canonical(&mut self) {
        let Self { camera, background, materials: _, spheres, tables } = self;
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
        let offsets = tables.iter_mut().map(|table| &mut table.offset);
        let vectors = [position, look_at, up, zenith].into_iter();
        let vectors = vectors.chain(sun).chain(centers).chain(offsets);
        vectors.for_each(|vector| *vector += 0.0);
    }
}

/// The unit vector of `v`, for any length; `None` if `v` has no direction.
pub(crate) fn normalize_robust(v: DVec3) -> Option<DVec3> {
    (v / v.abs().max_element()).try_normalize()
}
