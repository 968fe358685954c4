//! The native tree against brute force: the same ids and the same occlusion, ray by ray.
//!
//! Both decide in f64 with the same routine, so on these scenes there is no band of tolerance: the
//! answers must be equal.

use std::sync::Arc;

use photosphere::accel::{Accel, Backend, BuildOptions, KernelIsa};
use photosphere::geometry::{Sphere, SphereSet};
use photosphere::math::{DVec3, Hit, NO_SPHERE, Ray};
use photosphere::verify::rays;
use proptest::prelude::*;
use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};

use crate::backends::set_of;
use crate::scenes;

const NOTHING: [u32; 2] = [NO_SPHERE; 2];

/// The two backends over the same spheres, the native one in every form of its kernel.
struct Pair {
    set: Arc<SphereSet>,
    native: Vec<(&'static str, Box<dyn Accel>)>,
    brute_force: Box<dyn Accel>,
}

/// One ray, fewer than are under way at once, many, and very many.
const BATCHES: [usize; 4] = [1, 7, 64, 1000];

impl Pair {
    fn over(exact: Vec<Sphere>) -> Self {
        let set = set_of(exact);
        let native = KernelIsa::ALL
            .iter()
            .filter(|instance| instance.is_available())
            .map(|&instance| (instance.name(), native(&set, instance)))
            .collect();
        let options = BuildOptions::default();
        let brute_force = Backend::BruteForce.build(&set, &options).expect("nobody cancels");
        Self { set, native, brute_force }
    }

    /// Asserts equal answers; returns how many rays hit.
    fn compare(&self, rays: &[Ray]) -> usize {
        let mut expected = vec![Hit { t: 0.0, id: 0 }; rays.len()];
        self.brute_force.closest(rays, &mut expected);
        for (name, accel) in &self.native {
            for batch in BATCHES {
                let mut hits = vec![Hit { t: 0.0, id: 0 }; rays.len()];
                let mut occluded = vec![true; rays.len()];
                for (rays, hits) in rays.chunks(batch).zip(hits.chunks_mut(batch)) {
                    accel.closest(rays, hits);
                }
                for (rays, occluded) in rays.chunks(batch).zip(occluded.chunks_mut(batch)) {
                    accel.occluded(rays, occluded);
                }
                for (i, ray) in rays.iter().enumerate() {
                    let about = || format!("{name}, batches of {batch}, ray {i}: {ray:?}");
                    assert_eq!(hits[i], expected[i], "{}", about());
                    assert_eq!(occluded[i], !expected[i].is_miss(), "{}", about());
                }
            }
        }
        expected.iter().filter(|hit| !hit.is_miss()).count()
    }

