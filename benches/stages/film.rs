//! What it takes to add samples to a film, and to make a picture of it.

use criterion::{BatchSize, Criterion, Throughput};

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
    group.bench_function("add a block to every pixel", |bencher| {
        let empty = || Film::new(&format).expect("a small film");
        bencher.iter_batched_ref(empty, |film| add_block(film), BatchSize::LargeInput);
    });
    let film = Film::new(&format).expect("a small film");
    add_block(&film);
    group.throughput(Throughput::Elements(u64::from(SIDE * SIDE)));
    group.bench_function("picture", |bencher| bencher.iter(|| film.picture()));
    group.finish();
}

/// One block of samples for every pixel.
fn add_block(film: &Film) {
    let light = |i: u32| Radiance {
        direct: Rgb::splat(0.001 * (i % 997) as f32),
        indirect: Rgb::splat(0.002 * (i % 499) as f32),
        ..Radiance::default()
    };
    let light: Vec<_> = (0..16 * 4 * BLOCK).map(light).collect();
    let counts = vec![BLOCK; light.len() / BLOCK as usize];
    for tile in 0..film.frame().tiles() {
        let pixels = film.frame().tile(tile).pixels();
        let run = Run { light: &light[..pixels * BLOCK as usize], seen: &[] };
        film.add(tile, &counts[..pixels], run).expect("nothing is too bright");
    }
}
