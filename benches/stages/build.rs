//! From sorted spheres to a tree, on all cores.

use criterion::{BenchmarkId, Criterion, Throughput};

use photosphere::accel::{Backend, BuildOptions, BuildQuality};
use photosphere::generate::Arrangement;
use photosphere::verify::bench::StandardScene;

const SPHERES: u64 = 100_000;

pub(crate) fn bench(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("build");
    group.sample_size(20).throughput(Throughput::Elements(SPHERES));
    for (name, arrangement) in [("gas", Arrangement::Gas), ("clusters", Arrangement::Clusters)] {
        let scene = StandardScene::new(arrangement, SPHERES).expect("a scene");
        let mut measure = |what: &str, backend: Backend, quality| {
            let options = BuildOptions { quality, ..BuildOptions::default() };
            group.bench_function(BenchmarkId::new(what, name), |bencher| {
                bencher.iter(|| backend.build(&scene.spheres, &options).expect("builds"));
            });
        };
        for &backend in Backend::AVAILABLE.iter().filter(|&&b| b != Backend::BruteForce) {
            measure(backend.name(), backend, BuildQuality::Best);
        }
        measure("native, fast", Backend::Native, BuildQuality::Fast);
    }
    group.finish();
}
