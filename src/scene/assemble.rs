//! The scene as the renderer sees it: immutable, in coordinates relative to the spheres' origin.

use std::path::Path;
use std::sync::Arc;

use rayon::prelude::*;

use crate::camera::{Camera, Pinhole};
use crate::color::Rgb;
use crate::error::{Error, Result};
use crate::geometry::{Sphere, SphereSet};
use crate::light::{Lamp, Lights};
use crate::material::{Dielectric, Diffuse, Material, Media, Medium, Mirror, Model, Phong};
use crate::math::{DVec3, MAX_COORDINATE};
use crate::sampling::Filter;

use super::description::{self, Description};
use super::{Loaded, Override, RowGroup, read_file};

/// A scene, ready to be rendered.
#[derive(Debug)]
pub struct Scene {
    description: Description,
    spheres: Arc<SphereSet>,
    materials: Vec<Material>,
    groups: Vec<RowGroup>,
    lights: Lights,
    camera: Camera,
    filter: Filter,
    /// The dielectric spheres that a camera ray can start in, the largest first.
    around_camera: Vec<(Sphere, Medium)>,
}

/// What a sphere is made of.
#[derive(Clone, Copy, Debug)]
pub struct Surface<'a> {
    /// Its material.
    pub material: &'a Material,
    /// Its own colour, where a table gives one.
    pub albedo: Option<Rgb>,
}

impl Surface<'_> {
    /// The medium inside a dielectric sphere; `None` for other materials.
    pub fn medium(&self, sphere: u32) -> Option<Medium> {
        match self.material.model {
            Model::Dielectric(Dielectric { ior, priority }) => {
                Some(Medium { sphere, priority, ior })
            }
            _ => None,
        }
    }
}

impl Scene {
    /// Reads, checks and prepares a scene file, changed by `overrides`.
    ///
    /// # Errors
    /// All mistakes of the file at once; files that cannot be read.
    pub fn load(path: &Path, overrides: &[Override]) -> Result<Self> {
        Self::new(read_file(path, overrides)?)
    }

    /// Prepares what was read.
    ///
    /// # Errors
    /// When there are more spheres than ids, or camera rays start out of reach.
    pub fn new(loaded: Loaded) -> Result<Self> {
        let Loaded { description, rows, groups } = loaded;
        let spheres = Arc::new(SphereSet::new(rows)?);
        let materials = description.materials.iter().map(material).collect();
        let camera = pinhole(&description, spheres.origin());
        let filter = Filter::new(description.image.filter, description.image.filter_radius);
        let mut scene = Self {
            description,
            spheres,
            materials,
            groups,
            lights: Lights::default(),
            camera,
            filter,
            around_camera: Vec::new(),
        };
        if scene.farthest_start() > 4.0 * MAX_COORDINATE {
            let message = "`camera.near` puts the start of some camera rays out of reach";
            return Err(Error::input(message).with_help("lower `near`, or narrow the view"));
        }
        scene.lights = Lights::new(scene.find_lamps(), &scene.spheres);
        scene.around_camera = scene.find_media_around_camera();
        Ok(scene)
    }

    /// What the user wrote.
    pub fn description(&self) -> &Description {
        &self.description
    }

    /// All spheres.
    pub fn spheres(&self) -> &Arc<SphereSet> {
        &self.spheres
    }

    /// All lamps.
    pub fn lights(&self) -> &Lights {
        &self.lights
    }

    /// The camera.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// The pixel's weight function.
    pub fn filter(&self) -> &Filter {
        &self.filter
    }

    /// The radiance of a ray that meets nothing.
    pub fn background(&self) -> Rgb {
        self.description.background
    }

    /// What a sphere is made of.
    pub fn surface(&self, id: u32) -> Surface<'_> {
        let row = self.spheres.row(id);
        if let Some(sphere) = self.description.spheres.get(row as usize) {
            return Surface { material: &self.materials[sphere.material], albedo: None };
        }
        let group = &self.groups[self.groups.partition_point(|g| g.first_row <= row) - 1];
        let albedo =
            group.colors.as_ref().map(|colors| Rgb::from(colors[(row - group.first_row) as usize]));
        Surface { material: &self.materials[group.material], albedo }
    }

    /// The name of a sphere, where the scene gives one.
    pub fn name(&self, id: u32) -> Option<&str> {
        self.description.spheres.get(self.spheres.row(id) as usize)?.name.as_deref()
    }

    /// The media at a point where a camera ray starts.
    pub fn media_at(&self, point: DVec3) -> Media {
        let containing = self.around_camera.iter().filter(|(sphere, _)| sphere.contains(point));
        containing.fold(Media::VACUUM, |media, (_, medium)| media.with(*medium))
    }

    fn farthest_start(&self) -> f64 {
        self.camera.farthest_start(self.description.image.filter_radius)
    }

    fn find_lamps(&self) -> Vec<Lamp> {
        if !self.materials.iter().any(Material::is_emissive) {
            return Vec::new();
        }
        let lamp = |id| {
            let material = self.surface(id).material;
            material.is_emissive().then_some(Lamp { id, emission: material.emission })
        };
        (0..self.spheres.len() as u32).into_par_iter().filter_map(lamp).collect()
    }

    fn find_media_around_camera(&self) -> Vec<(Sphere, Medium)> {
        if !self.materials.iter().any(|m| matches!(m.model, Model::Dielectric(_))) {
            return Vec::new();
        }
        let position = self.camera.position();
        let reach = self.farthest_start();
        let around = |id| {
            let medium = self.surface(id).medium(id)?;
            let sphere = self.spheres.sphere(id);
            let near = sphere.center.distance(position) <= sphere.radius + reach;
            near.then_some((sphere, medium))
        };
        let mut found: Vec<_> =
            (0..self.spheres.len() as u32).into_par_iter().filter_map(around).collect();
        found.sort_by(|(a, _), (b, _)| b.radius.total_cmp(&a.radius));
        found
    }
}

fn pinhole(description: &Description, origin: DVec3) -> Camera {
    let description::Camera { position, look_at, up, vertical_fov_degrees, near } =
        description.camera;
    Camera::pinhole(&Pinhole {
        position: position - origin,
        towards: look_at - position,
        up,
        vertical_fov: vertical_fov_degrees.to_radians(),
        near,
        size: [description.image.width, description.image.height],
    })
}

fn material(named: &description::NamedMaterial) -> Material {
    let model = match named.surface {
        description::Surface::Diffuse { albedo } => Model::Diffuse(Diffuse { albedo }),
        description::Surface::Mirror { reflectance } => Model::Mirror(Mirror { reflectance }),
        description::Surface::Dielectric { ior, priority } => {
            Model::Dielectric(Dielectric { ior, priority })
        }
        description::Surface::Phong { albedo, specular, exponent, normalized } => {
            Model::Phong(Phong { albedo, specular, exponent, normalized })
        }
    };
    Material { model, emission: named.emission }
}
