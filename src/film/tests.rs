//! Films are bit-identical for any order and grouping of samples.

use proptest::prelude::*;

use super::*;
use crate::color::{PathRadiance, Rgb, VisibleSurface};
use crate::math::Rect;

const WIDTH: u32 = 21;
const HEIGHT: u32 = 9;

/// Samples without visible surfaces.
fn run(samples: &[PathRadiance]) -> SampleRun<'_> {
    static NO_SURFACES: [VisibleSurface; 1024] = [VisibleSurface::NONE; 1024];
    SampleRun { radiance: samples, visible_surfaces: &NO_SURFACES[..samples.len()] }
}

/// A sample of any magnitude and sign that the scale allows, from its address alone.
fn sample([x, y]: [u32; 2], index: u32) -> PathRadiance {
    let mut bits = u64::from(x) << 40 ^ u64::from(y) << 20 ^ u64::from(index);
    let mut next = || {
        bits = (bits ^ 0x9e37_79b9_7f4a_7c15).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits ^= bits >> 29;
        let mantissa = (bits >> 40) as f32 / (1u32 << 23) as f32 - 1.0;
        mantissa * 10f32.powi((bits % 17) as i32 - 12)
    };
    let direct = Rgb::new(next(), next(), next());
    PathRadiance { direct, indirect: Rgb::new(next(), next(), next()), alpha: (index % 3) as f32 }
}

/// A sample's visible surface, derived from its radiance.
fn visible_surface(pixel: [u32; 2], index: u32) -> VisibleSurface {
    let PathRadiance { direct, indirect, alpha } = sample(pixel, index);
    VisibleSurface {
        emission: direct,
        albedo: indirect.abs().min(Rgb::ONE),
        normal: direct.normalize_or_zero(),
        distance: direct.length() * alpha,
        position: indirect * alpha,
        row: index,
        denoising_albedo: indirect.abs().min(Rgb::ONE),
        denoising_normal: direct.normalize_or_zero(),
        sees_through: false,
    }
}

fn format(window: Rect, first_sample: u32) -> FilmFormat {
    FilmFormat {
        frame: FilmFrame { window, ..FilmFrame::full(WIDTH, HEIGHT) },
        first_sample,
        scale: RadianceScale::from_max_radiance(3.0),
        layers: Layer::ALL.to_vec(),
        sums_squares: true,
    }
}

fn whole() -> Rect {
    FilmFrame::full(WIDTH, HEIGHT).window
}

/// Adds samples to all pixels of a film up to an index, cycling through the given step sizes.
fn fill(film: &Film, end: u32, steps: &[u32], tiles: &[usize]) {
    let mut steps = steps.iter().copied().cycle();
    while let Some(&tile) =
        tiles.iter().find(|&&tile| film.min_tile_samples(tile) < end - film.first_sample())
    {
        let step = steps.next().unwrap();
        let mut counts = Vec::new();
        film.tile_counts(tile, &mut counts);
        let mut samples = Vec::new();
        for (count, pixel) in counts.iter_mut().zip(film.frame().tile(tile).pixel_coords()) {
            let next = film.first_sample() + *count;
            let range = next..next.saturating_add(step).min(end);
            *count = range.len() as u32;
            samples
                .extend(range.map(|index| (sample(pixel, index), visible_surface(pixel, index))));
        }
        let (radiance, surfaces): (Vec<_>, Vec<_>) = samples.into_iter().unzip();
        film.add(tile, &counts, SampleRun { radiance: &radiance, visible_surfaces: &surfaces })
            .unwrap();
    }
}

fn filled(window: Rect, samples: std::ops::Range<u32>, steps: &[u32]) -> Film {
    let film = Film::new(&format(window, samples.start)).unwrap();
    let tiles: Vec<usize> = (0..film.frame().tile_count()).collect();
    fill(&film, samples.end, steps, &tiles);
    film
}

/// Everything observable of a film, to the bit.
fn bits(film: &Film) -> Vec<u32> {
    let layers = film.layout.layers.iter().map(|&layer| film.mean(layer).unwrap());
    let all = layers.chain(film.variance()).flatten().flatten().map(f32::to_bits);
    all.chain(film.counts()).collect()
}

/// Compares the internal state as well: the sums themselves.
fn assert_same(a: &Film, b: &Film) {
    assert_eq!(bits(a), bits(b));
    for tile in 0..a.tiles.len() {
        let (a, b) = (a.lock(tile).clone(), b.lock(tile).clone());
        assert_eq!((a.sums, a.sums_of_squares, a.counts), (b.sums, b.sums_of_squares, b.counts));
        assert_eq!(a.coverage, b.coverage);
        let partial =
            |partial: Vec<f64>| partial.iter().map(|sum| sum.to_bits()).collect::<Vec<_>>();
        let (a, b) = (partial(a.partial_blocks), partial(b.partial_blocks));
        // Room allocated for a partial block stays for the next.
        let unused = |partial: &[u64]| partial.iter().all(|&bits| bits == 0);
        assert!(a == b || unused(&a) && unused(&b));
    }
}

