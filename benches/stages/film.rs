//! What it takes to add samples to a film, and to make a picture of it.

use criterion::{Criterion, Throughput};

use photosphere::color::{PathRadiance, Rgb};
use photosphere::film::{
    Aov, BLOCK_SIZE, Film, FilmFormat, FilmFrame, RadianceScale, SampleRun, required_layers,
};

const SIDE: u32 = 128;

pub(crate) fn bench(criterion: &mut Criterion) {
    let format = FilmFormat {
        frame: FilmFrame::full(SIDE, SIDE),
        first_sample: 0,
        scale: RadianceScale::from_max_radiance(1.0),
        layers: required_layers(&Aov::DEFAULT),
        sums_squares: true,
    };
    let mut group = criterion.benchmark_group("film");
    group.throughput(Throughput::Elements(u64::from(SIDE * SIDE * BLOCK_SIZE)));
    let light = light(16 * 4 * BLOCK_SIZE);
    // One film for all rounds: a render touches a pixel's memory for the first time only once.
    let film = Film::new(&format).expect("a small film");
    group.bench_function("add a block to every pixel", |bencher| {
        bencher.iter(|| add_block(&light, &film));
    });
    let mut sums = vec![[0.0; 9]; (SIDE * SIDE) as usize];
    group.bench_function("the same sums in f64, which are not exact", |bencher| {
        bencher.iter(|| add_block_inexactly(&light, &mut sums));
    });
    group.throughput(Throughput::Elements(u64::from(SIDE * SIDE)));
    group.bench_function("picture", |bencher| bencher.iter(|| film.picture()));
    group.finish();
}

fn light(samples: u32) -> Vec<PathRadiance> {
    let of = |i: u32| PathRadiance {
        direct: Rgb::splat(0.001 * (i % 997) as f32),
        indirect: Rgb::splat(0.002 * (i % 499) as f32),
        ..PathRadiance::default()
    };
    (0..samples).map(of).collect()
}

/// One block of samples for every pixel.
fn add_block(light: &[PathRadiance], film: &Film) {
    let counts = vec![BLOCK_SIZE; light.len() / BLOCK_SIZE as usize];
    for tile in 0..film.frame().tile_count() {
        let pixels = film.frame().tile(tile).pixel_count();
        let run =
            SampleRun { radiance: &light[..pixels * BLOCK_SIZE as usize], visible_surfaces: &[] };
        film.add(tile, &counts[..pixels], run).expect("nothing is too bright");
    }
}

/// What [`add_block`] adds, by plain arithmetic: both layers, and the squares of their sum.
fn add_block_inexactly(light: &[PathRadiance], sums: &mut [[f64; 9]]) {
    let blocks = light.chunks_exact(BLOCK_SIZE as usize).cycle();
    for (sums, block) in sums.iter_mut().zip(blocks) {
        let mut of_block = [0.0; 6];
        for sample in block {
            for channel in 0..3 {
                of_block[channel] += f64::from(sample.direct[channel]);
                of_block[3 + channel] += f64::from(sample.indirect[channel]);
            }
        }
        for channel in 0..3 {
            let [direct, indirect] = [of_block[channel], of_block[3 + channel]];
            sums[channel] += direct;
            sums[3 + channel] += indirect;
            sums[6 + channel] += (direct + indirect) * (direct + indirect);
        }
    }
}
