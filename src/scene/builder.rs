//! Building a scene in a few lines: what one would otherwise fill into a [`Description`] by hand.

use std::sync::atomic::{AtomicU64, Ordering};

use crate::color::Rgb;
use crate::error::Result;
use crate::material::Metal;
use crate::math::DVec3;

use super::Scene;
use super::data::{SphereArrays, SphereData};
use super::description::{
    Background, Camera, Description, Dome, NamedMaterial, Projection, SphereRow, SphereTable, Sun,
    Surface, unit,
};
use super::validate::FOREIGN_MATERIAL;

/// A scene in the making. Whatever it has no word for is a field of its [`Description`], which is open
/// to be changed; mistakes are told by [`Builder::build`], all at once.
///
/// ```
/// use photosphere::scene::Builder;
///
/// let mut scene = Builder::new();
/// scene.camera([0.0, 1.0, 6.0], [0.0; 3]).background([0.8; 3]);
/// let red = scene.diffuse([0.7, 0.2, 0.1]);
/// scene.sphere(red, [0.0; 3], 1.0);
/// assert_eq!(scene.build()?.spheres().len(), 1);
/// # Ok::<(), photosphere::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Builder {
    /// The scene so far.
    pub description: Description,
    /// The number of this builder, which its clones share.
    id: u64,
}

/// A material of a [`Builder`], and of its clones. [`Builder::build`] refuses spheres with a material of
/// another builder.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Material {
    builder: u64,
    index: usize,
}

impl Material {
    /// The index of the material in [`Description::materials`].
    pub fn index(self) -> usize {
        self.index
    }
}

impl Default for Builder {
    fn default() -> Self {
        Self::from(Description::default())
    }
}

/// A builder that goes on with a scene.
impl From<Description> for Builder {
    fn from(description: Description) -> Self {
        static NEXT: AtomicU64 = AtomicU64::new(0);
        Self { description, id: NEXT.fetch_add(1, Ordering::Relaxed) }
    }
}

/// Builders are equal if their scenes are.
impl PartialEq for Builder {
    fn eq(&self, other: &Self) -> bool {
        self.description == other.description
    }
}

impl Builder {
    /// Darkness without a sphere, seen from (0, 0, 10) by a pinhole of 36 degrees.
    pub fn new() -> Self {
        Self::default()
    }

    /// Puts the camera somewhere, with a point in the middle of its picture; the rest stays.
    pub fn camera(&mut self, position: impl Into<DVec3>, look_at: impl Into<DVec3>) -> &mut Self {
        let camera = &mut self.description.camera;
        *camera = Camera { position: position.into(), look_at: look_at.into(), ..*camera };
        self
    }

    /// Gives the camera a pinhole that sees so many degrees between the bottom and the top of the picture.
    pub fn field_of_view(&mut self, vertical_fov_degrees: f64) -> &mut Self {
        self.description.camera.projection =
            Projection::Perspective { vertical_fov_degrees, lens: None };
        self
    }

    /// The same radiance from all directions, in W/(sr m^2).
    pub fn background(&mut self, radiance: impl Into<Rgb>) -> &mut Self {
        self.description.background.dome = Dome::Constant { radiance: radiance.into() };
        self
    }

    /// The direction of the zenith, of any length, for the camera and the background.
    pub fn up(&mut self, up: impl Into<DVec3>) -> &mut Self {
        let up = up.into();
        self.description.camera.up = up;
        self.description.background.up = normalized(up);
        self
    }

    /// A sun in a direction of any length, which lights a surface that faces it by so many W/m^2.
    pub fn sun(
        &mut self,
        direction: impl Into<DVec3>,
        angular_diameter_degrees: f64,
        irradiance: impl Into<Rgb>,
    ) -> &mut Self {
        let direction = normalized(direction.into());
        let sun = Sun { direction, angular_diameter_degrees, irradiance: irradiance.into() };
        self.description.background =
            Background { sun: Some(sun), ..self.description.background.clone() };
        self
    }

