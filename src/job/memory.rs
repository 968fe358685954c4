//! Predicts the memory of a render before any of it is allocated, from the size of the
//! scene, the job, and the estimates of the intersectors.
//!
//! A render runs in phases: the tables are read, the spheres sorted, the acceleration structures
//! built, the picture rendered. The peak is the maximum over the phases.

use crate::accel::Backend;
use crate::film::{Film, RadianceScale};
use crate::scene::SceneSize;

use super::film_format::format_for_settings;
use super::spec::Job;

/// Bytes per sphere: `[x, y, z, radius]` in f32.
const SPHERE_BYTES: u64 = 16;
/// Bytes per sphere in f64.
const F64_BYTES: u64 = 32;
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
const PROGRAM_BYTES: [u64; 2] = [14 << 20, 16 << 20];
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
    /// The finished acceleration structures of all intersectors.
    pub accel: u64,
    /// Peak memory of the acceleration structures during construction.
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
    /// The acceleration structures are built.
    Building,
    /// The picture is rendered.
    Rendering,
}

impl MemoryPlan {
    /// Plans the render of a job, with the intersector that it selects.
    pub fn new(scene: &SceneSize, job: &Job) -> Self {
        let chosen = job.accel.select_for_count(scene.spheres as usize);
        Self::with_backends(scene, job, &[chosen.backend])
    }

    /// Plans the render of a job with these intersectors, which are built one after the other and
    /// kept.
    pub fn with_backends(scene: &SceneSize, job: &Job, backends: &[Backend]) -> Self {
        // Emitter brightness does not affect the film size.
        let scale = RadianceScale::from_max_radiance(1.0);
        let format = format_for_settings(&job.settings, scene.is_transparent, scale, &job.layers);
        let threads = match job.threads {
            0 => rayon::current_num_threads(),
            threads => threads,
        };
        let spheres_only = Self::for_spheres(scene.spheres, backends, threads);
        Self {
            spheres: sphere_bytes(scene) + scene.listed_spheres * INLINE_SPHERE_BYTES,
            colors: scene.color_bytes,
            emission: scene.emissive_rows * EMISSION_BYTES,
            emitters: scene.emitters * EMITTER_BYTES,
            background: scene.environment_pixels * ENVIRONMENT_PIXEL_BYTES,
            film: Film::bytes(&format) as u64
                + format.frame.pixel_count() as u64 * PICTURE_PIXEL_BYTES,
            ..spheres_only
        }
    }

    /// Plans for `count` spheres and these intersectors, without film, colours or emitters.
    pub fn for_spheres(count: u64, backends: &[Backend], threads: usize) -> Self {
        let mut accel = AccelMemory::default();
        backends.iter().for_each(|backend| accel.build(*backend, count));
        let with_embree = backends.iter().any(|backend| backend.uses_embree());
        Self {
            spheres: count * SPHERE_BYTES,
            rows: count * ROW_BYTES,
            colors: 0,
            emission: 0,
            emitters: 0,
            background: 0,
            accel: accel.finished,
            accel_build: accel.peak,
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
        let phases = [MemoryPhase::Sorting, MemoryPhase::Building, MemoryPhase::Rendering];
        phases
            .into_iter()
            .max_by_key(|&phase| self.bytes_in(phase))
            .unwrap_or(MemoryPhase::Rendering)
    }

    /// Peak memory within a phase, in bytes.
    pub fn bytes_in(&self, phase: MemoryPhase) -> u64 {
        let tables = self.spheres + self.rows + self.colors + self.emission;
        let scene = tables + self.background + self.program;
        match phase {
            // Sorting holds the spheres in both the old and the new order.
            MemoryPhase::Sorting => scene + self.spheres,
            MemoryPhase::Building => scene + self.emitters + self.accel_build,
            MemoryPhase::Rendering => scene + self.emitters + self.accel + self.film,
        }
    }
}

/// Memory of acceleration structures that are built one after the other.
#[derive(Default)]
struct AccelMemory {
    finished: u64,
    peak: u64,
}

impl AccelMemory {
    fn build(&mut self, backend: Backend, spheres: u64) {
        let estimate = backend.memory_estimate(spheres);
        self.peak = self.peak.max(self.finished + estimate.peak);
        self.finished += estimate.built;
    }
}

/// Spheres stay in f32 or f64 as they are written. If some are in f32, all have a row there.
fn sphere_bytes(scene: &SceneSize) -> u64 {
    match scene.spheres - scene.f64_spheres {
        0 => scene.spheres * F64_BYTES,
        _ => scene.spheres * SPHERE_BYTES + scene.f64_spheres * F64_BYTES,
    }
}
