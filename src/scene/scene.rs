//! The scene as the renderer sees it: immutable, in coordinates relative to the spheres' origin.

use std::hint::black_box;
use std::sync::Arc;

use rayon::prelude::*;

use crate::color::{PathRadiance, Rgb};
use crate::error::Result;
use crate::geometry::SphereSet;
use crate::light::{Emitter, EmitterCuts, Enclosure, Environment, LightSamplerKind, Lights};
use crate::material::Material;
use crate::math::{DVec3, Hit};

use super::description::SceneDescription;
use super::environment;
use super::import::{ImportPlan, RowGroup, load_tables};
use super::size::SceneSize;
use super::source::{ContentHash, FileHash, SceneHashes, SceneSource};
use super::sphere_material::{EmissiveMaterial, SphereMaterial, Surface, build_materials};
use super::straight_boundaries;
use super::validation_errors::ValidationErrors;

/// Fewer spheres than this stay in the processor's cache without prefetching.
const PREFETCH_MIN_SPHERES: usize = 1000;

/// A validated, immutable scene, shared by all its clones.
#[derive(Clone, Debug)]
pub struct Scene {
    description: Arc<SceneDescription>,
    source: Option<Arc<SceneSource>>,
    content_hash: ContentHash,
    size: SceneSize,
    files: Arc<[FileHash]>,
    spheres: Arc<SphereSet>,
    materials: Arc<[Material]>,
    has_opacity: bool,
    has_media: bool,
    has_straight_boundaries: bool,
    has_shadow_catchers: bool,
    /// The largest emission of a table's rows.
    max_row_emission: f32,
    groups: Arc<[RowGroup]>,
    emitters: Arc<[Emitter]>,
    emitter_cuts: Arc<EmitterCuts>,
    background: Arc<Environment>,
}

impl Scene {
    /// Validates a description and builds a scene from it. Reads files and arrays; each array is
    /// released as soon as it is read.
    ///
    /// # Errors
    /// Reports all errors at once; also if the spheres do not fit into memory.
    pub fn build(mut description: SceneDescription) -> Result<Self> {
        let mut problems = description.validate();
        if problems.0.is_empty() {
            let survey = ImportPlan::scan(&mut description, &mut problems);
            if problems.0.is_empty() {
                return Self::assemble(description, survey, None, ValidationErrors::into_result);
            }
        }
        problems.into_result()?;
        unreachable!("there are problems")
    }

    /// Builds a scene from validated values. `refuse` reports problems with its tables.
    pub(super) fn assemble(
        mut description: SceneDescription,
        mut survey: ImportPlan,
        source: Option<SceneSource>,
        refuse: impl FnOnce(ValidationErrors) -> Result<()>,
    ) -> Result<Self> {
        description.make_canonical();
        let mut problems = ValidationErrors::default();
        let size = SceneSize::new(&description, &survey);
        let environment = survey.environment.take();
        let (rows, groups) = load_tables(&mut description, survey, &mut problems)?;
        if !problems.0.is_empty() {
            refuse(problems)?;
        }
        let hashes = SceneHashes::new(&description, &rows, &groups, environment.as_ref());
        let identity = hashes.scene_hash(&description);
        let spheres = Arc::new(SphereSet::new(rows)?);
        let materials = build_materials(&description.materials);
        let has_opacity = materials.iter().any(|material| material.opacity < 1.0);
        let has_media = materials.iter().any(|material| material.dielectric().is_some());
        let max_row_emission = groups.iter().map(RowGroup::max_emission).fold(0.0, f32::max);
        let background = environment::build_background(&description.background, environment);
        let has_shadow_catchers = description.spheres.iter().any(|sphere| sphere.shadow_catcher);
        let mut scene = Self {
            description: Arc::new(description),
            source: source.map(Arc::new),
            content_hash: identity,
            size,
            files: hashes.files.into(),
            spheres,
            materials: materials.into(),
            has_opacity,
            has_media,
            has_straight_boundaries: false,
            has_shadow_catchers,
            max_row_emission,
            groups: groups.into(),
            emitters: Vec::new().into(),
            emitter_cuts: Arc::default(),
            background: Arc::new(background),
        };
        scene.emitters = scene.find_emitters().into();
        let medium = |id| scene.sphere_material(id).medium(id);
        scene.has_straight_boundaries =
            has_media && straight_boundaries::may_exist(&scene.materials, &scene.spheres, medium);
        scene.emitter_cuts = Arc::new(scene.find_emitter_cuts(&[]));
        Ok(scene)
    }

    fn find_emitter_cuts(&self, enclosures: &[Enclosure]) -> EmitterCuts {
        let is_opaque = |id| self.sphere_material(id).is_opaque();
        EmitterCuts::find(&self.emitters, &self.spheres, is_opaque, enclosures)
    }

    /// Replaces the description by one that differs only in the folders of its files.
    pub(crate) fn with_description(mut self, description: SceneDescription) -> Self {
        self.description = Arc::new(description);
        self
    }

    /// The description, without arrays in memory, whose data is now in the scene.
    pub fn description(&self) -> &SceneDescription {
        &self.description
    }

