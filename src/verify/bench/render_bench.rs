//! Benchmarks whole renders with every intersector, and the share of time spent in it.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use crate::accel::{Accel, Backend, ErrorBound};
use crate::error::{Error, Result};
use crate::film::Aov;
use crate::geometry::{PathRays, SphereSet};
use crate::image_io::Picture;
use crate::job::render_with_accel;
use crate::math::{Hit, Ray};
use crate::scene::PreparedScene;
use crate::task::CancelToken;

use super::{BackendSet, Quartiles};

/// Timings of renders with one intersector.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderBench {
    /// The intersector.
    pub backend: Backend,
    /// Render time in seconds, excluding loading and building.
    pub seconds: Quartiles,
    /// Fraction of thread time spent in the intersector. The rest is camera, shading, sampling and
    /// film.
    pub intersector_fraction: Quartiles,
    /// Rays per render, including shadow rays.
    pub rays: u64,
    /// Samples per render.
    pub samples: u64,
    /// Pixels that are not bit-identical to the first intersector's.
    pub differing_pixels: usize,
}

/// Renders the scene with every intersector of `backend_set`, interleaved, on the current rayon
/// pool. The intersectors must be built over the scene's spheres. Brute force is skipped for scenes
/// where it would take too long.
///
/// # Errors
/// If a render fails, or on cancellation.
pub fn bench_renders(
    prepared: &PreparedScene,
    backend_set: &BackendSet,
    rounds: usize,
    cancel: &CancelToken,
) -> Result<Vec<RenderBench>> {
    let mut runs: Vec<RenderRun<'_>> =
        backend_set.feasible_backends().map(RenderRun::new).collect();
    for _ in 0..rounds.max(1) {
        for run in &mut runs {
            run.repeat(prepared, cancel)?;
        }
    }
    let first = runs.first().and_then(|run| run.picture.clone()).unwrap_or_default();
    Ok(runs.iter().filter_map(|run| run.result(&first)).collect())
}

struct RenderRun<'a> {
    backend: Backend,
    accel: &'a dyn Accel,
    seconds: Vec<f64>,
    fractions: Vec<f64>,
    picture: Option<Picture>,
    rays: u64,
    samples: u64,
}

impl<'a> RenderRun<'a> {
    fn new((backend, accel): (Backend, &'a dyn Accel)) -> Self {
        let (seconds, fractions) = (Vec::new(), Vec::new());
        Self { backend, accel, seconds, fractions, picture: None, rays: 0, samples: 0 }
    }

    fn repeat(&mut self, prepared: &PreparedScene, cancel: &CancelToken) -> Result<()> {
        let in_f64 = self.backend == Backend::BruteForce;
        let timed = TimedAccel { accel: self.accel, in_f64, nanoseconds: AtomicU64::new(0) };
        let start = Instant::now();
        let image = render_with_accel(prepared, &timed, &Aov::DEFAULT, cancel)?;
        let seconds = start.elapsed().as_secs_f64().max(1e-9);
        if !image.complete {
            return Err(Error::cancelled());
        }
        let inside = 1e-9 * timed.nanoseconds.into_inner() as f64;
        self.fractions.push(inside / (seconds * rayon::current_num_threads() as f64));
        self.seconds.push(seconds);
        (self.rays, self.samples) = (image.rays, image.samples);
        self.picture.get_or_insert(image.picture);
        Ok(())
    }

    fn result(&self, first: &Picture) -> Option<RenderBench> {
        let picture = self.picture.as_ref()?;
        let differs = |&pixel: &usize| {
            let bits = |picture: &Picture| picture.beauty(pixel).to_array().map(f32::to_bits);
            bits(picture) != bits(first)
        };
        Some(RenderBench {
            backend: self.backend,
            seconds: Quartiles::from_samples(self.seconds.clone())?,
            intersector_fraction: Quartiles::from_samples(self.fractions.clone())?,
            rays: self.rays,
            samples: self.samples,
            differing_pixels: (0..picture.len()).filter(differs).count(),
        })
    }
}

/// Wraps an intersector and measures the time spent in it.
struct TimedAccel<'a> {
    accel: &'a dyn Accel,
    /// True if the intersector takes path rays in f64. For others, rays are first rounded to f32,
    /// which is not counted as the intersector's time.
    in_f64: bool,
    nanoseconds: AtomicU64,
}

