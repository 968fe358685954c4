//! Both Embree intersectors against brute force in f64: what is hit, from where, and what is not.
//! `differential.rs` goes to the limits of precision; here every answer is unambiguous.

use std::sync::Arc;

use photosphere::accel::{Accel, Backend, BuildOptions, embree_info};
use photosphere::error::Category;
use photosphere::geometry::{Sphere, SphereRows, SphereSet};
use photosphere::math::{DVec3, Hit, MAX_COORDINATE, NO_SPHERE, Ray};
use photosphere::task::CancelToken;
use rand::{RngExt, SeedableRng, rngs::StdRng};
use rayon::prelude::*;

use crate::backends::{built, set_of};

const BOTH: [Backend; 2] = [Backend::Embree, Backend::EmbreeUser];

/// 400 overlapping balls in a box, a huge ground under them and a huge shell around all.
fn set() -> Arc<SphereSet> {
    let mut random = StdRng::seed_from_u64(1);
    let mut coordinate = || random.random_range(-10.0..10.0f32);
    let mut table: Vec<[f32; 4]> =
        (0..400).map(|_| [coordinate(), coordinate(), coordinate(), 0.0]).collect();
    table.iter_mut().for_each(|ball| ball[3] = random.random_range(0.05..1.5f32));
    let ground = Sphere { center: DVec3::new(0.0, -1e6, 0.0), radius: 1e6 - 8.0 };
    let shell = Sphere { center: DVec3::new(3e5, 0.0, 0.0), radius: 3e5 + 11.0 };
    let set = SphereSet::new(SphereRows { exact: vec![ground, shell], table }).expect("few");
    assert_eq!(set.giants().len(), 2);
    Arc::new(set)
}

fn free(origin: DVec3, direction: DVec3) -> Ray {
    Ray::new(origin, direction, 0.0, f64::INFINITY, [NO_SPHERE; 2])
}

/// Rays from anywhere to anywhere; half with bounds, half with excluded spheres.
fn rays(count: usize, spheres: u32) -> Vec<Ray> {
    let mut random = StdRng::seed_from_u64(2);
    let mut point =
        |scale: f64| DVec3::from_array([0; 3].map(|_| random.random_range(-scale..scale)));
    let ends: Vec<_> = (0..count).map(|_| (point(12.0), point(1.0).normalize())).collect();
    let exclude = [random.random_range(0..spheres), random.random_range(0..spheres)];
    ends.into_iter()
        .enumerate()
        .map(|(i, (origin, direction))| {
            let t_min = if i % 2 == 0 { 0.0 } else { random.random_range(0.0..3.0) };
            let t_max = if i % 4 < 2 { f64::INFINITY } else { random.random_range(0.0..9.0) };
            let exclude = if i % 8 < 4 { [NO_SPHERE; 2] } else { exclude };
            Ray::new(origin, direction, t_min, t_max, exclude)
        })
        .collect()
}

fn closest(accel: &dyn Accel, rays: &[Ray]) -> Vec<Hit> {
    let mut hits = vec![Hit { t: -1.0, id: 77 }; rays.len()];
    accel.closest(rays, &mut hits);
    hits
}

fn occluded(accel: &dyn Accel, rays: &[Ray]) -> Vec<bool> {
    let mut occluded = vec![true; rays.len()];
    accel.occluded(rays, &mut occluded);
    occluded
}

/// Same ids. Distances: bit for bit from f64 callbacks; from sphere points within what f32 loses
/// near a silhouette, sqrt(2 R 16 2^-24 |o - c|) < 0.01 in this scene.
fn assert_alike(backend: Backend, found: &[Hit], truth: &[Hit]) {
    for (i, (found, truth)) in found.iter().zip(truth).enumerate() {
        let tolerance = if backend == Backend::EmbreeUser { 0.0 } else { 0.01 };
        let near = found.t == truth.t || (found.t - truth.t).abs() <= tolerance;
        assert!(found.id == truth.id && near, "{backend:?}, ray {i}: {found:?}, not {truth:?}");
    }
}

