//! Predicts the memory of a render before any of it is allocated, from the scene description, the
//! lengths of its tables, and the intersectors' own estimates.
//!
//! A render runs in phases: the tables are read, the spheres sorted, the tree built, the picture
//! rendered. The peak is the maximum over the phases.

use crate::accel::Backend;
use crate::film::{Aov, Film, RadianceScale};
use crate::scene::SceneFile;
use crate::scene::description::{ColorStorage, SceneDescription};

use super::film_format::format_for_settings;

/// Bytes per sphere: `[x, y, z, radius]` in f32.
const SPHERE_BYTES: u64 = 16;
/// Additional bytes per sphere in f64.
const F64_BYTES: u64 = 16;
/// Bytes per sphere for the emission of its row.
const EMISSION_BYTES: u64 = 12;
/// Bytes per sphere for its row.
const ROW_BYTES: u64 = 4;
/// Bytes per inline sphere, in the scene description and in copies of it.
const INLINE_SPHERE_BYTES: u64 = 256;
/// Bytes per emitter, in the list and the light hierarchy.
const EMITTER_BYTES: u64 = 288;
/// Bytes per environment map pixel: the image and its sampling distribution.
const ENVIRONMENT_PIXEL_BYTES: u64 = 48;
/// Bytes per pixel of the finished picture and its encoded file.
const PICTURE_PIXEL_BYTES: u64 = 32;
/// Bytes of the program itself, without and with the Embree library.
const PROGRAM_BYTES: [u64; 2] = [10 << 20, 12 << 20];
/// Bytes of path state per thread.
const THREAD_BYTES: u64 = 1 << 20;

/// The memory plan of one render. All figures are bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MemoryPlan {
    /// The spheres themselves.
    pub spheres: u64,
    /// The rows of the spheres.
    pub rows: u64,
    /// Per-sphere colours.
    pub colors: u64,
    /// Per-sphere emission.
    pub emission: u64,
    /// The emitters and their light hierarchy.
    pub emitters: u64,
    /// The environment map.
    pub background: u64,
    /// The finished trees of all intersectors.
    pub accel: u64,
    /// Peak memory of the trees during construction.
    pub accel_build: u64,
    /// Film and picture.
    pub film: u64,
    /// The program and its threads.
    pub program: u64,
}

/// The phase in which memory use peaks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MemoryPhase {
    /// The spheres are sorted.
    Sorting,
    /// The trees are built.
    Building,
    /// The picture is rendered.
    Rendering,
}

impl MemoryPlan {
    /// Plans a scene whose tables have not been read yet. The backends are built one after the
    /// other and kept; the picture has the layers `aovs`. `colors` overrides how table colours are
    /// stored.
    pub fn new(
        file: &SceneFile,
        backends: &[Backend],
        aovs: &[Aov],
        threads: usize,
        colors: Option<ColorStorage>,
    ) -> Self {
        let description = &file.description;
        // Emitter brightness does not affect the film size.
        let transparent = description.background.transparent;
        let scale = RadianceScale::from_max_radiance(1.0);
        let format = format_for_settings(&file.settings, transparent, scale, aovs);
        let written_out = description.spheres.len() as u64;
        let bare = Self::for_spheres(file.sphere_count(), backends, threads);
        Self {
            spheres: bare.spheres + file.f64_rows() * F64_BYTES + written_out * INLINE_SPHERE_BYTES,
            colors: color_bytes(file, colors),
            emission: emission_bytes(file),
            emitters: emitter_count(file) * EMITTER_BYTES,
            background: file.environment_pixels() * ENVIRONMENT_PIXEL_BYTES,
            film: Film::bytes(&format) as u64
                + format.frame.pixel_count() as u64 * PICTURE_PIXEL_BYTES,
            ..bare
        }
    }

    /// Plans for `count` spheres and these intersectors, without film, colours or emitters.
    pub fn for_spheres(count: u64, backends: &[Backend], threads: usize) -> Self {
        let mut trees = AccelMemory::default();
        backends.iter().for_each(|backend| trees.build(*backend, count));
        let with_embree = backends.iter().any(|backend| backend.uses_embree());
        Self {
            spheres: count * SPHERE_BYTES,
            rows: count * ROW_BYTES,
            colors: 0,
            emission: 0,
            emitters: 0,
            background: 0,
            accel: trees.finished,
            accel_build: trees.peak,
            film: 0,
            program: PROGRAM_BYTES[usize::from(with_embree)] + threads as u64 * THREAD_BYTES,
        }
    }

    /// Peak memory in bytes.
    pub fn peak(&self) -> u64 {
        self.bytes_in(self.peak_phase())
    }

    /// The phase with the peak memory.
    pub fn peak_phase(&self) -> MemoryPhase {
        let steps = [MemoryPhase::Sorting, MemoryPhase::Building, MemoryPhase::Rendering];
        steps.into_iter().max_by_key(|&step| self.bytes_in(step)).unwrap_or(MemoryPhase::Rendering)
    }

    /// Peak memory within a phase, in bytes.
    pub fn bytes_in(&self, step: MemoryPhase) -> u64 {
        let tables = self.spheres + self.rows + self.colors + self.emission;
        let scene = tables + self.background + self.program;
        match step {
            // Sorting holds the spheres in both the old and the new order.
            MemoryPhase::Sorting => scene + self.spheres,
            MemoryPhase::Building => scene + self.emitters + self.accel_build,
            MemoryPhase::Rendering => scene + self.emitters + self.accel + self.film,
        }
    }
}

/// Memory of trees that are built one after the other.
#[derive(Default)]
struct AccelMemory {
    finished: u64,
    peak: u64,
}

impl AccelMemory {
    fn build(&mut self, backend: Backend, spheres: u64) {
        let planned = backend.memory_estimate(spheres);
        self.peak = self.peak.max(self.finished + planned.peak);
        self.finished += planned.built;
    }
}

fn color_bytes(file: &SceneFile, storage: Option<ColorStorage>) -> u64 {
    let tables = file.description.tables.iter().zip(file.table_rows());
    let colored = tables.filter(|(table, _)| table.data.has_colors());
    let bytes = colored
        .map(|(table, rows)| rows * storage.unwrap_or(table.colors).bytes_per_color() as u64);
    bytes.sum()
}

fn emission_bytes(file: &SceneFile) -> u64 {
    let tables = file.description.tables.iter().zip(file.table_rows());
    let emissive = tables.filter(|(table, _)| table.data.has_emission());
    emissive.map(|(_, rows)| rows * EMISSION_BYTES).sum()
}

/// Number of emitters, if every row with its own emission shines.
fn emitter_count(file: &SceneFile) -> u64 {
    let SceneDescription { materials, spheres, tables, .. } = &file.description;
    let shines = |material: usize| materials[material].emission.max_element() > 0.0;
    let written_out = spheres.iter().filter(|sphere| shines(sphere.material)).count() as u64;
    let of_tables = tables.iter().zip(file.table_rows());
    let of_tables = of_tables
        .filter(|(table, _)| table.data.has_emission() || shines(table.material))
        .map(|(_, rows)| rows);
    written_out + of_tables.sum::<u64>()
}