impl TimedAccel<'_> {
    fn time(&self, work: impl FnOnce()) {
        let start = Instant::now();
        work();
        self.nanoseconds.fetch_add(start.elapsed().as_nanos() as u64, Ordering::Relaxed);
    }
}

impl Accel for TimedAccel<'_> {
    fn closest(&self, rays: &[Ray], hits: &mut [Hit]) {
        self.time(|| self.accel.closest(rays, hits));
    }

    fn occluded(&self, rays: &[Ray], occluded: &mut [bool]) {
        self.time(|| self.accel.occluded(rays, occluded));
    }

    fn closest_path_rays(
        &self,
        spheres: &SphereSet,
        rays: &PathRays,
        queries: &mut Vec<Ray>,
        hits: &mut [Hit],
    ) {
        if self.in_f64 {
            return self.time(|| self.accel.closest_path_rays(spheres, rays, queries, hits));
        }
        to_queries(spheres, rays, queries);
        self.closest(queries, hits);
    }

    fn occluded_path_rays(
        &self,
        spheres: &SphereSet,
        rays: &PathRays,
        queries: &mut Vec<Ray>,
        occluded: &mut [bool],
    ) {
        if self.in_f64 {
            return self.time(|| self.accel.occluded_path_rays(spheres, rays, queries, occluded));
        }
        to_queries(spheres, rays, queries);
        self.occluded(queries, occluded);
    }

    fn error_bound(&self) -> ErrorBound {
        self.accel.error_bound()
    }

    fn bytes(&self) -> usize {
        self.accel.bytes()
    }

    fn details(&self) -> String {
        self.accel.details()
    }
}

fn to_queries(spheres: &SphereSet, rays: &PathRays, queries: &mut Vec<Ray>) {
    queries.clear();
    queries.extend(rays.iter().map(|ray| spheres.to_query(&ray)));
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::accel::BuildOptions;
    use crate::scene::read_text;

    const SCENE: &str = r#"format = 1
image = { width = 12, height = 8 }
render = { samples_per_pixel = 4 }
camera = { position = [0, 0, 5], look_at = [0, 0, 0], vertical_fov_degrees = 40 }
background = { radiance = [1, 1, 1] }
materials.diffuse = { type = "diffuse", albedo = [0.5, 0.5, 0.5] }
spheres = [
  { center = [-0.8, 0, 0], radius = 0.9, material = "diffuse" },
  { center = [0.8, 0, 0], radius = 0.6, material = "diffuse" },
]
"#;

    #[test]
    fn renders_take_their_time_and_part_of_it_in_the_intersector() {
        let file = read_text("scene", SCENE, Path::new("."), &[]).unwrap();
        let (scene, settings) = file.build().unwrap();
        let prepared = PreparedScene::new(&scene, settings).unwrap();
        let backends = [Backend::Native, Backend::BruteForce];
        let options = BuildOptions::default();
        let backend_set = BackendSet::build(scene.spheres(), &backends, &options, 1).unwrap();
        let results = bench_renders(&prepared, &backend_set, 2, &options.cancel).unwrap();
        assert_eq!(results.iter().map(|result| result.backend).collect::<Vec<_>>(), backends);
        for result in &results {
            assert_eq!(result.samples, 12 * 8 * 4);
            assert!(result.rays >= result.samples, "{result:?}");
            assert!(result.seconds.median > 0.0);
            assert!(
                result.intersector_fraction.median > 0.0
                    && result.intersector_fraction.median < 1.0,
                "{result:?}"
            );
            assert_eq!(result.differing_pixels, 0);
        }
        options.cancel.cancel();
        assert!(bench_renders(&prepared, &backend_set, 1, &options.cancel).is_err());
    }
}
