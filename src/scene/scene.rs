//! The scene as the renderer sees it: immutable, in coordinates relative to the spheres' origin.

use std::hint::black_box;
use std::sync::Arc;

use rayon::prelude::*;

use crate::color::{PathRadiance, Rgb};
use crate::error::Result;
use crate::geometry::SphereSet;
use crate::light::{Emitter, Environment, LightSamplerKind, Lights};
use crate::material::Material;
use crate::math::{DVec3, Hit};

use super::description::SceneDescription;
use super::environment;
use super::import::{ImportPlan, RowGroup, load_tables};
use super::source::{ContentHash, FileHash, SceneHashes, SceneSource};
use super::sphere_material::{SphereMaterial, build_materials};
use super::validation_errors::ValidationErrors;

/// So many spheres stay in a processor's near memory by themselves.
const PREFETCH_MIN_SPHERES: usize = 1000;

/// A scene: checked, immutable, and shared by all its clones.
#[derive(Clone, Debug)]
pub struct Scene {
    description: Arc<SceneDescription>,
    source: Option<Arc<SceneSource>>,
    content_hash: ContentHash,
    files: Arc<[FileHash]>,
    spheres: Arc<SphereSet>,
    materials: Arc<[Material]>,
    has_opacity: bool,
    has_media: bool,
    groups: Arc<[RowGroup]>,
    emitters: Arc<[Emitter]>,
    background: Arc<Environment>,
}

impl Scene {
    /// Checks values and makes a scene of them. Files are read, and so are arrays in memory: each is let go
    /// of as soon as it is read.
    ///
    /// # Errors
    /// All mistakes at once; when there is no memory for the spheres.
    pub fn build(description: SceneDescription) -> Result<Self> {
        let mut problems = description.validate();
        if problems.0.is_empty() {
            let survey = ImportPlan::scan(&description, &mut problems);
            if problems.0.is_empty() {
                return Self::assemble(description, survey, None, ValidationErrors::into_result);
            }
        }
        problems.into_result()?;
        unreachable!("there are problems")
    }

    /// Makes a scene of values that were checked; `refuse` tells of problems with its tables.
    pub(super) fn assemble(
        mut description: SceneDescription,
        survey: ImportPlan,
        source: Option<SceneSource>,
        refuse: impl FnOnce(ValidationErrors) -> Result<()>,
    ) -> Result<Self> {
        description.make_canonical();
        let mut problems = ValidationErrors::default();
        let (rows, groups) = load_tables(&mut description, &survey, &mut problems)?;
        if !problems.0.is_empty() {
            refuse(problems)?;
        }
        let ImportPlan { environment, .. } = survey;
        let hashes = SceneHashes::new(&description, &rows, &groups, environment.as_ref());
        let identity = hashes.scene_hash(&description);
        let spheres = Arc::new(SphereSet::new(rows)?);
        let materials = build_materials(&description.materials);
        let has_opacity = materials.iter().any(|material| material.opacity < 1.0);
        let has_media = materials.iter().any(|material| material.dielectric().is_some());
        let background = environment::build_background(&description.background, environment);
        let mut scene = Self {
            description: Arc::new(description),
            source: source.map(Arc::new),
            content_hash: identity,
            files: hashes.files.into(),
            spheres,
            materials: materials.into(),
            has_opacity,
            has_media,
            groups: groups.into(),
            emitters: Vec::new().into(),
            background: Arc::new(background),
        };
        scene.emitters = scene.find_emitters().into();
        Ok(scene)
    }

    /// The scene with the paths of `description`, which differs in nothing but the folders of its files.
    pub(crate) fn with_description(mut self, description: SceneDescription) -> Self {
        self.description = Arc::new(description);
        self
    }

    /// What the user wrote, without arrays in memory, which the scene has taken in.
    pub fn description(&self) -> &SceneDescription {
        &self.description
    }

    /// The scene file that it was read from, if it was.
    pub fn source(&self) -> Option<&SceneSource> {
        self.source.as_deref()
    }

    /// The files that were read for it, in the order of its tables, then the background's image.
    pub fn files(&self) -> &[FileHash] {
        &self.files
    }

    /// What it is: scenes of one identity are the same.
    pub fn content_hash(&self) -> ContentHash {
        self.content_hash
    }

    /// All spheres.
    pub fn spheres(&self) -> &Arc<SphereSet> {
        &self.spheres
    }

    /// All emitters, and the choice among them.
    pub fn lights(&self, by: LightSamplerKind) -> Lights {
        Lights::with_sampler(
            by,
            Arc::clone(&self.emitters),
            &self.spheres,
            Arc::clone(&self.background),
        )
    }

    /// How many spheres are emitters.
    pub fn emitter_count(&self) -> usize {
        self.emitters.len()
    }

    /// The radiance seen by a ray in this direction that meets nothing.
    pub fn background_radiance(&self, direction: DVec3) -> Rgb {
        self.background.radiance(direction)
    }

