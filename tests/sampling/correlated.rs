//! Variance beside correlated multi-jitter, the yardstick at few samples.
//!
//! Correlated multi-jitter must know the number of samples in advance, so it cannot be a sampler of
//! ours. It serves the pixel and the light with a pattern each, joined at random.

use photosphere::sampling::{Sampler, SamplerKind};

use crate::families::{Family, Point, draw};

/// Correlated multi-jitter, as listed by Kensler 2013, "Correlated Multi-Jittered Sampling", Pixar
/// Technical Memo 13-01.
mod kensler {
    /// Returns sample `s` of the `samples` in pattern `p`.
    pub(super) fn cmj(s: u32, samples: u32, p: u32) -> [f64; 2] {
        let m = samples.isqrt();
        let n = samples.div_ceil(m);
        let s = permute(s, samples, p.wrapping_mul(0x5163_3e2d));
        let sx = permute(s % m, m, p.wrapping_mul(0x68bc_21eb));
        let sy = permute(s / m, n, p.wrapping_mul(0x02e5_be93));
        let [jx, jy] = [0x967a_889b, 0x368c_c8b7].map(|k: u32| jitter(s, p.wrapping_mul(k)));
        let [m, n, sx, sy] = [m, n, sx, sy].map(f64::from);
        [(sx + (sy + jx) / n) / m, (f64::from(s) + jy) / f64::from(samples)]
    }

    pub(super) fn permute(mut i: u32, length: u32, p: u32) -> u32 {
        let w = length.next_power_of_two() - 1;
        loop {
            i = (i ^ p).wrapping_mul(0xe170_893d);
            i ^= p >> 16;
            i ^= (i & w) >> 4;
            i = (i ^ p >> 8).wrapping_mul(0x0929_eb3f);
            i ^= p >> 23;
            i ^= (i & w) >> 1;
            i = i.wrapping_mul(1 | p >> 27).wrapping_mul(0x6935_fa69);
            i = (i ^ (i & w) >> 11).wrapping_mul(0x74dc_b303);
            i = (i ^ (i & w) >> 2).wrapping_mul(0x9e50_1cc3);
            i = (i ^ (i & w) >> 2).wrapping_mul(0xc860_a3df) & w;
            i ^= i >> 5;
            if i < length {
                return i.wrapping_add(p) % length;
            }
        }
    }

    fn jitter(i: u32, p: u32) -> f64 {
        let mut i = i ^ p;
        i ^= i >> 17;
        i = (i ^ i >> 10).wrapping_mul(0xb365_34e5);
        i ^= i >> 12;
        i = (i ^ i >> 21).wrapping_mul(0x93fc_4795) ^ 0xdf6e_307f;
        i = (i ^ i >> 17).wrapping_mul(1 | p >> 18);
        f64::from(i) / 4_294_967_808.0
    }
}

#[test]
fn the_yardstick_stratifies_as_its_paper_says() {
    for samples in [16u32, 36, 64, 121, 256] {
        let side = samples.isqrt() as usize;
        let [mut cells, mut columns, mut rows] = [(); 3].map(|()| vec![0; samples as usize]);
        for s in 0..samples {
            let [x, y] = kensler::cmj(s, samples, 99);
            let index = |u: f64, count: usize| (u * count as f64) as usize;
            cells[index(y, side) * side + index(x, side)] += 1;
            columns[index(x, samples as usize)] += 1;
            rows[index(y, samples as usize)] += 1;
        }
        assert!(cells.iter().chain(&columns).chain(&rows).all(|&count| count == 1), "{samples}");
    }
}

/// Ways to draw a pixel's points, which have two dimensions for the pixel and two for the light.
#[derive(Clone, Copy)]
enum Kind {
    Yardstick,
    /// A set of four dimensions.
    Sobol,
    /// Pairs of two sets, joined at random.
    SobolPairs,
    Independent,
}

fn points(kind: Kind, pixel: u64, samples: u32) -> Vec<Point> {
    let sobol = |sample, light| {
        let sampler = Sampler::with_kind(SamplerKind::Sobol, 13, pixel, sample, samples);
        [sampler.get_2d(0), sampler.get_2d(light)].concat()
    };
    let pattern = |pair| Sampler::independent(13, pixel, pair).get(0) * 2f64.powi(32);
    let [first, second] = [0, 1].map(|pair| pattern(pair) as u32);
    let point = |sample| match kind {
        Kind::Sobol => sobol(sample, 2),
        Kind::SobolPairs => sobol(sample, 4),
        Kind::Independent => {
            let sampler = Sampler::independent(13, pixel, sample);
            [sampler.get_2d(0), sampler.get_2d(2)].concat()
        }
        Kind::Yardstick => [first, second].map(|p| kensler::cmj(sample, samples, p)).concat(),
    };
    (0..samples).map(|sample| point(sample).try_into().expect("four numbers")).collect()
}

