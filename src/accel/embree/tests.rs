//! Errors, cancellation, and owners dropped in every order. Query results are tested from outside.

use std::sync::Arc;

use crate::accel::BuildOptions;
use crate::error::Category;
use crate::geometry::{SphereRows, SphereSet};
use crate::math::{DVec3, Hit, NO_SPHERE, Ray};

use super::device::Device;
use super::group::SphereGroup;
use super::scene::{self, EmbreeScene, EmbreeSceneBuilder, Geometry};
use super::{ParticleGeometry, check_support, describe, sys};

/// A grid of spheres of radius 0.25 above a giant.
fn grid(side: i32) -> Arc<SphereSet> {
    let cell = |i: i32| [(i % side) as f32, (i / side % side) as f32, (i / side / side) as f32];
    let table = (0..side.pow(3)).map(|i| [cell(i)[0], cell(i)[1], cell(i)[2], 0.25]).collect();
    let ground = crate::geometry::Sphere { center: DVec3::new(0.0, -1e6, 0.0), radius: 1e6 - 0.5 };
    let set = SphereSet::new(SphereRows { exact: vec![ground], table }).expect("few spheres");
    assert_eq!(set.giants().len(), 1);
    Arc::new(set)
}

/// The ground, and the grid as sphere points.
fn groups(set: &Arc<SphereSet>) -> [Arc<SphereGroup>; 2] {
    SphereGroup::divide(set, ParticleGeometry::Points).try_into().ok().expect("two groups")
}

fn commit(device: &Arc<Device>, groups: &[Arc<SphereGroup>]) -> Vec<EmbreeScene> {
    let scene = |group| {
        let geometry = Geometry::new(device, group).expect("takes");
        let builder = EmbreeSceneBuilder::new(device).expect("begins");
        let builder = builder.attach(&geometry).expect("attaches");
        builder.commit(&BuildOptions::default()).expect("builds")
    };
    groups.iter().map(scene).collect()
}

/// A ray down through the middle of the grid hits a sphere, and a ray beside the grid hits the
/// ground.
fn trace(scenes: &[EmbreeScene]) {
    let down =
        |x: f64| Ray::new(DVec3::new(x, 100.0, 0.0), -DVec3::Y, 0.0, f64::INFINITY, [NO_SPHERE; 2]);
    let mut hits = [Hit::MISS; 2];
    scene::closest(scenes, &[down(0.0), down(500.0)], &mut hits);
    assert!(!hits[0].is_miss() && !hits[1].is_miss() && hits[0].t < hits[1].t, "{hits:?}");
    let mut occluded = [false; 2];
    scene::occluded(scenes, &[down(0.0), down(500.0)], &mut occluded);
    assert_eq!(occluded, [true; 2]);
}

#[test]
fn owners_may_go_in_any_order() {
    let orders = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
    for order in orders {
        let set = grid(3);
        let device = Device::new(1).expect("starts");
        let spheres = groups(&set);
        let geometry = Geometry::new(&device, &spheres[1]).expect("takes");
        let unused =
            EmbreeSceneBuilder::new(&device).and_then(|b| b.attach(&geometry)).expect("attaches");
        let scene = commit(&device, &spheres);
        drop((set, spheres));
        let (mut device, mut geometry, mut unused) = (Some(device), Some(geometry), Some(unused));
        for turn in order {
            match turn {
                0 => drop(device.take()),
                1 => drop(geometry.take()),
                _ => drop(unused.take()),
            }
            trace(&scene);
        }
    }
}

#[test]
fn threads_build_trace_and_drop_at_once() {
    let set = grid(4);
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| {
                for _ in 0..25 {
                    let device = Device::new(1).expect("starts");
                    let scene = commit(&device, &groups(&set));
                    drop(device);
                    std::thread::scope(|inner| {
                        inner.spawn(|| trace(&scene));
                        inner.spawn(|| trace(&scene));
                    });
                    // On another thread than the one that built the scene.
                    std::thread::spawn(move || drop(scene)).join().expect("drops");
                }
            });
        }
    });
}

#[test]
fn a_rejected_buffer_is_reported_in_embrees_words() {
    let set = grid(3);
    let device = Device::new(1).expect("starts");
    let spheres = groups(&set);
    // An address that is not a multiple of 4; Embree rejects it before reading.
    let group = sys::PsGroup { points: std::ptr::without_provenance(2), ..spheres[1].raw };
    // SAFETY: the device is alive; Embree rejects the address and keeps nothing of the group.
    let raw = unsafe { sys::ps_points_new(device.raw(), &group) };
    let rejected = Geometry::uncommitted(raw, &device, &spheres[1], "share the spheres");
    let error = rejected.err().expect("rejected");
    assert_eq!(error.category(), Category::Backend);
    let text = error.to_string();
    assert!(text.starts_with("Embree cannot share the spheres: "), "{text}");
    assert!(text.contains("data must be 4 bytes aligned"), "{text}");
    trace(&commit(&device, &spheres));
}

#[test]
fn a_build_that_fails_in_the_middle_says_why_and_leaves_nothing_behind() {
    let set = grid(3);
    let device = Device::new(1).expect("starts");
    let spheres = groups(&set);
    let good = Geometry::new(&device, &spheres[0]).expect("takes");
    // SAFETY: device and group are alive.
    let raw = unsafe { sys::ps_points_new(device.raw(), &spheres[1].raw) };
    let raw = Geometry::uncommitted(raw, &device, &spheres[1], "take").expect("takes");
    let builder = EmbreeSceneBuilder::new(&device).and_then(|b| b.attach(&good)).expect("attaches");
    let builder = builder.attach(&raw).expect("attaches");
    let error =
        builder.commit(&BuildOptions::default()).err().expect("the points are not committed");
    let text = error.to_string();
    assert!(text.starts_with("Embree cannot build its tree: "), "{text}");
    assert!(text.contains("not committed"), "{text}");
    drop((raw, good));
    trace(&commit(&device, &spheres));
}