    /// The scene file from which the scene was read, if any.
    pub fn source(&self) -> Option<&SceneSource> {
        self.source.as_deref()
    }

    /// The files of the scene, in the order of its tables, then the environment map.
    pub fn files(&self) -> &[FileHash] {
        &self.files
    }

    /// Content hash of the scene; equal hashes mean equal scenes.
    pub fn content_hash(&self) -> ContentHash {
        self.content_hash
    }

    /// The size of the scene, as it was known before its tables were read.
    pub fn size(&self) -> SceneSize {
        self.size
    }

    /// All spheres.
    pub fn spheres(&self) -> &Arc<SphereSet> {
        &self.spheres
    }

    /// The light sampler over all emitters, of this kind, given the opaque spheres around the
    /// camera.
    pub fn lights(&self, by: LightSamplerKind, enclosures: &[Enclosure]) -> Lights {
        let cuts = match enclosures.is_empty() {
            true => Arc::clone(&self.emitter_cuts),
            false => Arc::new(self.find_emitter_cuts(enclosures)),
        };
        Lights::with_sampler(
            by,
            Arc::clone(&self.emitters),
            cuts,
            &self.spheres,
            Arc::clone(&self.background),
        )
    }

    /// Number of emissive spheres.
    pub fn emitter_count(&self) -> usize {
        self.emitters.len()
    }

    /// Background radiance for a ray in this direction that misses all spheres.
    pub fn background_radiance(&self, direction: DVec3) -> Rgb {
        self.background.radiance(direction)
    }

    /// The largest radiance emitted in the scene, over all channels.
    pub fn max_radiance(&self) -> f32 {
        let emissions = self.materials.iter().map(|material| material.emission.max_element());
        let brightest = emissions.fold(self.background.max_radiance(), f32::max);
        let brightest = brightest.max(self.max_row_emission);
        let backdrop = self.description.background.backdrop.unwrap_or(Rgb::ZERO);
        let brightest = brightest.max(backdrop.max_element());
        // The environment map and the sun are each finite, but their sum may overflow.
        brightest.min(f32::MAX)
    }

    /// Returns true if something lights the scene: an emitter or the background.
    pub fn has_light(&self) -> bool {
        self.emitter_count() > 0 || self.background.max_radiance() > 0.0
    }

    /// What a camera ray that misses all spheres sees in place of this radiance of the background.
    pub fn seen_by_camera(&self, radiance: Rgb) -> Rgb {
        let background = &self.description.background;
        let hidden = if background.camera_visible { radiance } else { Rgb::ZERO };
        background.backdrop.unwrap_or(hidden)
    }

    /// The contribution of a camera ray that misses all spheres: the backdrop; or the background,
    /// unless it is hidden from the camera.
    pub fn camera_background(&self, direction: DVec3) -> PathRadiance {
        let direct = self.seen_by_camera(self.background_radiance(direction));
        PathRadiance { direct, indirect: Rgb::ZERO, alpha: 0.0 }
    }

    /// All materials.
    pub(super) fn materials(&self) -> &[Material] {
        &self.materials
    }

