//! The C and Rust sides of the Embree fence under valgrind: no invalid access, no use of
//! uninitialised memory, no leak.
#![cfg(feature = "embree")]

use std::env;
use std::io::ErrorKind;
use std::process::Command;
use std::sync::Arc;

use photosphere::accel::{Backend, BuildOptions, Cancel};
use photosphere::geometry::{Sphere, SphereRows, SphereSet};
use photosphere::math::{DVec3, Hit, NO_SPHERE, Ray};

/// A hundred balls on a giant, as `table` and `exact` rows.
fn set() -> Arc<SphereSet> {
    let place = |i: u32, stride: u32| (i * stride % 101) as f32 / 10.0;
    let table = (0..100).map(|i| [place(i, 7), place(i, 31), place(i, 83), 0.5]).collect();
    let ground = Sphere { center: DVec3::new(5.0, -1e6, 5.0), radius: 1e6 };
    let set = SphereSet::new(SphereRows { exact: vec![ground], table }).expect("few spheres");
    assert_eq!(set.giants().len(), 1);
    Arc::new(set)
}

/// Builds, traces and drops; also a build that fails. Runs by itself, and again under valgrind.
#[test]
fn small_workload() {
    let set = set();
    let rays: Vec<Ray> = (0..200)
        .map(|i| {
            let direction = DVec3::new(0.1 * f64::from(i % 17) - 0.8, -1.0, 0.05).normalize();
            let origin = DVec3::new(f64::from(i % 5), 8.0, f64::from(i % 7));
            Ray::new(origin, direction, 0.0, f64::INFINITY, [i as u32 % 100, NO_SPHERE])
        })
        .collect();
    let trace = |backend: Backend| {
        let options = BuildOptions { threads: 2, ..Default::default() };
        let accel = backend.build(&set, &options).expect("builds");
        let (mut hits, mut blocked) = (vec![Hit::MISS; rays.len()], vec![false; rays.len()]);
        accel.closest(&rays, &mut hits);
        accel.occluded(&rays, &mut blocked);
        (hits.iter().map(|hit| hit.id).collect::<Vec<_>>(), blocked)
    };
    let truth = trace(Backend::BruteForce);
    for backend in [Backend::Embree, Backend::EmbreeUser] {
        assert_eq!(trace(backend), truth, "{backend:?}");
        let cancel = Cancel::default();
        cancel.cancel();
        assert!(backend.build(&set, &BuildOptions { threads: 1, cancel }).is_err());
    }
}

#[test]
fn valgrind_finds_nothing_wrong() {
    let checked = Command::new("valgrind")
        .args(["--quiet", "--error-exitcode=9", "--leak-check=full"])
        .args(["--errors-for-leak-kinds=definite", "--show-leak-kinds=definite"])
        .arg(env::current_exe().expect("this program"))
        .args(["--exact", "small_workload", "--test-threads=1"])
        .output();
    let output = match checked {
        Ok(output) => output,
        Err(error) if error.kind() == ErrorKind::NotFound && env::var_os("CI").is_none() => {
            eprintln!("SKIPPED: valgrind is not installed, so memory was not checked");
            return;
        }
        Err(error) => panic!("valgrind does not run: {error}"),
    };
    let said = String::from_utf8_lossy(&output.stdout);
    let complaints = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{}\n{said}\n{complaints}", output.status);
    assert!(said.contains("1 passed"), "{said}");
}
