//! The memory of a render is planned from its values, before any of it is allocated.

use photosphere::film::{Aov, Layer};
use photosphere::job::{Job, MemoryPlan};
use photosphere::scene::{Scene, SceneDescription, SphereArrays};

use super::{balls, color_of, narrow, rows, view};

/// One emitter on its own and 60 coloured spheres in an array.
fn description() -> SceneDescription {
    let mut scene = view();
    let (grey, lamp) = (scene.diffuse([0.5; 3]), scene.emitter([4.0; 3]));
    scene.sphere(lamp, [0.0, 9.0, 0.0], 1.0);
    let colors = (0..60).map(color_of).collect();
    scene.spheres(grey, SphereArrays::from_rows(narrow(&rows(&balls(false)))).with_colors(colors));
    scene.description
}

#[test]
fn a_description_has_the_size_of_the_scene_that_is_built_of_it() {
    let size = description().size().expect("good values");
    assert_eq!((size.spheres, size.listed_spheres, size.emitters), (61, 1, 1));
    assert_eq!((size.colors, size.color_bytes), (60, 60 * 12));
    assert_eq!(size.with_packed_colors().color_bytes, 60 * 4);
    let built = Scene::build(description()).expect("good values");
    assert_eq!(built.size(), size);
    let mut wrong = description();
    wrong.spheres[0].radius = -1.0;
    assert!(wrong.size().expect_err("a negative radius").to_string().contains("radius"));
}

#[test]
fn a_plan_grows_with_the_size_the_layers_and_the_threads_of_the_job() {
    let size = description().size().expect("good values");
    let plan = |job: &Job| MemoryPlan::new(&size, job);
    let job = Job { threads: 2, ..Job::with_size(64, 48) };
    let least = plan(&job);
    assert_eq!((least.colors, least.rows), (60 * 12, 61 * 4));
    assert!(least.emitters > 0 && least.background == 0);
    let large = plan(&Job { threads: 2, ..Job::with_size(128, 96) });
    assert_eq!(large.film, 4 * least.film);
    assert!(plan(&job.clone().aovs(&[Aov::Mean(Layer::Albedo)])).film > least.film);
    let threads = plan(&Job { threads: 5, ..job });
    assert_eq!(threads.peak() - least.peak(), 3 << 20);
}