#[test]
fn means_and_variances_are_those_of_the_samples() {
    let film = filled(whole(), 0..37, &[37]);
    let (direct, variance) = (film.mean(Layer::Direct).unwrap(), film.variance().unwrap());
    for (index, pixel) in whole().pixel_coords().enumerate() {
        let samples: Vec<PathRadiance> =
            (0..37).map(|sample_index| sample(pixel, sample_index)).collect();
        let values = |axis: usize| samples.iter().map(move |s| f64::from(s.direct[axis]));
        for axis in 0..3 {
            let mean = values(axis).sum::<f64>() / 37.0;
            // 2^-69 of the brightest light, and one rounding to f32.
            assert!((f64::from(direct[index][axis]) - mean).abs() <= 1e-7 * mean.abs() + 1e-15);
            let beauty =
                || samples.iter().map(|s| f64::from(s.direct[axis]) + f64::from(s.indirect[axis]));
            // Variance of the mean over 37 samples, from the two finished blocks among them.
            let beauty: Vec<f64> = beauty().collect();
            let [a, b] = [0, 16].map(|start| beauty[start..start + 16].iter().sum::<f64>());
            let block_variance = (a - b).powi(2) / 2.0;
            let expected = block_variance / 16.0 / 37.0;
            assert!((f64::from(variance[index][axis]) / expected - 1.0).abs() < 1e-6);
        }
    }
    let empty = Film::new(&format(whole(), 0)).unwrap();
    assert_eq!(empty.picture().direct[3], Rgb::ZERO);
    assert_eq!(empty.variance().unwrap()[3], [f32::INFINITY; 3]);
}

#[test]
fn samples_that_are_not_finite_are_left_out_and_counted() {
    let frame = FilmFrame::full(1, 1);
    let film = Film::new(&FilmFormat { frame, ..format(frame.window, 0) }).unwrap();
    let good = PathRadiance { direct: Rgb::splat(2.0), ..PathRadiance::default() };
    let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY]
        .map(|value| PathRadiance { indirect: Rgb::new(0.0, value, 0.0), ..good });
    assert_eq!(film.non_finite_samples(), None);
    film.add(0, &[5], run(&[bad[0], good, bad[1], good, bad[2]])).unwrap();
    assert_eq!(film.picture().direct[0], Rgb::splat(2.0));
    assert_eq!(film.non_finite_samples(), Some((3, [0, 0])));
    film.add(0, &[27], run(&[good; 27])).unwrap();
    assert_eq!((film.picture().direct[0], film.counts()[0]), (Rgb::splat(2.0), 32));

    let film = Film::new(&FilmFormat { frame, ..format(frame.window, 0) }).unwrap();
    film.add(0, &[3], run(&bad)).unwrap();
    assert!(film.picture().direct[0].is_nan(), "no light is known, which is not darkness");
}

#[test]
fn what_is_too_bright_is_an_error_and_never_wraps() {
    let frame = FilmFrame::full(40, 9);
    let film = Film::new(&FilmFormat { frame, ..format(frame.window, 0) }).unwrap();
    let bright =
        |value: f32| PathRadiance { direct: Rgb::new(0.0, value, 0.0), ..PathRadiance::default() };
    // The scale is 4, so that a block holds less than 2^36.
    let tile = 5;
    let mut counts = vec![0; film.frame().tile(tile).pixel_count()];
    counts[2] = 16;
    let limit = 2f32.powi(32);
    let mut block = [bright(limit); 16];
    block[0] = bright(0.5 * limit);
    film.add(tile, &counts, run(&block)).unwrap();
    film.add(tile, &counts, run(&block)).unwrap();
    let error = film.add(tile, &counts, run(&[bright(limit); 16])).unwrap_err();
    let expected = "samples 32 to 47 of the pixel in column 34, row 4 add up to 6.9e10; the film's \
                    limit is 6.9e10, 2^34 times the brightest light of the scene";
    assert_eq!(error.to_string(), expected);
    assert!(error.help().unwrap().contains("clamp_indirect"));
    // The same magnitude, negative: lights are never negative, but wrapping would be as wrong.
    assert!(film.add(tile, &counts, run(&[bright(-limit); 16])).is_err());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn batches_and_the_order_of_tiles_change_nothing(
        end in 1u32..70,
        steps in proptest::collection::vec(1u32..40, 1..6),
        shuffled in Just((0..FilmFrame::full(WIDTH, HEIGHT).tile_count()).collect::<Vec<_>>()).prop_shuffle(),
    ) {
        let film = Film::new(&format(whole(), 0)).unwrap();
        fill(&film, end, &steps, &shuffled);
        assert_same(&film, &filled(whole(), 0..end, &[end]));
    }

    #[test]
    fn ranges_and_windows_add_up_to_the_whole(
        end in 1u32..100,
        cuts in proptest::collection::vec(0u32..6, 0..4),
        [column, row] in [1..WIDTH, 1..HEIGHT],
        order in Just((0..60usize).collect::<Vec<_>>()).prop_shuffle(),
    ) {
        let mut cuts: Vec<u32> = cuts.iter().map(|cut| cut * BLOCK_SIZE).filter(|&cut| cut < end).collect();
        cuts.extend([0, end]);
        cuts.sort_unstable();
        cuts.dedup();
        let windows = [
            Rect { x: 0, y: 0, width: column, height: HEIGHT },
            Rect { x: column, y: 0, width: WIDTH - column, height: row },
            Rect { x: column, y: row, width: WIDTH - column, height: HEIGHT - row },
        ];
        let parts: Vec<Film> = cuts
            .windows(2)
            .flat_map(|range| windows.map(|window| filled(window, range[0]..range[1], &[7])))
            .collect();
        let mut sum = Film::new(&format(whole(), 0)).unwrap();
        for index in order.into_iter().filter(|&index| index < parts.len()) {
            sum.merge(&parts[index]).unwrap();
        }
        assert_same(&sum, &filled(whole(), 0..end, &[end]));
    }
}

