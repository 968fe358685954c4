//! Whole small pictures, on all cores, with the intersector that suits the scene.

use std::fs;
use std::path::Path;

use criterion::{Criterion, Throughput};

use photosphere::accel::{BackendChoice, BuildOptions};
use photosphere::generate::{Arrangement, Recipe, scene_text, write_rows};
use photosphere::job::render_with_accel;
use photosphere::scene::{Override, PreparedScene, read_file};
use photosphere::task::CancelToken;

const KEYS: [(&str, &str); 3] =
    [("image.width", "96"), ("image.height", "72"), ("render.samples_per_pixel", "16")];

pub(crate) fn bench(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("frame");
    group.sample_size(10).throughput(Throughput::Elements(96 * 72 * 16));
    let folder = tempfile::tempdir().expect("a folder");
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    for (name, path) in [
        ("fig2", scenes.join("paper/fig2.toml")),
        ("cornell", scenes.join("cornell-spheres.toml")),
        ("gas, 1e5", generated(folder.path())),
    ] {
        let overrides = KEYS.map(|(key, value)| Override::new(key, value));
        let file = read_file(&path, &overrides).expect("a scene of ours");
        let (scene, settings) = file.build().expect("spheres of ours");
        let prepared = PreparedScene::new(&scene, settings).expect("settings of ours");
        let backend = BackendChoice::Auto.select(scene.spheres()).backend;
        let accel = backend.build(scene.spheres(), &BuildOptions::default()).expect("builds");
        let cancel = CancelToken::default();
        group.bench_function(name, |bencher| {
            bencher.iter(|| render_with_accel(&prepared, &*accel, &[], &cancel).expect("renders"));
        });
    }
    group.finish();
}

/// A hundred thousand spheres and a scene that shows them.
fn generated(folder: &Path) -> std::path::PathBuf {
    let recipe = Recipe::new(Arrangement::Gas, 100_000, 0, false).expect("a recipe");
    let mut table = Vec::new();
    write_rows(&recipe, &mut table, &|_| {}).expect("memory takes it");
    let (table_path, path) = (folder.join("gas.f32"), folder.join("gas.toml"));
    fs::write(&table_path, table).expect("the folder takes files");
    fs::write(&path, scene_text(&recipe, &table_path, false)).expect("the folder takes files");
    path
}