    /// Some sphere of the set.
    fn any(&self, rng: &mut StdRng) -> (u32, Sphere) {
        let id = rng.random_range(0..self.set.len() as u32);
        (id, self.set.sphere(id))
    }
}

fn native(set: &Arc<SphereSet>, instance: KernelIsa) -> Box<dyn Accel> {
    let options = BuildOptions { isa: Some(instance), ..Default::default() };
    Backend::Native.build(set, &options).expect("nobody cancels")
}

fn ray(origin: DVec3, direction: DVec3) -> Ray {
    Ray::new(origin, direction, 0.0, f64::INFINITY, NOTHING)
}

/// The kinds of rays, by turns, aimed at a scene that is not empty.
fn one_by_one(pair: &Pair, count: usize, seed: u64) -> Vec<Ray> {
    let mut rng = StdRng::seed_from_u64(seed);
    (0..count).map(|i| one_ray(pair, i, &mut rng)).collect()
}

fn one_ray(pair: &Pair, kind: usize, rng: &mut StdRng) -> Ray {
    let (id, sphere) = pair.any(rng);
    let (_, other) = pair.any(rng);
    let direction = scenes::direction(rng);
    let outside =
        sphere.center + direction * sphere.radius * 10f64.powf(rng.random_range(0.0..4.0));
    let towards = (other.center - outside).normalize_or(direction);
    let axis = [DVec3::X, DVec3::Y, DVec3::Z][rng.random_range(0..3)];
    let axis = if rng.random() { axis } else { -axis };
    let reach = outside.distance(other.center);
    let [a, b] = [rng.random_range(0.0..2.0), rng.random_range(0.0..2.0)].map(|x| x * reach);
    match kind % 12 {
        0 => ray(scenes::in_box(rng) * 2.0 - 1.0, direction),
        1 => ray(outside, towards),
        2 => ray(outside, -direction),
        3 => ray(sphere.center, direction),
        4 => ray(sphere.center + direction * sphere.radius * 0.999, scenes::direction(rng)),
        // Along an axis through a sphere, from inside it, and past its pole.
        5 => ray(sphere.center - axis * sphere.radius * 3.0, axis),
        6 => ray(sphere.center, axis),
        7 => ray(sphere.center + axis * sphere.radius, axis.any_orthogonal_vector().normalize()),
        // From a face of the sphere's box, moving in that face's plane and across it.
        8 => ray(sphere.center - axis * sphere.radius, -axis),
        9 => ray(sphere.center + DVec3::ONE * sphere.radius, towards),
        10 => Ray::new(outside, towards, 0.0, reach, [id, NO_SPHERE]),
        _ => Ray::new(outside, -direction, a.min(b), a.max(b), NOTHING),
    }
}

fn families() -> Vec<(&'static str, Vec<Sphere>)> {
    vec![
        ("gas", scenes::gas(2000, 1)),
        ("packed", scenes::packed(1000, 2)),
        ("clusters over six decades", scenes::clusters(2000, 3)),
        ("concentric", scenes::concentric(300)),
        ("collinear x", scenes::collinear(500, 0)),
        ("collinear z", scenes::collinear(500, 2)),
        ("coplanar", scenes::coplanar(1000, 1, 4)),
        ("overlapping", scenes::overlapping(500, 5)),
        ("on a huge ball", scenes::on_a_huge_ball(1000, 20.0, 6)),
        ("on a giant", scenes::on_a_huge_ball(1000, 1e6, 7)),
        ("64 giants", scenes::giants(64, 8)),
        ("1000 giants", scenes::giants(1000, 9)),
        ("one", scenes::gas(1, 10)),
        ("two", scenes::gas(2, 11)),
        ("nine", scenes::gas(9, 12)),
    ]
}

#[test]
fn ids_and_occlusion_equal_brute_force_on_every_family() {
    for (seed, (name, spheres)) in families().into_iter().enumerate() {
        let pair = Pair::over(spheres);
        let hits = pair.compare(&one_by_one(&pair, 12_000, seed as u64));
        assert!(hits > 2000, "{name}: only {hits} rays hit");
    }
}

#[test]
fn beams_of_rays_that_go_together_equal_brute_force_on_every_family() {
    for (seed, (name, spheres)) in families().into_iter().enumerate() {
        let pair = Pair::over(spheres);
        let beams = rays::coherent(&pair.set, 12_000, seed as u64);
        let mut beams: Vec<Ray> = beams.iter().map(|ray| pair.set.to_query(ray)).collect();
        // Some without a partner in front, so that beams begin anywhere in a batch.
        beams.splice(16 * 300..16 * 300, one_by_one(&pair, 48, seed as u64));
        let hits = pair.compare(&beams);
        assert!(hits > 2000, "{name}: only {hits} rays hit");
    }
}

#[test]
fn a_hundred_thousand_giants_are_found_through_their_own_tree() {
    let pair = Pair::over(scenes::giants(100_000, 13));
    assert!(pair.set.giants().len() > 90_000);
    let hits = pair.compare(&one_by_one(&pair, 240, 14));
    assert!(hits > 100);
}

#[test]
fn an_empty_scene_is_never_hit() {
    let pair = Pair::over(Vec::new());
    assert_eq!(pair.compare(&[ray(DVec3::ZERO, DVec3::X)]), 0);
    assert_eq!(native(&pair.set, KernelIsa::best()).bytes(), 0);
}

#[test]
fn an_invalid_ray_hits_nothing() {
    let pair = Pair::over(scenes::overlapping(100, 15));
    let good = ray(DVec3::splat(0.5) - pair.set.origin(), DVec3::X);
    assert_eq!(pair.compare(&[good]), 1);
    let bad = [
        Ray { origin: [f32::NAN, 0.0, 0.0], ..good },
        Ray { direction: [f32::INFINITY, 0.0, 0.0], ..good },
        Ray { direction: [0.0; 3], direction_low: [0.0; 3], ..good },
        Ray { t_min: -1.0, ..good },
        Ray { t_max: f32::NAN, ..good },
    ];
    assert_eq!(pair.compare(&bad), 0);
}

#[test]
fn the_interval_is_open_and_excluded_spheres_are_overlooked() {
    let pair = Pair::over(vec![
        scenes::ball(DVec3::ZERO, 1.0),
        scenes::ball(DVec3::X * 4.0, 1.0),
        scenes::ball(DVec3::X * -4.0, 1.0),
    ]);
    let id_at = |x: f64| {
        let at = |&id: &u32| (pair.set.sphere(id).center + pair.set.origin()).x == x;
        (0..3).find(at).expect("one of the three")
    };
    let start = DVec3::X * -10.0 - pair.set.origin();
    let hit = |t_min: f64, t_max: f64, exclude: [u32; 2]| {
        let ray = Ray::new(start, DVec3::X, t_min, t_max, exclude);
        pair.compare(&[ray]);
        let mut hits = [Hit::MISS];
        pair.native[0].1.closest(&[ray], &mut hits);
        hits[0]
    };
    let end = f64::INFINITY;
    assert_eq!(hit(0.0, end, NOTHING), Hit { t: 5.0, id: id_at(-4.0) });
    assert_eq!(hit(0.0, 5.0, NOTHING), Hit::MISS);
    assert_eq!(hit(5.0, end, NOTHING), Hit { t: 7.0, id: id_at(-4.0) });
    assert_eq!(hit(7.0, end, NOTHING), Hit { t: 9.0, id: id_at(0.0) });
    assert_eq!(hit(0.0, end, [id_at(0.0), id_at(-4.0)]), Hit { t: 13.0, id: id_at(4.0) });
    assert_eq!(hit(0.0, 9.0, [id_at(-4.0), NO_SPHERE]), Hit::MISS);
}

#[test]
fn of_two_spheres_at_the_same_distance_the_smaller_id_is_hit() {
    // Spheres of different radii that all touch the plane x = 0 at the origin.
    let touching = |i: i32| scenes::ball(DVec3::X * f64::from(i), f64::from(i));
    let pair = Pair::over((1..=64).map(touching).collect());
    let start = DVec3::X * -8.0 - pair.set.origin();
    let mut hits = [Hit::MISS];
    for exclude in [NOTHING, [0, NO_SPHERE], [0, 1]] {
        let ray = Ray::new(start, DVec3::X, 0.0, f64::INFINITY, exclude);
        pair.native[0].1.closest(&[ray], &mut hits);
        let first = (0..64).find(|id| !exclude.contains(id)).expect("one is left");
        assert_eq!(hits[0], Hit { t: 8.0, id: first });
        pair.compare(&[ray]);
    }
}

#[test]
fn the_direction_need_not_be_a_unit_vector() {
    let pair = Pair::over(scenes::gas(500, 16));
    let mut rays = one_by_one(&pair, 2400, 17);
    for (i, ray) in rays.iter_mut().enumerate() {
        let direction = ray.direction_f64() * [1e-9, 0.25, 3.0, 1e9][i % 4];
        *ray = Ray::new(ray.origin_f64(), direction, 0.0, f64::INFINITY, NOTHING);
    }
    assert!(pair.compare(&rays) > 400);
}

#[test]
fn a_build_can_be_cancelled() {
    let set = set_of(scenes::gas(1000, 18));
    let options = BuildOptions::default();
    options.cancel.cancel();
    let error = Backend::Native.build(&set, &options).err().expect("cancelled");
    assert_eq!(error.category(), photosphere::error::Category::Cancelled);
}

/// Coordinates on a coarse grid and off it, small and large.
fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![
        (-4i32..=4).prop_map(f64::from),
        -4.0..4.0,
        (-4.0..4.0).prop_map(|x: f64| x * 1e6),
        (-4.0..4.0).prop_map(|x: f64| x * 1e-6),
    ]
}

fn point() -> impl Strategy<Value = DVec3> {
    [coordinate(), coordinate(), coordinate()].prop_map(DVec3::from_array)
}

fn sphere() -> impl Strategy<Value = Sphere> {
    let radius = prop_oneof![Just(1.0), 1e-3..4.0, (-6.0..8.0).prop_map(|e| 10f64.powf(e))];
    (point(), radius).prop_map(|(center, radius)| Sphere { center, radius })
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 400,
        failure_persistence: None,
        rng_seed: prop::test_runner::RngSeed::Fixed(19),
        ..ProptestConfig::default()
    })]

    #[test]
    fn random_scenes_and_rays_agree(
        spheres in prop::collection::vec(sphere(), 1..120),
        rays in prop::collection::vec((point(), point()), 32),
    ) {
        let pair = Pair::over(spheres);
        let rays: Vec<Ray> = rays
            .iter()
            .filter(|(from, to)| from != to)
            .map(|&(from, to)| ray(from - pair.set.origin(), (to - from).normalize()))
            .collect();
        pair.compare(&rays);
    }
}