    /// The material of a sphere.
    pub fn sphere_material(&self, id: u32) -> SphereMaterial<'_> {
        let Surface { material, color, emission } = self.surface(id);
        let material = EmissiveMaterial::new(material, emission);
        SphereMaterial::new(material, color, || self.spheres.sphere(id).radius)
    }

    /// The material of a sphere, and its own colour and emission if a table gives them.
    #[inline(always)]
    pub(crate) fn surface(&self, id: u32) -> Surface<'_> {
        let row = self.spheres.row(id);
        if let Some(sphere) = self.description.spheres.get(row as usize) {
            let material = &self.materials[sphere.material];
            return Surface { material, color: None, emission: None };
        }
        let group = self.group_of(row);
        let in_table = (row - group.first_row) as usize;
        Surface {
            material: &self.materials[group.material],
            color: group.color(in_table),
            emission: group.emission(in_table),
        }
    }

    /// Prefetches the data of the spheres that were hit, unless all spheres fit into the cache; see
    /// [`SphereSet::prefetch`].
    pub fn prefetch(&self, hits: &[Hit]) {
        if self.spheres.len() <= PREFETCH_MIN_SPHERES {
            return;
        }
        let ids = || hits.iter().filter(|hit| !hit.is_miss()).map(|hit| hit.id);
        self.spheres.prefetch(ids());
        if self.groups.iter().any(|group| group.colors.is_some() || group.emission.is_some()) {
            let read = |id: u32| {
                let row = self.spheres.row(id);
                let group =
                    (row as usize >= self.description.spheres.len()).then(|| self.group_of(row))?;
                let in_table = (row - group.first_row) as usize;
                let first = |color: Option<Rgb>| color.map_or(0, |color| color.x.to_bits());
                Some(first(group.color(in_table)) ^ first(group.emission(in_table)))
            };
            black_box(ids().filter_map(read).fold(0, |all, bits| all ^ bits));
        }
    }

    /// Returns true if some material has an opacity below 1.
    pub fn has_opacity(&self) -> bool {
        self.has_opacity
    }

    /// Returns true if some material is a dielectric.
    pub fn has_media(&self) -> bool {
        self.has_media
    }

    /// The indices of refraction of all media.
    pub(super) fn iors(&self) -> impl Iterator<Item = f64> + '_ {
        self.materials.iter().filter_map(|material| Some(material.dielectric()?.ior))
    }

    /// Returns true if light may pass some dielectric boundary in a straight line; false only if it
    /// cannot. See [`SphereMaterial::is_straight`].
    pub fn has_straight_boundaries(&self) -> bool {
        self.has_straight_boundaries
    }

    /// Returns true if there is a shadow catcher.
    pub fn has_shadow_catchers(&self) -> bool {
        self.has_shadow_catchers
    }

    /// Returns true if the camera sees only the shadow on this sphere.
    pub fn is_shadow_catcher(&self, id: u32) -> bool {
        let single = self.description.spheres.get(self.spheres.row(id) as usize);
        single.is_some_and(|sphere| sphere.shadow_catcher)
    }

    /// Returns true if shadow rays may pass surfaces.
    pub fn has_passable_surfaces(&self) -> bool {
        self.has_opacity || self.has_straight_boundaries
    }

    /// Material index of the sphere in a row of the scene.
    ///
    /// # Panics
    /// If the scene has no such row.
    pub fn material_of_row(&self, row: u32) -> usize {
        self.demand_row(row);
        match self.description.spheres.get(row as usize) {
            Some(sphere) => sphere.material,
            None => self.group_of(row).material,
        }
    }

    /// The name of the sphere in a row of the scene, or a name from its position: `spheres.3`, as
    /// in `--set`, or `grains.f32:17` for a row of the table `grains.f32`.
    ///
    /// # Panics
    /// If the scene has no such row.
    pub fn name_of_row(&self, row: u32) -> String {
        self.demand_row(row);
        match self.description.spheres.get(row as usize) {
            Some(sphere) => sphere.name.clone().unwrap_or_else(|| format!("spheres.{row}")),
            None => {
                let group = self.group_of(row);
                let ids = group.ids.as_deref();
                let in_table = row - group.first_row;
                let id = ids.map_or(in_table, |ids| ids[in_table as usize]);
                format!("{}:{id}", self.table_of_row(row))
            }
        }
    }

    /// The [name](SceneDescription::name_of_table) of the table that contains a row of the scene;
    /// `spheres` for individually described spheres.
    ///
    /// # Panics
    /// If the scene has no such row.
    pub fn table_of_row(&self, row: u32) -> String {
        self.demand_row(row);
        if (row as usize) < self.description.spheres.len() {
            return "spheres".to_owned();
        }
        self.description.name_of_table(self.index_of_group(row))
    }

    /// The value of a row in the AOV `sphere_id`: the user's id if its table has ids, otherwise the
    /// row.
    ///
    /// # Panics
    /// If the scene has no such row.
    pub fn id_of_row(&self, row: u32) -> u32 {
        self.demand_row(row);
        if (row as usize) < self.description.spheres.len() {
            return row;
        }
        let group = self.group_of(row);
        let ids = group.ids.as_ref().map(|ids| ids.as_slice()[(row - group.first_row) as usize]);
        ids.unwrap_or(row)
    }

    /// Index of the table that contains a row of the scene, and the row within it; `None` for an
    /// individually described sphere.
    ///
    /// # Panics
    /// If the scene has no such row.
    pub fn table_and_row(&self, row: u32) -> Option<(usize, u32)> {
        self.demand_row(row);
        if (row as usize) < self.description.spheres.len() {
            return None;
        }
        let index = self.index_of_group(row);
        Some((index, row - self.groups[index].first_row))
    }

    /// The row of the scene that has this id in a table, or is this row of a table without ids.
    pub(super) fn row_with_id(&self, table: usize, id: u32) -> Option<u32> {
        let group = &self.groups[table];
        let in_table = match &group.ids {
            Some(ids) => ids.iter().position(|other| *other == id)? as u32,
            None => id,
        };
        (in_table < group.count).then_some(group.first_row + in_table)
    }

    /// The table that contains a row. The row must not be an individually described sphere.
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

    /// The name of a sphere, if the scene gives one.
    pub fn name(&self, id: u32) -> Option<&str> {
        self.description.spheres.get(self.spheres.row(id) as usize)?.name.as_deref()
    }

    fn find_emitters(&self) -> Vec<Emitter> {
        let has_emission = |group: &RowGroup| group.emission.is_some();
        if !self.materials.iter().any(Material::is_emissive)
            && !self.groups.iter().any(has_emission)
        {
            return Vec::new();
        }
        let emitter = |id| {
            let surface = self.sphere_material(id);
            let emission = surface.material.emission * surface.material.opacity;
            let [transmittance, far_wall_fraction] =
                surface.far_wall_fractions(self.spheres.sphere(id).radius);
            let emitter = Emitter { id, emission, transmittance, far_wall_fraction };
            (emission.max_element() > 0.0).then_some(emitter)
        };
        (0..self.spheres.len() as u32).into_par_iter().filter_map(emitter).collect()
    }
}
