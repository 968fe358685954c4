//! Checks every intersector against the ground truth, on sphere families that are hard in different
//! ways.

use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};
use std::sync::Arc;

use crate::accel::{Backend, BuildOptions};
use crate::error::Result;
use crate::geometry::{Sphere, SphereRows, SphereSet};
use crate::math::DVec3;
use crate::task::CancelToken;

use super::check::{Check, CheckGroup, CheckMeasurement, Effort, TestStatistic};
use super::crosscheck::{CrosscheckResult, TestedBackend, compare};
use super::rays;

/// Rays per check. Each is tested against every sphere in arithmetic of twice the precision.
const RAYS: [usize; 3] = [2_000, 20_000, 200_000];

/// Generates this many spheres.
type Family = fn(usize, &mut StdRng) -> Vec<Sphere>;

/// Sphere families: name, number of spheres, generator.
const FAMILIES: [(&str, usize, Family); 9] = [
    ("a gas of balls", 500, gas),
    ("clusters inside clusters, over six decades", 300, clusters),
    ("balls that overlap", 200, overlapping),
    ("balls around one centre", 60, concentric),
    ("giants among small balls", 103, giants),
    ("balls with narrow gaps", 300, gaps),
    ("balls with narrow gaps, far from the origin", 300, |count, rng| {
        let away = DVec3::new(1e8, -3e7, 2e8);
        let translated = |ball: Sphere| Sphere { center: ball.center + away, ..ball };
        gaps(count, rng).into_iter().map(translated).collect()
    }),
    ("thin shells", 60, thin_shells),
    ("a planet and pebbles", 200, planet),
];

/// Returns a check for each family and intersector.
pub fn checks(effort: Effort, backends: &[Backend]) -> Vec<Check> {
    let rays = effort.select(RAYS);
    let families = FAMILIES.iter().flat_map(|family| backends.iter().map(move |b| (family, *b)));
    families
        .map(|(&(title, count, family), backend)| {
            let name = format!("{title}, {}", backend.name());
            Check::new(CheckGroup::Crosscheck, name, move |cancel| {
                measure(count, family, backend, rays, cancel)
            })
        })
        .collect()
}

fn measure(
    count: usize,
    family: Family,
    backend: Backend,
    rays: usize,
    cancel: &CancelToken,
) -> Result<CheckMeasurement> {
    let exact = family(count, &mut StdRng::seed_from_u64(count as u64));
    let spheres = Arc::new(SphereSet::new(SphereRows { exact, table: Vec::new() })?);
    let build = BuildOptions { threads: 1, cancel: cancel.clone(), ..Default::default() };
    let accel = backend.build(&spheres, &build)?;
    let tested = TestedBackend { name: backend.name(), accel: accel.as_ref() };
    // Coherent groups first: a backend detects them only where the batches are cut.
    let mut traced = rays::coherent(&spheres, rays / 2, 3);
    let random = rays::random(&spheres, rays, 1);
    traced.extend(rays::secondary(&spheres, accel.as_ref(), &random[..rays / 4], 2));
    traced.extend(random);
    traced.retain(|ray| rays::is_traceable(&spheres, ray));
    let result = compare(&spheres, &[tested], &traced, cancel)?.remove(0);
    Ok(CheckMeasurement::new(TestStatistic::ErrorCount(result.failures()), detail(&result)))
}

fn detail(result: &CrosscheckResult) -> String {
    let first = result.disagreements.first();
    let first = first.map_or(String::new(), |ray| format!("; first: {ray}"));
    format!(
        "{} rays: {} equal, {} within the stated error bound; largest distance error {:.2} of \
         the tolerance{first}",
        result.rays, result.exact, result.ambiguous, result.max_distance_error
    )
}

fn random_point(rng: &mut StdRng) -> DVec3 {
    DVec3::new(rng.random(), rng.random(), rng.random())
}

/// Random balls in the unit box, about eight mean free paths deep.
fn gas(count: usize, rng: &mut StdRng) -> Vec<Sphere> {
    let radius = (8.0 / (std::f64::consts::PI * count as f64)).sqrt();
    let ball =
        |_| Sphere { center: random_point(rng), radius: radius * rng.random_range(0.75..1.25) };
    (0..count).map(ball).collect()
}