    /// The largest radiance that anything in the scene sends out, in any channel.
    pub fn max_radiance(&self) -> f32 {
        let emissions = self.materials.iter().map(|material| material.emission.max_element());
        let brightest = emissions.fold(self.background.max_radiance(), f32::max);
        // Two that each fit may not fit together: a dome and a sun before it.
        brightest.min(f32::MAX)
    }

    /// Whether the camera sees the background.
    pub fn camera_sees_background(&self) -> bool {
        self.description.background.camera_visible
    }

    /// What a camera ray in this direction brings that meets nothing: the background, unless it is
    /// hidden from the camera.
    pub fn camera_background(&self, direction: DVec3) -> PathRadiance {
        let direct = if self.camera_sees_background() {
            self.background_radiance(direction)
        } else {
            Rgb::ZERO
        };
        PathRadiance { direct, indirect: Rgb::ZERO, alpha: 0.0 }
    }

    /// What a sphere is made of.
    pub fn sphere_material(&self, id: u32) -> SphereMaterial<'_> {
        let (material, color) = self.material_and_color(id);
        SphereMaterial::new(material, color, || self.spheres.sphere(id).radius)
    }

    /// What a sphere is made of, and its own colour where a table gives one.
    #[inline(always)]
    pub(crate) fn material_and_color(&self, id: u32) -> (&Material, Option<Rgb>) {
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
    /// near at hand; see [`SphereSet::prefetch`].
    pub fn prefetch(&self, hits: &[Hit]) {
        if self.spheres.len() <= PREFETCH_MIN_SPHERES {
            return;
        }
        let ids = || hits.iter().filter(|hit| !hit.is_miss()).map(|hit| hit.id);
        self.spheres.prefetch(ids());
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

    /// The index of the material of the sphere in a row of the scene.
    ///
    /// # Panics
    /// Panics where the scene has no such row.
    pub fn material_of_row(&self, row: u32) -> usize {
        self.demand_row(row);
        match self.description.spheres.get(row as usize) {
            Some(sphere) => sphere.material,
            None => self.group_of(row).material,
        }
    }

    /// The name of the sphere in a row of the scene, or of its place: `sphere 3`, or `grains.f32:17` for
    /// a row of the table `grains.f32`.
    ///
    /// # Panics
    /// Panics where the scene has no such row.
    pub fn name_of_row(&self, row: u32) -> String {
        self.demand_row(row);
        match self.description.spheres.get(row as usize) {
            Some(sphere) => sphere.name.clone().unwrap_or_else(|| format!("sphere {row}")),
            None => {
                let group = self.group_of(row);
                let ids = group.ids.as_deref();
                let in_table = row - group.first_row;
                let id = ids.map_or(in_table, |ids| ids[in_table as usize]);
                format!("{}:{id}", self.table_of_row(row))
            }
        }
    }

    /// The [name](SceneDescription::name_of_table) of the table that a row of the scene comes from; `spheres`
    /// for the spheres that are described one by one.
    ///
    /// # Panics
    /// Panics where the scene has no such row.
    pub fn table_of_row(&self, row: u32) -> String {
        self.demand_row(row);
        if (row as usize) < self.description.spheres.len() {
            return "spheres".to_owned();
        }
        self.description.name_of_table(self.index_of_group(row))
    }

    /// What the layer `sphere_id` shows for a row: the user's own number where a table has some.
    ///
    /// # Panics
    /// Panics where the scene has no such row.
    pub fn id_of_row(&self, row: u32) -> u32 {
        self.demand_row(row);
        if (row as usize) < self.description.spheres.len() {
            return row;
        }
        let group = self.group_of(row);
        let ids = group.ids.as_ref().map(|ids| ids.as_slice()[(row - group.first_row) as usize]);
        ids.unwrap_or(row)
    }

    /// The table that a row comes from, of those that are no spheres of the scene file.
    fn group_of(&self, row: u32) -> &RowGroup {
        &self.groups[self.index_of_group(row)]
    }

    fn index_of_group(&self, row: u32) -> usize {
        self.groups.partition_point(|group| group.first_row <= row) - 1
    }

    fn demand_row(&self, row: u32) {
        let end = match self.groups.last() {
            Some(group) => group.first_row + group.count,
            None => self.description.spheres.len() as u32,
        };
        assert!(row < end, "the scene has {end} rows, and no row {row}");
    }

    /// The name of a sphere, where the scene gives one.
    pub fn name(&self, id: u32) -> Option<&str> {
        self.description.spheres.get(self.spheres.row(id) as usize)?.name.as_deref()
    }

    fn find_emitters(&self) -> Vec<Emitter> {
        if !self.materials.iter().any(Material::is_emissive) {
            return Vec::new();
        }
        let lamp = |id| {
            let material = self.sphere_material(id).material;
            let emission = material.emission * material.opacity;
            (emission.max_element() > 0.0).then_some(Emitter { id, emission })
        };
        (0..self.spheres.len() as u32).into_par_iter().filter_map(lamp).collect()
    }
}