#[test]
fn both_agree_with_brute_force() {
    let set = set();
    let rays = rays(20_000, set.len() as u32);
    let oracle = built(Backend::BruteForce, &set);
    let truth = closest(&*oracle, &rays);
    let giants = truth.iter().filter(|hit| !hit.is_miss() && hit.id >= 400).count();
    let misses = truth.iter().filter(|hit| hit.is_miss()).count();
    assert!(giants > 1000 && misses > 1000 && giants + misses < 15_000, "{giants} {misses}");
    for backend in BOTH {
        let accel = built(backend, &set);
        assert_alike(backend, &closest(&*accel, &rays), &truth);
        assert_eq!(occluded(&*accel, &rays), occluded(&*oracle, &rays), "{backend:?}");
    }
}

#[test]
fn each_excluded_sphere_gives_way_to_the_next() {
    let set = set();
    let oracle = built(Backend::BruteForce, &set);
    for backend in BOTH {
        let accel = built(backend, &set);
        for ray in rays(500, 1).into_iter().map(|ray| Ray { t_min: 0.0, t_max: 1e9, ..ray }) {
            let mut ray = Ray { exclude: [NO_SPHERE; 2], ..ray };
            for slot in [0, 1] {
                ray.exclude[slot] = closest(&*accel, &[ray])[0].id;
            }
            let swapped = Ray { exclude: [ray.exclude[1], ray.exclude[0]], ..ray };
            let third = closest(&*accel, &[ray, swapped]);
            assert_eq!(third[0], third[1]);
            assert_alike(backend, &third[..1], &closest(&*oracle, &[ray]));
            assert!(!ray.excludes(third[0].id) || third[0].is_miss());
        }
    }
}

#[test]
fn the_interval_is_open_and_the_far_root_counts() {
    // One particle, one giant; the particle is the origin, because the median is a centre.
    let ball = Sphere { center: DVec3::ZERO, radius: 2.0 };
    let set = set_of(vec![ball]);
    for backend in BOTH {
        let accel = built(backend, &set);
        // Sphere points take a reciprocal that is not exact; the callbacks are exact.
        let step = if backend == Backend::Embree { 1e-5 } else { 0.0 };
        let first = |t_min: f32, t_max: f32| {
            let ray = Ray { t_min, t_max, ..free(DVec3::new(-10.0, 0.0, 0.0), DVec3::X) };
            let hit = closest(&*accel, &[ray])[0];
            assert_eq!(occluded(&*accel, &[ray])[0], !hit.is_miss());
            (!hit.is_miss()).then_some(hit.t.round())
        };
        assert_eq!(first(0.0, f32::INFINITY), Some(8.0));
        assert_eq!(first(0.0, 8.0 - step), None, "t_max is not in the interval");
        assert_eq!(first(0.0, 8.0 + 1e-5), Some(8.0));
        assert_eq!(first(8.0 + step, f32::INFINITY), Some(12.0), "t_min is not in the interval");
        assert_eq!(first(8.0 - 1e-5, f32::INFINITY), Some(8.0));
        assert_eq!(first(12.0 + step, f32::INFINITY), None);
        assert_eq!(first(9.0, 11.0), None, "both walls lie outside");
        assert_eq!(first(5.0, 4.0), None, "an empty interval");
    }
}

#[test]
fn equal_distances_go_to_the_lower_id() {
    let touching = |x: f64, radius: f64| Sphere { center: DVec3::new(x, 0.0, 0.0), radius };
    let set = set_of(vec![touching(1.0, 1.0), touching(2.0, 2.0), touching(4.0, 4.0)]);
    let ray = free(DVec3::new(-10.0, 0.0, 0.0) - set.origin(), DVec3::X);
    for backend in [Backend::EmbreeUser, Backend::BruteForce] {
        assert_eq!(closest(&*built(backend, &set), &[ray])[0], Hit { t: 10.0, id: 0 });
    }
}