    /// Lambert's surface with this albedo.
    pub fn diffuse(&mut self, albedo: impl Into<Rgb>) -> Material {
        self.surface(Surface::Diffuse { albedo: albedo.into(), roughness: 0.0 })
    }

    /// A mirror that reflects this share of light.
    pub fn mirror(&mut self, reflectance: impl Into<Rgb>) -> Material {
        self.surface(Surface::Mirror { reflectance: reflectance.into() })
    }

    /// Clear, smooth glass of this index of refraction.
    pub fn glass(&mut self, ior: f64) -> Material {
        let absorption = Rgb::ZERO;
        self.surface(Surface::Dielectric { ior, roughness: 0.0, priority: 0, absorption })
    }

    /// A metal, from 0, smooth, to 1 in roughness.
    pub fn metal(&mut self, metal: Metal, roughness: f64) -> Material {
        self.surface(Surface::Conductor { metal, roughness })
    }

    /// A black surface that sends out this radiance, in W/(sr m^2).
    pub fn lamp(&mut self, emission: impl Into<Rgb>) -> Material {
        let surface = Surface::Diffuse { albedo: Rgb::ZERO, roughness: 0.0 };
        self.material(NamedMaterial { surface, emission: emission.into(), ..Default::default() })
    }

    /// Any surface that sends out no light.
    pub fn surface(&mut self, surface: Surface) -> Material {
        self.material(NamedMaterial { surface, ..NamedMaterial::default() })
    }

    /// Any material; one without a name is called after its place, as in `material-0`.
    pub fn material(&mut self, mut material: NamedMaterial) -> Material {
        let index = self.description.materials.len();
        if material.name.is_empty() {
            material.name = format!("material-{index}");
        }
        self.description.materials.push(material);
        Material { builder: self.id, index }
    }

    /// A sphere.
    pub fn sphere(
        &mut self,
        material: Material,
        center: impl Into<DVec3>,
        radius: f64,
    ) -> &mut Self {
        self.add_sphere(material, None, center.into(), radius)
    }

    /// A sphere with a name, which messages and the layers of Cryptomatte show.
    pub fn named_sphere(
        &mut self,
        material: Material,
        name: impl Into<String>,
        center: impl Into<DVec3>,
        radius: f64,
    ) -> &mut Self {
        self.add_sphere(material, Some(name.into()), center.into(), radius)
    }

    fn add_sphere(
        &mut self,
        material: Material,
        name: Option<String>,
        center: DVec3,
        radius: f64,
    ) -> &mut Self {
        let material = self.index_of(material);
        self.description.spheres.push(SphereRow { name, center, radius, material });
        self
    }

    /// Many spheres.
    pub fn spheres(&mut self, material: Material, arrays: SphereArrays) -> &mut Self {
        let (data, material) = (SphereData::Memory(arrays), self.index_of(material));
        self.table(SphereTable { data, material, ..SphereTable::default() })
    }

    /// Many spheres from anywhere; [`Material::index`] gives the material of the table.
    pub fn table(&mut self, table: SphereTable) -> &mut Self {
        self.description.tables.push(table);
        self
    }

    fn index_of(&self, material: Material) -> usize {
        if material.builder == self.id { material.index } else { FOREIGN_MATERIAL }
    }

    /// The scene; the builder keeps what it has, arrays in memory included.
    ///
    /// # Errors
    /// As [`Scene::build`].
    pub fn build(&self) -> Result<Scene> {
        self.clone().into_scene()
    }

    /// The scene, for the last time: each array in memory is let go of as soon as it is read.
    ///
    /// # Errors
    /// As [`Scene::build`].
    pub fn into_scene(self) -> Result<Scene> {
        Scene::build(self.description)
    }
}

/// A vector without a direction stays as it is, and is refused where the scene is built.
fn normalized(v: DVec3) -> DVec3 {
    unit(v).unwrap_or(v)
}