#[test]
fn films_that_do_not_belong_together_are_not_added() {
    let mut film = filled(whole(), 0..20, &[20]);
    assert!(film.merge(&filled(whole(), 0..20, &[20])).is_err(), "two unfinished blocks");
    let mut part = Film::new(&format(Rect { x: 0, y: 0, width: 3, height: 3 }, 0)).unwrap();
    assert!(part.merge(&film).is_err(), "pixels without a place");
    let other = FilmFormat { scale: RadianceScale::from_max_radiance(1.0), ..format(whole(), 0) };
    assert!(film.merge(&Film::new(&other).unwrap()).is_err(), "another scale");
}

/// Writes a film and reads it back.
fn copied(film: &Film) -> Film {
    let mut copy = Film::new(&film.format()).unwrap();
    for tile in 0..film.tiles.len() {
        let mut bytes = Vec::new();
        film.write_tile(tile, &mut bytes);
        assert!(copy.read_tile(tile, &bytes));
    }
    copy
}

#[test]
fn films_come_back_from_bytes_and_go_on() {
    let window = Rect { x: 3, y: 1, width: 17, height: 7 };
    for end in [0, 5, 16, 37] {
        let film = filled(window, 0..end, &[end.max(1)]);
        let bad = PathRadiance { direct: Rgb::splat(f32::NAN), ..PathRadiance::default() };
        let mut counts = vec![0; film.frame().tile(2).pixel_count()];
        counts[..3].copy_from_slice(&[1, 0, 2]);
        film.add(2, &counts, run(&[bad, bad, sample([9, 9], 1)])).unwrap();
        let copy = copied(&film);
        assert_same(&copy, &film);
        assert_eq!(copy.non_finite_samples(), film.non_finite_samples());
        let tiles: Vec<usize> = (0..film.frame().tile_count()).collect();
        fill(&film, 50, &[3], &tiles);
        fill(&copy, 50, &[50], &tiles);
        assert_same(&copy, &film);
    }
}

#[test]
fn bytes_that_no_film_wrote_are_refused_or_harmless() {
    let window = Rect { x: 0, y: 0, width: 5, height: 3 };
    let film = filled(window, 0..37, &[37]);
    let mut bytes = Vec::new();
    film.write_tile(0, &mut bytes);
    let mut target = Film::new(&format(window, 0)).unwrap();
    for length in 0..bytes.len() {
        assert!(!target.read_tile(0, &bytes[..length]), "{length}");
    }
    assert!(!target.read_tile(0, &[&bytes[..], &[0]].concat()));
    assert_same(&target, &Film::new(&format(window, 0)).unwrap());
    // Whatever else is read, more samples can be added to it.
    let mut read = 0;
    for index in 0..bytes.len() {
        for flip in [0x01, 0x80, 0xff] {
            let mut forged = bytes.clone();
            forged[index] ^= flip;
            let mut film = Film::new(&format(window, 0)).unwrap();
            if film.read_tile(0, &forged) {
                read += 1;
                film.add(0, &[40; 15], run(&[sample([0, 0], 0); 600])).unwrap();
                assert!(film.picture().direct[0].is_finite());
            }
        }
    }
    assert!(read > 0 && read < 3 * bytes.len());
}
