//! Rays of the second bounce through a hundred thousand spheres, on one thread.

use criterion::{BenchmarkId, Criterion, Throughput};

use photosphere::accel::{Accel, Backend, BuildOptions};
use photosphere::generate::Arrangement;
use photosphere::math::{Hit, Ray};
use photosphere::verify::bench::{BackendSet, SECOND_BOUNCE, StandardScene};

const SPHERES: u64 = 100_000;
const RAYS: usize = 16_384;
/// As many as an integrator has in one call.
const BATCH: usize = 512;

pub(crate) fn bench(criterion: &mut Criterion) {
    for (name, arrangement) in [("gas", Arrangement::Gas), ("packed", Arrangement::Packed)] {
        let scene = StandardScene::new(arrangement, SPHERES).expect("a scene");
        let trees: Vec<Backend> =
            Backend::AVAILABLE.iter().copied().filter(|&b| b != Backend::BruteForce).collect();
        let options = BuildOptions::default();
        let field = BackendSet::build(&scene.spheres, &trees, &options, 1).expect("builds");
        let kinds = field.ray_sets(scene.camera_rays);
        let kind = kinds.iter().find(|kind| kind.name == SECOND_BOUNCE).expect("there is one");
        let rays = &kind.rays[..RAYS.min(kind.rays.len())];
        for (backend, accel) in field.backends() {
            one(criterion, &format!("{}/{name}", backend.name()), accel, rays);
        }
    }
}

fn one(criterion: &mut Criterion, name: &str, accel: &dyn Accel, rays: &[Ray]) {
    let mut group = criterion.benchmark_group("trace");
    group.sample_size(20).throughput(Throughput::Elements(rays.len() as u64));
    let mut hits = vec![Hit::MISS; BATCH];
    group.bench_function(BenchmarkId::new("closest", name), |bencher| {
        bencher.iter(|| {
            for rays in rays.chunks(BATCH) {
                accel.closest(rays, &mut hits[..rays.len()]);
            }
        });
    });
    let mut blocked = vec![false; BATCH];
    group.bench_function(BenchmarkId::new("occluded", name), |bencher| {
        bencher.iter(|| {
            for rays in rays.chunks(BATCH) {
                accel.occluded(rays, &mut blocked[..rays.len()]);
            }
        });
    });
    group.finish();
}
