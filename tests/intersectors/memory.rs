//! The C and Rust sides of the Embree fence under valgrind: no invalid access, no use of
//! uninitialised memory, no leak.

use std::env;
use std::io::{self, ErrorKind, Write};
use std::process::Command;
use std::sync::Arc;

use photosphere::accel::{Backend, BuildOptions};
use photosphere::color::Rgb;
use photosphere::geometry::{Sphere, SphereRows, SphereSet};
use photosphere::job::render_with_accel;
use photosphere::math::{DVec3, Hit, NO_SPHERE, Ray};
use photosphere::scene::description::{
    BackgroundDescription, CameraDescription, EnvironmentDescription, MaterialDescription,
    SceneDescription, SphereDescription, SurfaceModel,
};
use photosphere::scene::{PreparedScene, Scene, Settings};
use photosphere::task::CancelToken;

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
        let (mut hits, mut occluded) = (vec![Hit::MISS; rays.len()], vec![false; rays.len()]);
        accel.closest(&rays, &mut hits);
        accel.occluded(&rays, &mut occluded);
        (hits.iter().map(|hit| hit.id).collect::<Vec<_>>(), occluded)
    };
    let truth = trace(Backend::BruteForce);
    for backend in [Backend::Embree, Backend::EmbreeUser] {
        assert_eq!(trace(backend), truth, "{backend:?}");
        let cancel = CancelToken::default();
        cancel.cancel();
        assert!(
            backend
                .build(&set, &BuildOptions { threads: 1, cancel, ..Default::default() })
                .is_err()
        );
    }
}

/// A diffuse and a glass ball on a giant, under an emitter and an even sky, in 8 x 8 pixels.
fn prepared() -> PreparedScene {
    let named = |name: &str, surface, emission: f32| MaterialDescription {
        name: name.to_owned(),
        surface,
        emission: Rgb::splat(emission),
        ..MaterialDescription::default()
    };
    let glass =
        SurfaceModel::Dielectric { ior: 1.5, roughness: 0.0, priority: 0, absorption: Rgb::ZERO };
    let black = SurfaceModel::Diffuse { albedo: Rgb::ZERO, roughness: 0.0 };
    let sphere = |center: [f64; 3], radius, material| SphereDescription {
        center: center.into(),
        radius,
        material,
        ..SphereDescription::default()
    };
    let (position, look_at) = (DVec3::new(0.0, 1.0, 6.0), DVec3::Y);
    let description = SceneDescription {
        camera: CameraDescription { position, look_at, ..CameraDescription::default() },
        background: BackgroundDescription {
            dome: EnvironmentDescription::Constant { radiance: Rgb::ONE },
            ..BackgroundDescription::default()
        },
        materials: vec![
            named("diffuse", SurfaceModel::default(), 0.0),
            named("glass", glass, 0.0),
            named("lamp", black, 9.0),
        ],
        spheres: vec![
            sphere([0.0, -1e6, 0.0], 1e6, 0),
            sphere([-1.0, 1.0, 0.0], 1.0, 0),
            sphere([1.0, 1.0, 0.0], 1.0, 1),
            sphere([0.0, 4.0, 0.0], 0.5, 2),
        ],
        tables: Vec::new(),
    };
    let mut settings = Settings::default();
    (settings.image.width, settings.image.height) = (8, 8);
    settings.render.samples_per_pixel = 4;
    let scene = Scene::build(description).expect("a good scene");
    PreparedScene::new(&scene, settings).expect("good settings")
}

/// A whole render, on two threads. Runs by itself, and again under valgrind.
#[test]
fn small_render() {
    let prepared = prepared();
    let options = BuildOptions { threads: 2, ..Default::default() };
    let accel = Backend::Embree.build(prepared.scene().spheres(), &options).expect("builds");
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("two threads");
    let render = || render_with_accel(&prepared, accel.as_ref(), &[], &CancelToken::default());
    let outcome = pool.install(render).expect("a small film");
    assert_eq!((outcome.samples, outcome.complete), (8 * 8 * 4, true));
    assert!(outcome.picture.mean().min_element() > 0.0);
}

#[test]
fn valgrind_finds_nothing_wrong() {
    let checked = Command::new("valgrind")
        .args(["--quiet", "--error-exitcode=9", "--leak-check=full"])
        .args(["--errors-for-leak-kinds=definite", "--show-leak-kinds=definite"])
        .arg(env::current_exe().expect("this program"))
        .args(["--exact", "memory::small_workload", "memory::small_render", "--test-threads=1"])
        .output();
    let output = match checked {
        Ok(output) => output,
        Err(error) if error.kind() == ErrorKind::NotFound && env::var_os("CI").is_none() => {
            // Past the test harness, which would swallow it: a check left out must be seen.
            writeln!(io::stderr(), "SKIPPED: no valgrind, so memory was not checked")
                .expect("told");
            return;
        }
        Err(error) => panic!("valgrind does not run: {error}"),
    };
    let said = String::from_utf8_lossy(&output.stdout);
    let complaints = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{}\n{said}\n{complaints}", output.status);
    assert!(said.contains("2 passed"), "{said}");
}
