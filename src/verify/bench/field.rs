//! Who is measured, and with which rays.

use std::sync::Arc;
use std::time::Instant;

use crate::accel::{Accel, Backend, BuildOptions};
use crate::camera::Camera;
use crate::error::Result;
use crate::geometry::{PathRay, SphereSet};
use crate::math::Ray;
use crate::verify::rays;

use super::measurement::{Figure, SAMPLES_PER_PIXEL};

/// Kinds of rays that [`Field::kinds_of_rays`] makes.
pub const KINDS: usize = 4;

/// What rays of the camera are called.
pub const CAMERA: &str = "camera";

/// What rays after two diffuse bounces are called: those that no cache helps.
pub const SECOND_BOUNCE: &str = "second bounce";

/// Chooses the directions of bounces and shadow rays.
const SEED: u64 = 0;

/// Rays of one kind to measure with.
#[derive(Clone, Debug)]
pub struct RayKind {
    /// What they are called.
    pub name: &'static str,
    /// The rays, in the order in which an integrator would ask.
    pub rays: Vec<Ray>,
}

/// The backends that are held against each other, over the same spheres.
pub struct Field {
    pub(super) spheres: Arc<SphereSet>,
    pub(super) built: Vec<Built>,
}

/// One of them.
pub(super) struct Built {
    pub(super) backend: Backend,
    pub(super) accel: Box<dyn Accel>,
    /// Of each build.
    pub(super) seconds: Figure,
}

impl Field {
    /// Builds each backend so many times, at least once, in turns, and keeps the last of each.
    ///
    /// # Errors
    /// When one cannot be built, or on cancellation through `options`.
    pub fn build(
        spheres: &Arc<SphereSet>,
        backends: &[Backend],
        options: &BuildOptions,
        times: usize,
    ) -> Result<Self> {
        let timed = |backend: Backend| {
            let start = Instant::now();
            let accel = backend.build(spheres, options)?;
            Ok((accel, start.elapsed().as_secs_f64()))
        };
        let mut seconds = vec![Vec::new(); backends.len()];
        for _ in 1..times {
            for (&backend, seconds) in backends.iter().zip(&mut seconds) {
                seconds.push(timed(backend)?.1);
            }
        }
        let mut built = Vec::new();
        for (&backend, mut all) in backends.iter().zip(seconds) {
            let (accel, seconds) = timed(backend)?;
            all.push(seconds);
            let seconds = Figure::of(all).unwrap_or(Figure::once(seconds));
            built.push(Built { backend, accel, seconds });
        }
        Ok(Self { spheres: spheres.clone(), built })
    }

    /// The spheres.
    pub fn spheres(&self) -> &Arc<SphereSet> {
        &self.spheres
    }

    /// Each backend with its structure, in the order asked for.
    pub fn contenders(&self) -> impl Iterator<Item = (Backend, &dyn Accel)> {
        self.built.iter().map(|built| (built.backend, &*built.accel))
    }

    pub(super) fn accels(&self) -> impl Iterator<Item = &dyn Accel> {
        self.contenders().map(|(_, accel)| accel)
    }

    /// Returns the ray kinds to measure: camera rays, their bounces at diffuse surfaces, and shadow
    /// rays. The first backend determines the hits.
    pub fn kinds_of_rays(&self, camera: Vec<PathRay>) -> Vec<RayKind> {
        let (spheres, accel) = (&*self.spheres, self.accels().next());
        let Some(accel) = accel else { return Vec::new() };
        let first = rays::bounces(spheres, accel, &camera, SEED);
        let second = rays::bounces(spheres, accel, &first, SEED + 1);
        let shadow = rays::shadows(spheres, accel, &camera, SEED + 2);
        let kinds: [_; KINDS] = [
            (CAMERA, camera),
            ("first bounce", first),
            (SECOND_BOUNCE, second),
            ("shadow", shadow),
        ];
        let ask = |(name, rays): (_, Vec<PathRay>)| RayKind {
            name,
            rays: rays.iter().map(|ray| spheres.ask(ray)).collect(),
        };
        kinds.into_iter().map(ask).collect()
    }
}

/// Rays of a camera with so many pixels as a render sends them, sixteen through each pixel: of all
/// pixels, or of as many in a grid over the picture as at most `most` rays allow.
pub fn camera_rays(camera: &Camera, [width, height]: [u32; 2], most: usize) -> Vec<PathRay> {
    let side = (SAMPLES_PER_PIXEL as f64).sqrt() as u32;
    let rays = |step: u32| {
        (width.div_ceil(step) as usize * height.div_ceil(step) as usize) * SAMPLES_PER_PIXEL
    };
    let step = (1..).find(|&step| step >= width.max(height) || rays(step) <= most).unwrap_or(1);
    let place =
        |pixel: u32, cell: u32| f64::from(pixel) + (f64::from(cell) + 0.5) / f64::from(side);
    let columns = || (0..width).step_by(step as usize);
    let pixels = (0..height).step_by(step as usize).flat_map(|y| columns().map(move |x| (x, y)));
    let cells = || (0..side).flat_map(|row| (0..side).map(move |column| (column, row)));
    let ray = |(x, y), (column, row)| camera.ray(place(x, column), place(y, row), MIDDLE_OF_LENS);
    pixels.flat_map(|pixel| cells().map(move |cell| ray(pixel, cell))).collect()
}

/// Which two numbers give the middle of a lens, or nearly so where it has blades.
const MIDDLE_OF_LENS: [f64; 2] = [0.5; 2];