fn clusters(count: usize, rng: &mut StdRng) -> Vec<Sphere> {
    let ball = |_| {
        let size = libm::pow(10.0, rng.random_range(-6.0..0.0));
        let center = rays::uniform_direction(rng) * size + (random_point(rng) - 0.5) * (0.5 * size);
        Sphere { center, radius: size * rng.random_range(0.01..0.1) }
    };
    (0..count).map(ball).collect()
}

fn overlapping(count: usize, rng: &mut StdRng) -> Vec<Sphere> {
    let ball = |_| Sphere { center: random_point(rng), radius: rng.random_range(0.2..0.8) };
    (0..count).map(ball).collect()
}

fn concentric(count: usize, _: &mut StdRng) -> Vec<Sphere> {
    let ball = |i| Sphere { center: DVec3::splat(0.5), radius: 0.1 + 0.01 * i as f64 };
    (0..count).map(ball).collect()
}

/// Three spheres so large that rounding to f32 would displace their surfaces too far for the small
/// spheres near them, and those small spheres.
fn giants(count: usize, rng: &mut StdRng) -> Vec<Sphere> {
    let giant = |_| {
        let radius = libm::pow(10.0, rng.random_range(5.0..7.0));
        Sphere { center: random_point(rng) + rays::uniform_direction(rng) * radius, radius }
    };
    let mut spheres: Vec<_> = (0..3).map(giant).collect();
    let small = |_| Sphere { center: random_point(rng), radius: rng.random_range(0.002..0.01) };
    spheres.extend((3..count).map(small));
    spheres
}

/// Pairs of balls with a gap or an overlap of 1e-7 to 1e-2 of a radius: beside each other, and one
/// inside the other. The part of a ball outside the other is a cap as high as the overlap.
fn gaps(count: usize, rng: &mut StdRng) -> Vec<Sphere> {
    let pair = |index: usize| {
        let center = random_point(rng) * 20.0;
        let [radius, gap, size] = [(-2.0, 0.0), (-7.0, -2.0), (-1.0, 0.0)]
            .map(|(low, high)| libm::pow(10.0, rng.random_range(low..high)));
        let gap = if rng.random() { gap * radius } else { -gap * radius };
        let other = size * radius;
        let distance = if index % 2 == 0 { radius + other + gap } else { radius - other - gap };
        let beside = center + rays::uniform_direction(rng) * distance;
        [Sphere { center, radius }, Sphere { center: beside, radius: other }]
    };
    (0..count / 2).flat_map(pair).collect()
}

/// Concentric shells in pairs, with a relative thickness of 1e-9 to 1e-3.
fn thin_shells(count: usize, rng: &mut StdRng) -> Vec<Sphere> {
    let pair = |index: usize| {
        let (center, radius) = (DVec3::splat(0.3), 0.1 + 0.03 * index as f64);
        let thickness = libm::pow(10.0, rng.random_range(-9.0..-3.0));
        [radius, radius * (1.0 + thickness)].map(|radius| Sphere { center, radius })
    };
    (0..count / 2).flat_map(pair).collect()
}

/// A sphere as large as the Earth in metres, and pebbles that lie on it around one place.
fn planet(count: usize, rng: &mut StdRng) -> Vec<Sphere> {
    const RADIUS: f64 = 6_371_008.771_4;
    let ground = Sphere { center: DVec3::new(0.0, -RADIUS, 0.0), radius: RADIUS };
    let pebble = |_| {
        let radius = libm::pow(10.0, rng.random_range(-2.0..2.0));
        let at = (random_point(rng) - 0.5) * DVec3::new(2e3, 0.0, 2e3);
        let up = (at - ground.center).normalize();
        Sphere { center: ground.center + up * (RADIUS + radius), radius }
    };
    let pebbles: Vec<Sphere> = (1..count).map(pebble).collect();
    pebbles.into_iter().chain([ground]).collect()
}
