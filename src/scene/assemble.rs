//! The scene as the renderer sees it: immutable, in coordinates relative to the spheres' origin.

use std::hint::black_box;
use std::path::Path;
use std::sync::Arc;

use rayon::prelude::*;

use crate::camera::{Aperture, Camera, Lens, Mount, Projection};
use crate::color::{Radiance, Rgb};
use crate::error::{Error, Result};
use crate::geometry::{Sphere, SphereSet};
use crate::light::{Lamp, Lights};
use crate::material::{Material, Media, Medium};
use crate::math::{DVec3, Hit, MAX_COORDINATE};
use crate::sampling::Filter;

use super::description::{self, Description};
use super::environment;
use super::identity::{Identity, Ingredients};
use super::surface::{Surface, materials};
use super::{Loaded, Override, RowGroup, read_file};

/// So many spheres stay in a processor's near memory by themselves.
const NEAR: usize = 1000;

/// A scene, ready to be rendered.
#[derive(Debug)]
pub struct Scene {
    description: Description,
    ingredients: Ingredients,
    spheres: Arc<SphereSet>,
    materials: Vec<Material>,
    has_opacity: bool,
    has_media: bool,
    groups: Vec<RowGroup>,
    lights: Lights,
    camera: Camera,
    filter: Filter,
    /// The dielectric spheres that a camera ray can start in, the largest first.
    around_camera: Vec<(Sphere, Medium)>,
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
        let Loaded { description, rows, groups, environment, ingredients } = loaded;
        let spheres = Arc::new(SphereSet::new(rows)?);
        let materials = materials(&description.materials);
        let has_opacity = materials.iter().any(|material| material.opacity < 1.0);
        let has_media = materials.iter().any(|material| material.glass().is_some());
        let camera = camera(&description, spheres.origin());
        let filter = Filter::new(description.image.filter, description.image.filter_radius);
        let mut scene = Self {
            description,
            ingredients,
            spheres,
            materials,
            has_opacity,
            has_media,
            groups,
            lights: Lights::default(),
            camera,
            filter,
            around_camera: Vec::new(),
        };
        scene.check_reach()?;
        let background = environment::light(&scene.description.background, environment);
        let choice = scene.description.render.light_choice;
        scene.lights = Lights::chosen_by(choice, scene.find_lamps(), &scene.spheres, background);
        scene.around_camera = scene.find_media_around_camera();
        Ok(scene)
    }

    /// What the user wrote.
    pub fn description(&self) -> &Description {
        &self.description
    }

    /// What it was read from.
    pub fn ingredients(&self) -> &Ingredients {
        &self.ingredients
    }

    /// The identity of its pictures by an intersector, named with its version as a
    /// backend tells it: pictures of one identity agree to the bit in all samples that they share.
    pub fn identity(&self, intersector: &str) -> Identity {
        self.ingredients.identity(&self.description, intersector)
    }

    /// Chooses other random numbers; nothing else of a scene depends on its seed.
    pub fn set_seed(&mut self, seed: u64) {
        self.description.render.seed = seed;
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

    /// The radiance seen by a ray in this direction that meets nothing.
    pub fn background(&self, direction: DVec3) -> Rgb {
        self.lights.background().radiance(direction)
    }

    /// The largest radiance that anything in the scene sends out, in any channel; 1 for integrators
    /// whose pictures are no light.
    pub fn brightest(&self) -> f32 {
        use description::Integrator::{AmbientOcclusion, Normals};
        let integrator = &self.description.render.integrator;
        if matches!(integrator, AmbientOcclusion { .. } | Normals) {
            return 1.0;
        }
        let emissions = self.materials.iter().map(|material| material.emission.max_element());
        let brightest = emissions.fold(self.lights.background().brightest(), f32::max);
        // Two that each fit may not fit together: a dome and a sun before it.
        brightest.min(f32::MAX)
    }

    /// Whether the camera sees the background.
    pub fn shows_background(&self) -> bool {
        self.description.background.camera_visible
    }

    /// What a camera ray in this direction brings that meets nothing: the background, unless it is
    /// hidden from the camera.
    pub fn seen_by_camera(&self, direction: DVec3) -> Radiance {
        let direct = if self.shows_background() { self.background(direction) } else { Rgb::ZERO };
        Radiance { direct, indirect: Rgb::ZERO, alpha: 0.0 }
    }

    /// What a sphere is made of.
    pub fn surface(&self, id: u32) -> Surface<'_> {
        let (material, color) = self.material(id);
        Surface::new(material, color, || self.spheres.sphere(id).radius)
    }

    /// What a sphere is made of, and its own colour where a table gives one.
    #[inline(always)]
    pub(crate) fn material(&self, id: u32) -> (&Material, Option<Rgb>) {
        let row = self.spheres.row(id);
        if let Some(sphere) = self.description.spheres.get(row as usize) {
            return (&self.materials[sphere.material], None);
        }
        let group = self.group_of(row);
        let in_table = (row - group.first_row) as usize;
        let color = group.colors.as_ref().map(|colors| colors.get(in_table));
        (&self.materials[group.material], color)
    }

    /// Reads what is known of the spheres that were hit, unless there are so few that all of them are
    /// near at hand; see [`SphereSet::warm`].
    pub fn warm(&self, hits: &[Hit]) {
        if self.spheres.len() <= NEAR {
            return;
        }
        let ids = || hits.iter().filter(|hit| !hit.is_miss()).map(|hit| hit.id);
        self.spheres.warm(ids());
        if self.groups.iter().any(|group| group.colors.is_some()) {
            let read = |id: u32| {
                let row = self.spheres.row(id);
                let group =
                    (row as usize >= self.description.spheres.len()).then(|| self.group_of(row))?;
                Some(group.colors.as_ref()?.get((row - group.first_row) as usize).x.to_bits())
            };
            black_box(ids().filter_map(read).fold(0, |all, bits| all ^ bits));
        }
    }

    /// Whether some surface is only there with a probability.
    pub fn has_opacity(&self) -> bool {
        self.has_opacity
    }

    /// Whether a path can be inside of a dielectric.
    pub fn has_media(&self) -> bool {
        self.has_media
    }

    /// The material of the sphere in a row of the scene, counted as its file names them.
    pub fn material_of_row(&self, row: u32) -> usize {
        match self.description.spheres.get(row as usize) {
            Some(sphere) => sphere.material,
            None => self.group_of(row).material,
        }
    }

    /// The name of the sphere in a row of the scene, or of its place: `sphere 3`, or `grains.f32:17` for
    /// a row of a table.
    pub fn name_of_row(&self, row: u32) -> String {
        match self.description.spheres.get(row as usize) {
            Some(sphere) => sphere.name.clone().unwrap_or_else(|| format!("sphere {row}")),
            None => {
                let group = self.group_of(row);
                format!("{}:{}", self.table_of_row(row), row - group.first_row)
            }
        }
    }

    /// The table that a row of the scene comes from, as the scene names its file; `spheres` for the
    /// spheres of the scene file.
    pub fn table_of_row(&self, row: u32) -> String {
        if (row as usize) < self.description.spheres.len() {
            return "spheres".to_owned();
        }
        let before = self.groups.partition_point(|group| group.first_row <= row);
        let file = &self.description.tables[before - 1].file;
        file.strip_prefix(&self.ingredients.folder).unwrap_or(file).display().to_string()
    }

    /// The table that a row comes from, of those that are no spheres of the scene file.
    fn group_of(&self, row: u32) -> &RowGroup {
        &self.groups[self.groups.partition_point(|group| group.first_row <= row) - 1]
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

    /// Backends take coordinates of up to four times [`MAX_COORDINATE`]; moving the origin may have
    /// used up two of them.
    fn check_reach(&self) -> Result<()> {
        let margin = self.description.image.filter_radius;
        let is_near = self.camera.farthest_origin(margin) <= 2.0 * MAX_COORDINATE
            && self.camera.farthest_start(margin) <= 4.0 * MAX_COORDINATE;
        let message = "`camera.near` puts the start of some camera rays out of reach";
        let help = "lower `near`, or narrow the view";
        if is_near { Ok(()) } else { Err(Error::input(message).with_help(help)) }
    }

    fn find_lamps(&self) -> Vec<Lamp> {
        if !self.materials.iter().any(Material::is_emissive) {
            return Vec::new();
        }
        let lamp = |id| {
            let material = self.surface(id).material;
            let emission = material.emission * material.opacity;
            (emission.max_element() > 0.0).then_some(Lamp { id, emission })
        };
        (0..self.spheres.len() as u32).into_par_iter().filter_map(lamp).collect()
    }

    fn find_media_around_camera(&self) -> Vec<(Sphere, Medium)> {
        if !self.has_media {
            return Vec::new();
        }
        let margin = self.description.image.filter_radius;
        let around = |id| {
            let medium = self.surface(id).medium(id)?;
            let sphere = self.spheres.sphere(id);
            self.camera.may_start_in(&sphere, margin).then_some((sphere, medium))
        };
        let mut found: Vec<_> =
            (0..self.spheres.len() as u32).into_par_iter().filter_map(around).collect();
        found.sort_by(|(a, _), (b, _)| b.radius.total_cmp(&a.radius));
        found
    }
}

fn camera(description: &Description, origin: DVec3) -> Camera {
    let description::Camera { position, look_at, up, near, projection } = description.camera;
    let mount = Mount {
        position: position - origin,
        towards: look_at - position,
        up,
        near,
        size: [description.image.width, description.image.height],
    };
    let thin = |lens: description::Lens| {
        let rotation = lens.rotation_degrees.to_radians();
        let aperture = Aperture { radius: lens.radius, blades: lens.blades, rotation };
        Lens { aperture, focus_distance: lens.focus_distance }
    };
    let projection = match projection {
        description::Projection::Perspective { vertical_fov_degrees, lens } => {
            let vertical_fov = vertical_fov_degrees.to_radians();
            Projection::Perspective { vertical_fov, lens: lens.map(thin) }
        }
        description::Projection::Orthographic { height } => Projection::Orthographic { height },
        description::Projection::Panoramic { horizontal_degrees, vertical_degrees } => {
            let [horizontal, vertical] =
                [horizontal_degrees, vertical_degrees].map(f64::to_radians);
            Projection::Panoramic { horizontal, vertical }
        }
    };
    Camera::new(&mount, projection)
}
