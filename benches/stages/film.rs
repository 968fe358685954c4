//! What it takes to add samples to a film, and to make a picture of it.

use criterion::{Criterion, Throughput};

use photosphere::color::{Radiance, Rgb};
use photosphere::film::{BLOCK, Film, Format, Frame, Kind, Run, Scale, summed_for};

const SIDE: u32 = 128;

pub(crate) fn bench(criterion: &mut Criterion) {
    let format = Format {
        frame: Frame::whole(SIDE, SIDE),
        first_sample: 0,
        scale: Scale::of_brightest(1.0),
        layers: summed_for(&Kind::USUAL),
        squares: true,
    };
    let mut group = criterion.benchmark_group("film");
    group.throughput(Throughput::Elements(u64::from(SIDE * SIDE * BLOCK)));
    let light = light(16 * 4 * BLOCK);
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

fn light(samples: u32) -> Vec<Radiance> {
    let of = |i: u32| Radiance {
        direct: Rgb::splat(0.001 * (i % 997) as f32),
        indirect: Rgb::splat(0.002 * (i % 499) as f32),
        ..Radiance::default()
    };
    (0..samples).map(of).collect()
}

/// One block of samples for every pixel.
fn add_block(light: &[Radiance], film: &Film) {
    let counts = vec![BLOCK; light.len() / BLOCK as usize];
    for tile in 0..film.frame().tiles() {
        let pixels = film.frame().tile(tile).pixels();
        let run = Run { light: &light[..pixels * BLOCK as usize], seen: &[] };
        film.add(tile, &counts[..pixels], run).expect("nothing is too bright");
    }
}

/// What [`add_block`] adds, by plain arithmetic: both layers, and the squares of their sum.
fn add_block_inexactly(light: &[Radiance], sums: &mut [[f64; 9]]) {
    let blocks = light.chunks_exact(BLOCK as usize).cycle();
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