/// Pixels of a batch, each with numbers of its own, and batches.
const PIXELS: u64 = 32;
const BATCHES: u64 = 32;

/// Returns the variance of a pixel, mean over a family's members, of each batch.
fn variances(kind: Kind, family: Family, samples: u32) -> Vec<f64> {
    let members = draw(family);
    let batch = |batch| {
        let pixels: Vec<_> =
            (0..PIXELS).map(|i| points(kind, batch * PIXELS + i, samples)).collect();
        let variance = |member: &crate::families::Integrand| {
            let mean = |points: &Vec<Point>| {
                points.iter().map(|&p| member(p)).sum::<f64>() / f64::from(samples)
            };
            let means: Vec<f64> = pixels.iter().map(mean).collect();
            let mean = means.iter().sum::<f64>() / PIXELS as f64;
            means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / (PIXELS - 1) as f64
        };
        members.iter().map(variance).sum::<f64>() / members.len() as f64
    };
    (0..BATCHES).map(batch).collect()
}

/// A ratio of two means over the batches.
struct Ratio {
    value: f64,
    standard_error: f64,
}

/// Student's t with 31 degrees of freedom at a one-sided significance of 1e-5.
const T: f64 = 5.05;

impl Ratio {
    /// The variance with a kind of points over that with the yardstick.
    fn new(kind: Kind, family: Family, samples: u32) -> Self {
        let [own, other] = [kind, Kind::Yardstick].map(|kind| variances(kind, family, samples));
        let mean = |values: &[f64]| values.iter().sum::<f64>() / BATCHES as f64;
        let value = mean(&own) / mean(&other);
        let squares = own.iter().zip(&other).map(|(a, b)| (a - value * b).powi(2)).sum::<f64>();
        let standard_error = (squares / (BATCHES * (BATCHES - 1)) as f64).sqrt() / mean(&other);
        Self { value, standard_error }
    }

    fn is_certainly_above(&self, bound: f64) -> bool {
        self.value - T * self.standard_error > bound * (1.0 + 1e-5)
    }

    fn is_certainly_below(&self, bound: f64) -> bool {
        self.value + T * self.standard_error < bound
    }
}

#[test]
fn four_dimensions_are_as_good_as_correlated_multi_jitter() {
    // 18 bounds at 1e-5 each. 36 and 121 samples are shown: no sampler that can be extended fills a
    // square grid of any side.
    for family in Family::PIXEL_AND_LIGHT {
        for samples in [16, 36, 64, 121, 256] {
            let ratio = Ratio::new(Kind::Sobol, family, samples);
            let Ratio { value, standard_error } = ratio;
            println!("{family:?}, {samples} samples: {value:.3} +- {standard_error:.3}");
            if [16, 64, 256].contains(&samples) {
                assert!(standard_error < 0.03, "{family:?}, {samples} samples: not measured");
                assert!(!ratio.is_certainly_above(1.1), "{family:?}, {samples} samples: {value}");
            }
        }
    }
}

#[test]
fn pairs_that_are_joined_at_random_are_worse_than_correlated_multi_jitter() {
    // What the sets of four are for.
    let ratio = Ratio::new(Kind::SobolPairs, Family::EdgeTimesEdge, 256);
    println!("{:.3} +- {:.3}", ratio.value, ratio.standard_error);
    assert!(ratio.is_certainly_above(1.0));
    // The check above can fail.
    let ratio = Ratio::new(Kind::Independent, Family::EdgeTimesEdge, 16);
    assert!(ratio.is_certainly_above(1.1));
}

#[test]
fn in_two_dimensions_correlated_multi_jitter_is_hardly_better() {
    // Nested scrambling fixes the distribution of any two points of a perfect pair, and so the
    // variance; see `docs/sampling.md`. So it is beyond the first 16 points, whose cells are ours
    // to choose. Correlated multi-jitter moves the cells of a column alike, which cancels where an
    // integrand is symmetric about the middle, but little elsewhere.
    for family in [Family::DiscAnywhere, Family::EdgeAnywhere] {
        for samples in [16, 36, 64, 121, 256] {
            let ratio = Ratio::new(Kind::Sobol, family, samples);
            let Ratio { value, standard_error } = ratio;
            println!("{family:?}, {samples} samples: {value:.3} +- {standard_error:.3}");
            if [16, 64, 256].contains(&samples) {
                assert!(ratio.is_certainly_below(1.3), "{family:?}, {samples} samples: {value}");
            }
        }
    }
    for samples in [16, 64, 256] {
        let ratio = Ratio::new(Kind::Sobol, Family::DiscInTheMiddle, samples);
        println!(
            "disc in the middle, {samples}: {:.2} +- {:.2}",
            ratio.value, ratio.standard_error
        );
    }
}
