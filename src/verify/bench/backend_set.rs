//! The backends to measure, and the rays to measure them with.

use std::sync::Arc;
use std::time::Instant;

use crate::accel::{Accel, Backend, BuildOptions};
use crate::camera::Camera;
use crate::error::Result;
use crate::geometry::{PathRay, SphereSet};
use crate::math::Ray;

use super::super::rays;
use super::measurement::{Quartiles, SAMPLES_PER_PIXEL};

/// Largest number of spheres for which brute force is worth the wait.
pub const MAX_BRUTE_FORCE_SPHERES: u64 = 10_000;

/// Number of ray sets that [`BackendSet::ray_sets`] returns.
pub const RAY_SETS: usize = 4;

/// Name of the camera ray set.
pub const CAMERA: &str = "camera";

/// Name of the ray set after two diffuse bounces. These rays are incoherent, so caches do not help.
pub const SECOND_BOUNCE: &str = "second bounce";

/// Seed for bounce and shadow-ray directions.
const SEED: u64 = 0;

/// A named set of rays to benchmark with.
#[derive(Clone, Debug)]
pub struct RaySet {
    /// Name of the set.
    pub name: &'static str,
    /// Rays in the order in which an integrator would trace them.
    pub rays: Vec<Ray>,
}

/// Backends under comparison, built over the same spheres.
pub struct BackendSet {
    pub(super) spheres: Arc<SphereSet>,
    pub(super) built: Vec<BuiltBackend>,
}

/// A backend with its acceleration structure.
pub(super) struct BuiltBackend {
    pub(super) backend: Backend,
    pub(super) accel: Box<dyn Accel>,
    /// Build time in seconds, over the repeated builds.
    pub(super) seconds: Quartiles,
}

impl BackendSet {
    /// Builds each backend `builds` times (at least once), interleaved, and keeps the last build of
    /// each.
    ///
    /// # Errors
    /// If a backend cannot be built, or on cancellation through `options`.
    pub fn build(
        spheres: &Arc<SphereSet>,
        backends: &[Backend],
        options: &BuildOptions,
        builds: usize,
    ) -> Result<Self> {
        let timed_build = |backend: Backend| {
            let start = Instant::now();
            let accel = backend.build(spheres, options)?;
            Ok((accel, start.elapsed().as_secs_f64()))
        };
        let mut seconds = vec![Vec::new(); backends.len()];
        for _ in 1..builds {
            for (&backend, seconds) in backends.iter().zip(&mut seconds) {
                seconds.push(timed_build(backend)?.1);
            }
        }
        let mut built = Vec::new();
        for (&backend, mut samples) in backends.iter().zip(seconds) {
            let (accel, seconds) = timed_build(backend)?;
            samples.push(seconds);
            let seconds =
                Quartiles::from_samples(samples).unwrap_or(Quartiles::from_single(seconds));
            built.push(BuiltBackend { backend, accel, seconds });
        }
        Ok(Self { spheres: spheres.clone(), built })
    }

    /// The spheres that all backends are built over.
    pub fn spheres(&self) -> &Arc<SphereSet> {
        &self.spheres
    }

    /// Each backend with its acceleration structure, in the order requested.
    pub fn backends(&self) -> impl Iterator<Item = (Backend, &dyn Accel)> {
        self.built.iter().map(|built| (built.backend, &*built.accel))
    }

    /// Those with which a render does not take too long: brute force only for few spheres.
    pub(super) fn feasible_backends(&self) -> impl Iterator<Item = (Backend, &dyn Accel)> {
        let is_small = self.spheres.len() as u64 <= MAX_BRUTE_FORCE_SPHERES;
        self.backends().filter(move |&(backend, _)| is_small || backend != Backend::BruteForce)
    }

    pub(super) fn accels(&self) -> impl Iterator<Item = &dyn Accel> {
        self.backends().map(|(_, accel)| accel)
    }

    /// Builds the ray sets: the camera rays given, two diffuse bounces of them, and shadow rays.
    /// Hits are found with the first backend.
    pub fn ray_sets(&self, camera: Vec<PathRay>) -> Vec<RaySet> {
        let (spheres, accel) = (&*self.spheres, self.accels().next());
        let Some(accel) = accel else { return Vec::new() };
        let first = rays::secondary(spheres, accel, &camera, SEED);
        let second = rays::secondary(spheres, accel, &first, SEED + 1);
        let shadow = rays::shadow(spheres, accel, &camera, SEED + 2);
        let ray_sets: [_; RAY_SETS] = [
            (CAMERA, camera),
            ("first bounce", first),
            (SECOND_BOUNCE, second),
            ("shadow", shadow),
        ];
        let to_ray_set = |(name, rays): (_, Vec<PathRay>)| RaySet {
            name,
            rays: rays.iter().map(|ray| spheres.to_query(ray)).collect(),
        };
        ray_sets.into_iter().map(to_ray_set).collect()
    }
}

/// Generates camera rays as a render does, 16 per pixel. Uses all pixels, or a regular grid of
/// pixels if that would exceed `max_rays` rays.
pub fn camera_rays(camera: &Camera, [width, height]: [u32; 2], max_rays: usize) -> Vec<PathRay> {
    let side = (SAMPLES_PER_PIXEL as f64).sqrt() as u32;
    let rays = |step: u32| {
        (width.div_ceil(step) as usize * height.div_ceil(step) as usize) * SAMPLES_PER_PIXEL
    };
    let step = (1..).find(|&step| step >= width.max(height) || rays(step) <= max_rays).unwrap_or(1);
    let film_position =
        |pixel: u32, cell: u32| f64::from(pixel) + (f64::from(cell) + 0.5) / f64::from(side);
    let columns = || (0..width).step_by(step as usize);
    let pixels = (0..height).step_by(step as usize).flat_map(|y| columns().map(move |x| (x, y)));
    let cells = || (0..side).flat_map(|row| (0..side).map(move |column| (column, row)));
    let camera_ray = |(x, y), (column, row)| {
        camera.generate_ray(film_position(x, column), film_position(y, row), LENS_CENTER)
    };
    pixels.flat_map(|pixel| cells().map(move |cell| camera_ray(pixel, cell))).collect()
}

/// Sample that maps to the centre of a lens, or close to it for a lens with blades.
const LENS_CENTER: [f64; 2] = [0.5; 2];
