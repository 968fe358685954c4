//! Whole renders with every intersector, and how much of them the intersector takes.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use crate::accel::{Accel, Backend, Precision};
use crate::error::{Error, Result};
use crate::film::Kind;
use crate::geometry::{PathRays, SphereSet};
use crate::image_io::Picture;
use crate::job::render;
use crate::math::{Hit, Ray};
use crate::scene::Shot;
use crate::task::Cancel;

use super::{Field, Figure, MOST_FOR_BRUTE_FORCE};

/// What renders with one intersector took.
#[derive(Clone, Debug, PartialEq)]
pub struct WholeBench {
    /// Which one.
    pub backend: Backend,
    /// Seconds of a render, without loading and building.
    pub seconds: Figure,
    /// The share of its threads' time that was spent in the intersector; all else is camera, shading,
    /// sampling and film.
    pub inside: Figure,
    /// Rays of one render, shadow rays included.
    pub rays: u64,
    /// Samples of one render.
    pub samples: u64,
    /// Pixels that have other bits than with the first intersector.
    pub other_pixels: usize,
}

/// Renders the scene with every intersector of the field, which are over its spheres, in turns on the
/// current pool; with brute force only where that comes to an end.
///
/// # Errors
/// When a render fails, or on cancellation.
pub fn renders(
    shot: &Shot,
    field: &Field,
    rounds: usize,
    cancel: &Cancel,
) -> Result<Vec<WholeBench>> {
    let few = field.spheres().len() as u64 <= MOST_FOR_BRUTE_FORCE;
    let can = |(backend, _): &(Backend, &dyn Accel)| few || *backend != Backend::BruteForce;
    let mut stands: Vec<Stand<'_>> = field.contenders().filter(can).map(Stand::new).collect();
    for _ in 0..rounds.max(1) {
        for stand in &mut stands {
            stand.repeat(shot, cancel)?;
        }
    }
    let first = stands.first().and_then(|stand| stand.picture.clone()).unwrap_or_default();
    Ok(stands.iter().filter_map(|stand| stand.result(&first)).collect())
}

struct Stand<'a> {
    backend: Backend,
    accel: &'a dyn Accel,
    seconds: Vec<f64>,
    inside: Vec<f64>,
    picture: Option<Picture>,
    rays: u64,
    samples: u64,
}

impl<'a> Stand<'a> {
    fn new((backend, accel): (Backend, &'a dyn Accel)) -> Self {
        let (seconds, inside) = (Vec::new(), Vec::new());
        Self { backend, accel, seconds, inside, picture: None, rays: 0, samples: 0 }
    }

    fn repeat(&mut self, shot: &Shot, cancel: &Cancel) -> Result<()> {
        let in_f64 = self.backend == Backend::BruteForce;
        let clocked = Clocked { accel: self.accel, in_f64, nanoseconds: AtomicU64::new(0) };
        let start = Instant::now();
        let outcome = render(shot, &clocked, &Kind::USUAL, cancel)?;
        let seconds = start.elapsed().as_secs_f64().max(1e-9);
        if !outcome.complete {
            return Err(Error::cancelled());
        }
        let inside = 1e-9 * clocked.nanoseconds.into_inner() as f64;
        self.inside.push(inside / (seconds * rayon::current_num_threads() as f64));
        self.seconds.push(seconds);
        (self.rays, self.samples) = (outcome.rays, outcome.samples);
        self.picture.get_or_insert(outcome.picture);
        Ok(())
    }

    fn result(&self, first: &Picture) -> Option<WholeBench> {
        let own = self.picture.as_ref()?;
        let is_other = |&pixel: &usize| {
            let bits = |picture: &Picture| picture.beauty(pixel).to_array().map(f32::to_bits);
            bits(own) != bits(first)
        };
        Some(WholeBench {
            backend: self.backend,
            seconds: Figure::of(self.seconds.clone())?,
            inside: Figure::of(self.inside.clone())?,
            rays: self.rays,
            samples: self.samples,
            other_pixels: (0..own.len()).filter(is_other).count(),
        })
    }
}

/// An intersector with a clock that runs while it works.
struct Clocked<'a> {
    accel: &'a dyn Accel,
    /// Whether it takes the rays of paths as they are. For others they are rounded to f32 first, which
    /// is not the intersector's work.
    in_f64: bool,
    nanoseconds: AtomicU64,
}

impl Clocked<'_> {
    fn clock(&self, work: impl FnOnce()) {
        let start = Instant::now();
        work();
        self.nanoseconds.fetch_add(start.elapsed().as_nanos() as u64, Ordering::Relaxed);
    }
}

impl Accel for Clocked<'_> {
    fn closest(&self, rays: &[Ray], hits: &mut [Hit]) {
        self.clock(|| self.accel.closest(rays, hits));
    }

    fn occluded(&self, rays: &[Ray], blocked: &mut [bool]) {
        self.clock(|| self.accel.occluded(rays, blocked));
    }

    fn closest_of(
        &self,
        spheres: &SphereSet,
        rays: &PathRays,
        asked: &mut Vec<Ray>,
        hits: &mut [Hit],
    ) {
        if self.in_f64 {
            return self.clock(|| self.accel.closest_of(spheres, rays, asked, hits));
        }
        ask(spheres, rays, asked);
        self.closest(asked, hits);
    }

    fn occluded_of(
        &self,
        spheres: &SphereSet,
        rays: &PathRays,
        asked: &mut Vec<Ray>,
        blocked: &mut [bool],
    ) {
        if self.in_f64 {
            return self.clock(|| self.accel.occluded_of(spheres, rays, asked, blocked));
        }
        ask(spheres, rays, asked);
        self.occluded(asked, blocked);
    }

    fn precision(&self) -> Precision {
        self.accel.precision()
    }

    fn bytes(&self) -> usize {
        self.accel.bytes()
    }

    fn details(&self) -> String {
        self.accel.details()
    }
}

fn ask(spheres: &SphereSet, rays: &PathRays, asked: &mut Vec<Ray>) {
    asked.clear();
    asked.extend(rays.iter().map(|ray| spheres.ask(&ray)));
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
materials.matt = { type = "diffuse", albedo = [0.5, 0.5, 0.5] }
spheres = [
  { center = [-0.8, 0, 0], radius = 0.9, material = "matt" },
  { center = [0.8, 0, 0], radius = 0.6, material = "matt" },
]
"#;

    #[test]
    fn renders_take_their_time_and_part_of_it_in_the_intersector() {
        let file = read_text("scene", SCENE, Path::new("."), &[]).unwrap();
        let (scene, settings) = file.build().unwrap();
        let shot = Shot::new(&scene, settings).unwrap();
        let backends = [Backend::Native, Backend::BruteForce];
        let options = BuildOptions::default();
        let field = Field::build(scene.spheres(), &backends, &options, 1).unwrap();
        let results = renders(&shot, &field, 2, &options.cancel).unwrap();
        assert_eq!(results.iter().map(|result| result.backend).collect::<Vec<_>>(), backends);
        for result in &results {
            assert_eq!(result.samples, 12 * 8 * 4);
            assert!(result.rays >= result.samples, "{result:?}");
            assert!(result.seconds.median > 0.0);
            assert!(result.inside.median > 0.0 && result.inside.median < 1.0, "{result:?}");
            assert_eq!(result.other_pixels, 0);
        }
        options.cancel.cancel();
        assert!(renders(&shot, &field, 1, &options.cancel).is_err());
    }
}