#[test]
fn invalid_rays_hit_nothing_and_harm_nobody() {
    let set = set();
    let good = free(DVec3::ZERO, DVec3::Z);
    let mut batch = vec![good];
    for x in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e19, -1e19, 5e15] {
        batch.push(Ray { origin: [0.0, x, 0.0], ..good });
        batch.push(Ray { direction: [0.0, 0.0, x], ..good });
    }
    batch.extend([-1.0, f32::NAN, f32::INFINITY].map(|t_min| Ray { t_min, ..good }));
    batch.extend([-1.0, f32::NAN].map(|t_max| Ray { t_max, ..good }));
    let invalid = batch.len();
    batch.push(Ray { direction: [0.0; 3], direction_low: [0.0; 3], ..good });
    batch.push(good);
    for backend in BOTH {
        let accel = built(backend, &set);
        let hits = closest(&*accel, &batch);
        let occluded = occluded(&*accel, &batch);
        assert!(hits[1..invalid].iter().all(|&hit| hit == Hit::MISS), "{hits:?}");
        assert!(!occluded[1..invalid].contains(&true));
        assert_eq!(hits[invalid], Hit::MISS, "no direction");
        assert!(!hits[0].is_miss() && hits[0] == hits[invalid + 1]);
        assert!(occluded[0] && occluded[invalid + 1]);
    }
}

#[test]
fn rays_at_the_limit_of_validity_are_asked() {
    let ball = Sphere { center: DVec3::ZERO, radius: 1e15 };
    let set = set_of(vec![ball]);
    let limit = 4.0 * MAX_COORDINATE as f32;
    let good = free(DVec3::ZERO, DVec3::Z);
    let at_limit = [
        Ray { origin: [limit, 0.0, 0.0], direction: [-1.0, 0.0, 0.0], ..good },
        Ray { direction: [0.0, 0.0, limit], ..good },
        Ray { origin: [0.0, 0.0, -limit], t_min: 0.9 * limit, ..good },
        Ray { t_max: f32::MAX, ..good },
        Ray { t_min: -0.0, ..good },
    ];
    for backend in BOTH {
        let accel = built(backend, &set);
        for ray in at_limit {
            assert!(ray.is_valid());
            assert_eq!(closest(&*accel, &[ray])[0].id, 0, "{backend:?} {ray:?}");
            assert_eq!(occluded(&*accel, &[ray]), [true], "{backend:?} {ray:?}");
        }
    }
}

#[test]
fn nothing_may_be_empty() {
    let nothing = set_of(Vec::new());
    for backend in BOTH {
        assert!(closest(&*built(backend, &set()), &[]).is_empty());
        assert!(occluded(&*built(backend, &set()), &[]).is_empty());
        let accel = built(backend, &nothing);
        let ray = free(DVec3::ZERO, DVec3::X);
        assert_eq!(closest(&*accel, &[ray]), [Hit::MISS]);
        assert_eq!(occluded(&*accel, &[ray]), [false]);
    }
}

#[test]
fn a_cancelled_build_says_so_and_a_later_one_works() {
    let set = set();
    for backend in BOTH {
        let cancel = CancelToken::default();
        cancel.cancel();
        let options = BuildOptions { threads: 1, cancel, ..Default::default() };
        let error = backend.build(&set, &options).err().expect("cancelled");
        assert_eq!(error.category(), Category::Cancelled);
        let hit = closest(&*built(backend, &set), &[free(DVec3::ZERO, DVec3::X)])[0];
        assert!(!hit.is_miss());
    }
}

#[test]
fn batches_from_many_threads_get_the_same_answers() {
    let set = set();
    let rays = rays(20_000, set.len() as u32);
    for backend in BOTH {
        let accel = built(backend, &set);
        let together: Vec<Hit> =
            rays.par_chunks(37).flat_map_iter(|batch| closest(&*accel, batch)).collect();
        assert_eq!(together, closest(&*accel, &rays));
        let together: Vec<bool> =
            rays.par_chunks(37).flat_map_iter(|batch| occluded(&*accel, batch)).collect();
        assert_eq!(together, occluded(&*accel, &rays));
    }
}

#[test]
fn embree_describes_itself() {
    let info = embree_info().expect("built in").expect("starts");
    let major = |version: &str| version.split('.').next().map(str::to_owned);
    assert_eq!(major(&info.compiled_version), major(&info.runtime_version));
    assert!(["3", "4"].contains(&major(&info.runtime_version).as_deref().unwrap_or("")));
    assert!(info.missing.is_empty(), "{info:?}");
    assert_ne!(info.culls_sphere_back_faces, Some(true));
    assert_ne!((info.instruction_set, info.tasking), ("unknown", "unknown"));
}
