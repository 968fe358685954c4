//! A scene description: plain values in the user's units, filled in by a program or by the scene
//! file reader. [`Scene::build`](super::Scene::build) validates a description and builds a scene
//! from it. `docs/scene-format.md` explains the corresponding keys.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::color::{Rgb, linear_from_srgb, srgb_from_linear};
use crate::geometry::Sphere;
use crate::math::DVec3;
use crate::names::named_enum;

use super::data::SphereData;

pub use super::camera::{
    CameraDescription, CameraFit, FocusTarget, LensDescription, ProjectionDescription,
    ProjectionKind,
};
pub use super::environment::{BackgroundDescription, EnvironmentDescription, SunDescription};
pub use super::light_preset::LightPreset;
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
    /// True if the camera sees only the shadow that others cast on it.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub shadow_catcher: bool,
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
    /// What the numbers of the rows' colours mean. Emission is always linear.
    #[serde(default, skip_serializing_if = "ColorSpace::is_linear")]
    pub color_space: ColorSpace,
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

/// What the numbers of a colour mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ColorSpace {
    /// Shares of light, linear Rec. 709.
    #[default]
    Linear,
    /// Numbers as in pictures and on screens.
    Srgb,
}

named_enum! { ColorSpace { Linear = "linear", Srgb = "srgb" } }

impl ColorSpace {
    /// The linear colour of these numbers, but at most `most`.
    pub(super) fn to_linear(self, color: [f32; 3], most: [f32; 3]) -> [f32; 3] {
        match self {
            Self::Linear => color,
            Self::Srgb => std::array::from_fn(|i| linear_from_srgb(color[i]).min(most[i])),
        }
    }

    /// The largest numbers of a colour whose linear channels are at most `most`.
    pub(super) fn largest(self, most: [f32; 3]) -> [f32; 3] {
        match self {
            Self::Linear => most,
            // The curve may end just below 1.
            Self::Srgb => most.map(|most| if most >= 1.0 { 1.0 } else { srgb_from_linear(most) }),
        }
    }

    fn is_linear(&self) -> bool {
        *self == Self::Linear
    }
}

impl ColorStorage {
    /// Bytes per colour in memory.
    pub fn bytes_per_color(self) -> usize {
        match self {
            Self::Exact => size_of::<[f32; 3]>(),
            Self::Packed => size_of::<u32>(),
        }
    }
}

impl SphereDescription {
    /// The sphere itself.
    pub(super) fn sphere(&self) -> Sphere {
        Sphere { center: self.center, radius: self.radius }
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
        name_of_table(&self.tables, index)
    }

    /// Brings equivalent values into one canonical form: a lens with radius 0 becomes a pinhole,
    /// and a coordinate, offset or angle of -0 becomes 0.
    pub(super) fn make_canonical(&mut self) {
        let Self { camera, background, materials: _, spheres, tables } = self;
        camera.make_canonical();
        let CameraDescription { position, look_at, up, .. } = camera;
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

/// As [`SceneDescription::name_of_table`].
pub(super) fn name_of_table(tables: &[SphereTable], index: usize) -> String {
    let SphereTable { name, data, .. } = &tables[index];
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
