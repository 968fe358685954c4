//! Builds a scene in a few lines, without filling in a [`SceneDescription`] by hand.

use std::sync::atomic::{AtomicU64, Ordering};

use crate::color::Rgb;
use crate::error::Result;
use crate::material::Metal;
use crate::math::{DVec3, normalize_robust};

use super::Scene;
use super::data::{SphereArrays, SphereData};
use super::description::{
    BackgroundDescription, CameraDescription, EnvironmentDescription, MaterialDescription,
    ProjectionDescription, SceneDescription, SphereDescription, SphereTable, SunDescription,
    SurfaceModel,
};
use super::validate::FOREIGN_MATERIAL;

/// Builds a scene step by step. Anything without a method of its own can be set in the public
/// [`SceneDescription`]. [`SceneBuilder::build`] reports all errors at once.
///
/// ```
/// use photosphere::scene::SceneBuilder;
///
/// let mut scene = SceneBuilder::new();
/// scene.camera([0.0, 1.0, 6.0], [0.0; 3]).background([0.8; 3]);
/// let red = scene.diffuse([0.7, 0.2, 0.1]);
/// scene.sphere(red, [0.0; 3], 1.0);
/// assert_eq!(scene.build()?.spheres().len(), 1);
/// # Ok::<(), photosphere::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct SceneBuilder {
    /// The scene so far.
    pub description: SceneDescription,
    /// Id of this builder, shared with its clones.
    id: u64,
}

/// A material of a [`SceneBuilder`] and its clones. [`SceneBuilder::build`] rejects spheres with a
/// material of another builder.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct MaterialHandle {
    builder: u64,
    index: usize,
}

impl MaterialHandle {
    /// Index of the material in [`SceneDescription::materials`].
    pub fn index(self) -> usize {
        self.index
    }
}

impl Default for SceneBuilder {
    fn default() -> Self {
        Self::from(SceneDescription::default())
    }
}

/// Creates a builder that extends an existing description.
impl From<SceneDescription> for SceneBuilder {
    fn from(description: SceneDescription) -> Self {
        static NEXT: AtomicU64 = AtomicU64::new(0);
        Self { description, id: NEXT.fetch_add(1, Ordering::Relaxed) }
    }
}

/// Builders are equal if their descriptions are equal.
impl PartialEq for SceneBuilder {
    fn eq(&self, other: &Self) -> bool {
        self.description == other.description
    }
}

impl SceneBuilder {
    /// An empty scene without light, seen from (0, 0, 10) by a pinhole camera with a field of view
    /// of 36 degrees.
    pub fn new() -> Self {
        Self::default()
    }

    /// Places the camera and the point at the centre of its picture. Other camera values are
    /// unchanged.
    pub fn camera(&mut self, position: impl Into<DVec3>, look_at: impl Into<DVec3>) -> &mut Self {
        let camera = &mut self.description.camera;
        *camera =
            CameraDescription { position: position.into(), look_at: look_at.into(), ..*camera };
        self
    }

    /// Makes the camera a pinhole with this vertical field of view in degrees.
    pub fn field_of_view(&mut self, vertical_fov_degrees: f64) -> &mut Self {
        self.description.camera.projection =
            ProjectionDescription::Perspective { vertical_fov_degrees, lens: None };
        self
    }

    /// Sets a constant environment radiance, in W/(sr m^2).
    pub fn background(&mut self, radiance: impl Into<Rgb>) -> &mut Self {
        self.description.background.dome =
            EnvironmentDescription::Constant { radiance: radiance.into() };
        self
    }

    /// Sets the zenith direction, of any length, for camera and background.
    pub fn up(&mut self, up: impl Into<DVec3>) -> &mut Self {
        let up = up.into();
        self.description.camera.up = up;
        self.description.background.up = unit_or_unchanged(up);
        self
    }

    /// Adds a sun in `direction` (any length), with its irradiance on a facing surface in W/m^2.
    pub fn sun(
        &mut self,
        direction: impl Into<DVec3>,
        angular_diameter_degrees: f64,
        irradiance: impl Into<Rgb>,
    ) -> &mut Self {
        let direction = unit_or_unchanged(direction.into());
        let sun =
            SunDescription { direction, angular_diameter_degrees, irradiance: irradiance.into() };
        self.description.background =
            BackgroundDescription { sun: Some(sun), ..self.description.background.clone() };
        self
    }

