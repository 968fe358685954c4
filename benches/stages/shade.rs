//! Paths in scenes of a few spheres, where finding hits costs next to nothing: camera, surfaces,
//! emitters and scattering, on one thread, with each set of vector instructions that there is.

use std::path::Path;

use criterion::{BenchmarkId, Criterion, Throughput};

use photosphere::accel::{Backend, BuildOptions};
use photosphere::color::PathRadiance;
use photosphere::integrator::{RenderContext, SampleAddress, Workspace, create};
use photosphere::math::Isa;
use photosphere::scene::{PreparedScene, read_file};
use photosphere::task::CancelToken;

/// Samples of a batch, as in a render.
const SAMPLES: u32 = 1024;

pub(crate) fn bench(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("shade");
    group.throughput(Throughput::Elements(SAMPLES.into()));
    for (name, file) in [("diffuse", "paper/fig2.toml"), ("materials", "materials.toml")] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(file);
        let file = read_file(&path, &[]).expect("a scene of ours");
        let (scene, settings) = file.build().expect("spheres of ours");
        let prepared = PreparedScene::new(&scene, settings).expect("settings of ours");
        let cancel = CancelToken::default();
        let options = BuildOptions::default();
        let accel = Backend::BruteForce.build(scene.spheres(), &options).expect("builds");
        let context = RenderContext::new(&prepared, &*accel, &cancel);
        let integrator = create(&prepared);
        // A block of neighbouring pixels in the middle, as a tile has them.
        let image = settings.image;
        let place = |i: u32| SampleAddress {
            x: image.width / 2 + i / 16 % 8,
            y: image.height / 2 + i / 128,
            sample: i % 16,
        };
        let samples: Vec<_> = (0..SAMPLES).map(place).collect();
        let mut radiance = vec![PathRadiance::default(); samples.len()];
        for isa in Isa::available() {
            let mut workspace = Workspace::with_isa(isa);
            group.bench_function(BenchmarkId::new(name, isa.name()), |bencher| {
                bencher.iter(|| {
                    radiance.fill(PathRadiance::default());
                    integrator.estimate(context, &samples, &mut radiance, &mut workspace)
                });
            });
        }
    }
    group.finish();
}