#[test]
fn a_commit_stops_when_asked_and_a_later_one_works() {
    let set = grid(60);
    let device = Device::new(1).expect("starts");
    let spheres = groups(&set);
    let points = Geometry::new(&device, &spheres[1]).expect("takes");
    let builder =
        EmbreeSceneBuilder::new(&device).and_then(|b| b.attach(&points)).expect("attaches");
    let options = BuildOptions::default();
    options.cancel.cancel();
    let error = builder.commit(&options).err().expect("stopped");
    assert_eq!(error.category(), Category::Cancelled);
    trace(&commit(&device, &spheres));
}

#[test]
fn no_device_is_an_error_and_not_a_crash() {
    let error = Device::adopt(std::ptr::null_mut()).err().expect("no device");
    assert_eq!(error.category(), Category::Backend);
    assert!(error.to_string().starts_with("Embree cannot start: "), "{error}");
    assert!(error.help().is_some());
}

#[test]
fn an_embree_that_would_give_wrong_hits_is_rejected() {
    let device = Device::new(1).expect("starts");
    let real = describe(&device).expect("describes itself");
    check_support(&real, ParticleGeometry::Points).expect("this one is complete");
    let culling = super::EmbreeInfo { culls_sphere_back_faces: Some(true), ..real.clone() };
    assert!(check_support(&culling, ParticleGeometry::Points).is_err());
    assert!(check_support(&culling, ParticleGeometry::User).is_ok());
    let incomplete = super::EmbreeInfo { missing: vec!["filter functions"], ..real };
    let text =
        check_support(&incomplete, ParticleGeometry::User).expect_err("incomplete").to_string();
    assert!(text.contains("filter functions"), "{text}");
}

/// Embree's kernels round differently for each instruction set. The hits must not.
#[cfg(target_arch = "x86_64")]
#[test]
fn hits_do_not_depend_on_the_instruction_set() {
    // Enlarged radii can only be undone if they are similar.
    for (decades, is_reversible) in [(3.0, false), (0.3, true)] {
        let set = spheres_with_radii_over(decades);
        let groups = SphereGroup::divide(&set, ParticleGeometry::Points);
        assert!(groups.iter().any(|group| group.raw.radius_steps > 0) == is_reversible);
        compare_instruction_sets(&set);
    }
}

/// Spheres in a box of 10, above a giant.
fn spheres_with_radii_over(decades: f32) -> Arc<SphereSet> {
    let mut table = Vec::new();
    for i in 0..3000u32 {
        let coordinate = |stride: u32| (i * stride % 2999) as f32 / 300.0;
        let radius = 0.001 * 10f32.powf((i * 13 % 97) as f32 / 97.0 * decades);
        table.push([coordinate(7), coordinate(131), coordinate(1777), radius]);
    }
    let ground = crate::geometry::Sphere { center: DVec3::new(0.0, -1e6, 0.0), radius: 1e6 };
    Arc::new(SphereSet::new(SphereRows { exact: vec![ground], table }).expect("few spheres"))
}

fn compare_instruction_sets(set: &Arc<SphereSet>) {
    let number = |i: u32| f64::from(i.wrapping_mul(2_654_435_761)) / 2f64.powi(32);
    let point = |i: u32| DVec3::new(number(3 * i), number(3 * i + 1), number(3 * i + 2));
    // Past the silhouettes of spheres, by down to 1e-9 of their radius.
    let ray = |i: u32| {
        let sphere = set.sphere(i % set.len() as u32);
        let normal = (point(2 * i) - 0.5).normalize();
        let off = 10f64.powf(-9.0 * number(i)).copysign(number(7 * i) - 0.5);
        let at = sphere.center + normal * (sphere.radius * (1.0 + off));
        let along = normal.any_orthonormal_vector();
        let from = at - along * (20.0 * number(5 * i));
        Ray::new(from, along, 0.0, f64::INFINITY, [NO_SPHERE; 2])
    };
    let rays: Vec<Ray> = (0..6000).map(ray).collect();
    let mut expected = vec![Hit::MISS; rays.len()];
    let options = BuildOptions::default();
    let oracle = crate::accel::Backend::BruteForce.build(set, &options).expect("builds");
    oracle.closest(&rays, &mut expected);
    // Those that this processor has; Embree starts with no other.
    let sets = [
        ("sse2", true),
        ("sse4.2", is_x86_feature_detected!("sse4.2")),
        ("avx", is_x86_feature_detected!("avx")),
        ("avx2", is_x86_feature_detected!("avx2")),
        ("avx512", is_x86_feature_detected!("avx512dq") && is_x86_feature_detected!("avx512vl")),
    ];
    for (isa, _) in sets.into_iter().filter(|(_, is_there)| *is_there) {
        let device = Device::with_config(&format!("threads=1,isa={isa}")).expect("starts");
        for geometry in [ParticleGeometry::Points, ParticleGeometry::User] {
            let scenes = commit(&device, &SphereGroup::divide(set, geometry));
            let mut hits = vec![Hit::MISS; rays.len()];
            scene::closest(&scenes, &rays, &mut hits);
            assert!(hits == expected, "{isa}, {geometry:?}");
        }
    }
}

#[test]
fn bytes_are_counted_and_given_back() {
    let set = grid(20);
    let device = Device::new(1).expect("starts");
    let before = device.bytes();
    let scene = commit(&device, &groups(&set));
    let held = device.bytes() - before;
    assert!((16 * set.len()..1000 * set.len()).contains(&held), "{held} bytes");
    drop(scene);
    assert!(device.bytes() < held);
}