    /// Adds a Lambertian material with this albedo.
    pub fn diffuse(&mut self, albedo: impl Into<Rgb>) -> MaterialHandle {
        self.surface(SurfaceModel::Diffuse { albedo: albedo.into(), roughness: 0.0 })
    }

    /// Adds a mirror with this reflectance.
    pub fn mirror(&mut self, reflectance: impl Into<Rgb>) -> MaterialHandle {
        self.surface(SurfaceModel::Mirror { reflectance: reflectance.into() })
    }

    /// Adds clear, smooth glass with this index of refraction.
    pub fn glass(&mut self, ior: f64) -> MaterialHandle {
        let absorption = Rgb::ZERO;
        self.surface(SurfaceModel::Dielectric { ior, roughness: 0.0, priority: 0, absorption })
    }

    /// Adds a metal with a roughness from 0 (smooth) to 1.
    pub fn metal(&mut self, metal: Metal, roughness: f64) -> MaterialHandle {
        self.surface(SurfaceModel::Conductor { metal, roughness })
    }

    /// Adds a black surface that emits this radiance, in W/(sr m^2).
    pub fn emitter(&mut self, emission: impl Into<Rgb>) -> MaterialHandle {
        let surface = SurfaceModel::Diffuse { albedo: Rgb::ZERO, roughness: 0.0 };
        self.material(MaterialDescription {
            surface,
            emission: emission.into(),
            ..Default::default()
        })
    }

    /// Adds a material without emission.
    pub fn surface(&mut self, surface: SurfaceModel) -> MaterialHandle {
        self.material(MaterialDescription { surface, ..MaterialDescription::default() })
    }

    /// Adds a material. An empty name is replaced by its index, as in `material-0`.
    pub fn material(&mut self, mut material: MaterialDescription) -> MaterialHandle {
        let index = self.description.materials.len();
        if material.name.is_empty() {
            material.name = format!("material-{index}");
        }
        self.description.materials.push(material);
        MaterialHandle { builder: self.id, index }
    }

    /// Adds a sphere.
    pub fn sphere(
        &mut self,
        material: MaterialHandle,
        center: impl Into<DVec3>,
        radius: f64,
    ) -> &mut Self {
        self.add_sphere(material, None, center.into(), radius)
    }

    /// Adds a sphere with a name, which appears in messages and Cryptomatte layers.
    pub fn named_sphere(
        &mut self,
        material: MaterialHandle,
        name: impl Into<String>,
        center: impl Into<DVec3>,
        radius: f64,
    ) -> &mut Self {
        self.add_sphere(material, Some(name.into()), center.into(), radius)
    }

    fn add_sphere(
        &mut self,
        material: MaterialHandle,
        name: Option<String>,
        center: DVec3,
        radius: f64,
    ) -> &mut Self {
        let material = self.index_of(material);
        self.add(SphereDescription { name, center, radius, material, shadow_catcher: false })
    }

    fn add(&mut self, sphere: SphereDescription) -> &mut Self {
        self.description.spheres.push(sphere);
        self
    }

    /// Adds spheres from arrays.
    pub fn spheres(&mut self, material: MaterialHandle, arrays: SphereArrays) -> &mut Self {
        let (data, material) = (SphereData::Memory(arrays), self.index_of(material));
        self.table(SphereTable { data, material, ..SphereTable::default() })
    }

    /// Adds a sphere table. [`MaterialHandle::index`] gives its material index.
    pub fn table(&mut self, table: SphereTable) -> &mut Self {
        self.description.tables.push(table);
        self
    }

    fn index_of(&self, material: MaterialHandle) -> usize {
        if material.builder == self.id { material.index } else { FOREIGN_MATERIAL }
    }

    /// Builds the scene. The builder keeps its description, including arrays in memory.
    ///
    /// # Errors
    /// As for [`Scene::build`].
    pub fn build(&self) -> Result<Scene> {
        self.clone().into_scene()
    }

    /// Builds the scene and consumes the builder. Each array is freed as soon as it is read.
    ///
    /// # Errors
    /// As for [`Scene::build`].
    pub fn into_scene(self) -> Result<Scene> {
        Scene::build(self.description)
    }
}

/// A vector without a direction is returned unchanged and rejected when the scene is built.
fn unit_or_unchanged(v: DVec3) -> DVec3 {
    normalize_robust(v).unwrap_or(v)
}
