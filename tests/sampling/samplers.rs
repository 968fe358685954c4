//! The samplers: how evenly they spread, that chance is fair, and what it is worth.
//!
//! Statistical checks use fixed seeds; each says how likely a right program fails it.

use std::collections::HashMap;

use photosphere::sampling::{Sampler, SamplerKind};
use statrs::distribution::{ChiSquared, ContinuousCDF};

const KINDS: [SamplerKind; 3] =
    [SamplerKind::Sobol, SamplerKind::Independent, SamplerKind::Stratified];

fn sobol(seed: u64, pixel: u64, sample: u32) -> Sampler {
    Sampler::with_kind(SamplerKind::Sobol, seed, pixel, sample, 1)
}

/// The most points in a box among those that cut each axis `i` into `2^digits[i]` equal parts.
fn fullest(points: &[Vec<f64>], digits: &[u32]) -> usize {
    let mut counts = HashMap::new();
    for point in points {
        let cell = |(u, &digits): (&f64, &u32)| (u * f64::from(1 << digits)) as u32;
        *counts.entry(point.iter().zip(digits).map(cell).collect::<Vec<_>>()).or_insert(0) += 1;
    }
    counts.into_values().max().unwrap_or(0)
}

/// Every way to share `total` digits among `axes`.
fn shares(total: u32, axes: usize) -> Vec<Vec<u32>> {
    if axes == 1 {
        return vec![vec![total]];
    }
    let with = |first: u32| shares(total - first, axes - 1).into_iter().map(move |r| (first, r));
    (0..=total).flat_map(with).map(|(first, rest)| [vec![first], rest].concat()).collect()
}

/// Returns true if the 2^m points are a (t, m, s)-net: every box of volume 2^(t - m) holds 2^t of
/// them.
fn is_net(points: &[Vec<f64>], t: u32) -> bool {
    let m = points.len().ilog2();
    let axes = points[0].len();
    shares(m - t, axes).iter().all(|digits| fullest(points, digits) == 1 << t)
}

fn points(first: u32, count: u32, pixel: u64, dimensions: &[u32]) -> Vec<Vec<f64>> {
    let point = |i| dimensions.iter().map(|&d| sobol(9, pixel, first + i).get(d)).collect();
    (0..count).map(point).collect()
}

#[test]
fn both_pairs_of_a_set_are_perfect_nets() {
    for set in [0u32, 1, 2, 9, 100, 1 << 29] {
        for m in 1..=10 {
            for first in [0, 1 << m, 3 << 20] {
                for pair in [0, 2] {
                    let pair = [4 * set + pair, 4 * set + pair + 1];
                    let net = points(first, 1 << m, 77, &pair);
                    assert!(is_net(&net, 0), "{pair:?}, 2^{m} points from {first}");
                }
            }
        }
    }
}

/// Returns true if the 4^m points are a perfect net in base 4: every box of volume 4^-m whose sides
/// are powers of 1/4 holds one of them.
fn is_perfect_in_base_4(points: &[Vec<f64>]) -> bool {
    let m = points.len().ilog2() / 2;
    let doubled = |digits: Vec<u32>| digits.into_iter().map(|n| 2 * n).collect::<Vec<_>>();
    shares(m, points[0].len()).into_iter().all(|digits| fullest(points, &doubled(digits)) == 1)
}

#[test]
fn sets_of_four_are_nets() {
    for (set, first) in [(0, 0), (1, 0), (5, 1 << 20)] {
        let dimensions: Vec<u32> = (4 * set..4 * set + 4).collect();
        for m in 1..=5 {
            let net = points(first, 1 << (2 * m), 3, &dimensions);
            assert!(is_perfect_in_base_4(&net), "set {set}, 4^{m}");
        }
        // In base 2, where t = 0 is impossible for four dimensions.
        for (m, t) in [(4, 1), (5, 2), (6, 2), (7, 3), (8, 2), (9, 3)] {
            let net = points(first, 1 << m, 3, &dimensions);
            assert!(is_net(&net, t) && !is_net(&net, t - 1), "set {set}, 2^{m}");
        }
    }
    assert!(!is_perfect_in_base_4(&points(0, 64, 3, &[0, 1, 4, 5])), "the check can fail");
}

#[test]
fn a_net_of_a_million_grows_out_of_smaller_ones() {
    // No reseeding at 2^16 or anywhere else: the first 2^20 samples of a pixel are one net.
    let numbers: Vec<[f64; 2]> = (0..1 << 20).map(|i| sobol(4, 8, i).get_2d(8)).collect();
    for x_digits in 0..=20 {
        let mut seen = vec![false; 1 << 20];
        for [x, y] in &numbers {
            let y_digits = 20 - x_digits;
            let column = (x * f64::from(1 << x_digits)) as usize;
            let cell = column << y_digits | (y * f64::from(1 << y_digits)) as usize;
            assert!(!std::mem::replace(&mut seen[cell], true));
        }
    }
    // The highest index works as well.
    assert!((0.0..1.0).contains(&sobol(4, 8, u32::MAX).get(11)));
}

/// Chi-square at a significance of 1e-5.
fn must_be_uniform(counts: &[u32], what: String) {
    let total: u32 = counts.iter().sum();
    let expected = f64::from(total) / counts.len() as f64;
    let chi2: f64 = counts.iter().map(|&c| (f64::from(c) - expected).powi(2) / expected).sum();
    let p = ChiSquared::new(counts.len() as f64 - 1.0).expect("positive").sf(chi2);
    assert!(p > 1e-5, "{what}: p = {p:.1e}");
}

#[test]
fn every_number_is_uniform_over_the_pixels() {
    // Chi-square of 256 cells over 2^16 pixels, for single numbers and for pairs (16 x 16 cells).
    // 108 tests at 1e-5: a right program fails with a probability of 1e-3.
    for kind in KINDS {
        for dimension in [0, 2, 4, 6, 44, 46] {
            for sample in [0, 1, 1000] {
                let (mut one, mut two) = (vec![0; 256], vec![0; 256]);
                for pixel in 0..1 << 16 {
                    let sampler = Sampler::with_kind(kind, 1, pixel, sample, 1024);
                    let [x, y] = sampler.get_2d(dimension);
                    one[(x * 256.0) as usize] += 1;
                    two[(x * 16.0) as usize * 16 + (y * 16.0) as usize] += 1;
                }
                must_be_uniform(&one, format!("{kind:?}, sample {sample}, dimension {dimension}"));
                must_be_uniform(&two, format!("{kind:?}, sample {sample}, pair {dimension}"));
            }
        }
    }
}

#[test]
fn pairs_are_uniform_down_to_the_cells_within_cells() {
    // Where a pixel has few samples each has a cell of its own, and within that its own row and
    // column: n^2 places, all as likely. Chi-square over 2^17 pixels, one sample of each; 18 tests
    // at 1e-5.
    for kind in KINDS {
        for n in [4, 9, 16] {
            for pair in [0, 6] {
                let mut counts = vec![0; (n * n) as usize];
                for pixel in 0..1 << 17 {
                    let sampler = Sampler::with_kind(kind, 4, pixel, pixel as u32 % n, n);
                    let [x, y] = sampler.get_2d(pair).map(|u| (u * f64::from(n)) as u32);
                    counts[(x * n + y) as usize] += 1;
                }
                must_be_uniform(&counts, format!("{kind:?}, {n} samples, pair {pair}"));
            }
        }
    }
}

#[test]
fn numbers_of_other_addresses_are_uncorrelated() {
    // The correlation of two independent uniform series of n numbers has standard deviation
    // 1 / sqrt(n); five of them are allowed (significance 6e-7 each, 93 checks). Series run over
    // pixels; samples of one pixel are compared with other sets, pixels and seeds.
    let n = 40_000;
    type Address = (u64, u64, u32, u32);
    let others: Vec<(&str, Address)> = vec![
        ("seed", (1, 0, 0, 0)),
        ("next pixel", (0, 1, 0, 0)),
        ("next row", (0, 640, 0, 0)),
        ("sample of the next pixel", (0, 1, 1, 0)),
        ("second number of the pair", (0, 0, 0, 1)),
        ("other half of the set", (0, 0, 0, 2)),
        ("next set", (0, 0, 0, 4)),
        ("next vertex", (0, 0, 0, 8)),
        ("far set", (0, 0, 0, 400)),
        ("other pixel and set", (0, 3, 2, 4)),
    ];
    for kind in KINDS {
        for dimension in [0, 5, 14] {
            for (name, (seed, pixel, sample, set)) in &others {
                let number = |s: u64, p: u64, i: u32, d: u32| {
                    Sampler::with_kind(kind, s, p, i, 64).get(dimension + d) - 0.5
                };
                let product = |p| number(0, p, 5, 0) * number(*seed, p + pixel, 5 + sample, *set);
                let correlation = 12.0 * (0..n).map(product).sum::<f64>() / n as f64;
                let allowed = 5.0 / (n as f64).sqrt();
                assert!(correlation.abs() < allowed, "{kind:?} {dimension} {name}: {correlation}");
            }
        }
    }
}

#[test]
fn within_a_pixel_sets_are_joined_at_random() {
    // The same over the samples of one pixel, where evenness makes correlations smaller still.
    for pixel in 0..20 {
        let n = 4096;
        for (a, b) in [(0, 4), (1, 8), (4, 12), (5, 9)] {
            let product = |i| (sobol(0, pixel, i).get(a) - 0.5) * (sobol(0, pixel, i).get(b) - 0.5);
            let correlation = 12.0 * (0..n).map(product).sum::<f64>() / f64::from(n);
            assert!(correlation.abs() < 5.0 / f64::from(n).sqrt(), "{pixel} {a} {b}");
        }
    }
}

/// The error of the mean of `(x + y^2)^2` over n samples of each of 64 pixels.
fn errors(kind: SamplerKind, dimension: u32, n: u32) -> Vec<f64> {
    let error = |pixel| {
        let value = |sample| {
            let [x, y] = Sampler::with_kind(kind, 2, pixel, sample, n).get_2d(dimension);
            (x + y * y) * (x + y * y)
        };
        (0..n).map(value).sum::<f64>() / f64::from(n) - 13.0 / 15.0
    };
    (0..64).map(error).collect()
}

#[test]
fn the_error_of_a_smooth_integral_falls_with_the_power_that_theory_says() {
    // Scrambled nets: n^-3/2 up to logarithms (Owen 1997); independent numbers: n^-1/2; jittered
    // ones in two dimensions: n^-1. A root mean square over 64 pixels is off by 9 % (one sigma), a
    // slope over a factor of 64 by 0.03: five of those, and 0.05 for the logarithms.
    for (kind, expected) in [
        (SamplerKind::Sobol, -1.5),
        (SamplerKind::Independent, -0.5),
        (SamplerKind::Stratified, -1.0),
    ] {
        for dimension in [0, 6, 20] {
            let rms = |n| {
                let errors = errors(kind, dimension, n);
                (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt()
            };
            let slope = (rms(4096) / rms(64)).ln() / 64f64.ln();
            println!("{kind:?}, dimension {dimension}: {slope:.3}");
            let not_worse = slope < expected + 0.3;
            let not_better = slope > expected - 0.3;
            assert!(not_worse && not_better, "{kind:?}, dimension {dimension}: {slope}");
        }
    }
}

#[test]
fn means_are_right_for_any_number_of_samples() {
    // 64 independent pixels, 45 checks of four and a half standard errors (1.1e-4 in all at 64
    // degrees of freedom, Student's t: 3e-5 each).
    for kind in KINDS {
        for dimension in [0, 6, 100] {
            for n in [1, 3, 7, 16, 100] {
                let errors = errors(kind, dimension, n);
                let count = errors.len() as f64;
                let mean = errors.iter().sum::<f64>() / count;
                let variance =
                    errors.iter().map(|e| (e - mean).powi(2)).sum::<f64>() / (count - 1.0);
                let allowed = 4.5 * (variance / count).sqrt();
                assert!(mean.abs() < allowed, "{kind:?} {dimension} {n}: {mean} > {allowed}");
            }
        }
    }
}

#[test]
fn a_number_is_the_same_alone_and_in_its_pair_and_never_one() {
    for kind in KINDS {
        for sample in 0..1000 {
            let sampler = Sampler::with_kind(kind, 5, 6, sample, 1000);
            // Also where a pair begins in the middle of another, or in one set and ends in the
            // next.
            for dimension in 0..9 {
                let pair = sampler.get_2d(dimension);
                assert_eq!(pair, [dimension, dimension + 1].map(|d| sampler.get(d)), "{kind:?}");
                assert!(pair.iter().all(|u| (0.0..1.0).contains(u)));
            }
        }
    }
}

/// Scene, seed and sample name a number for good: a checkpoint goes on with the numbers of the
/// program that wrote it, and a picture can be made again. So these are pinned. If they change then
/// every picture does: that is a decision, and goes into the changelog.
#[test]
fn numbers_are_those_of_every_version() {
    let digest = |kind| {
        let mut digest = 0u64;
        for seed in [0, 1, 0x1234_5678_9abc] {
            for pixel in [0, 1, 639, 307_199, 1 << 40] {
                for (sample, samples) in [(0, 1), (3, 4), (11, 12), (37, 64), (12_345, 10_000)] {
                    let sampler = Sampler::with_kind(kind, seed, pixel, sample, samples);
                    for dimension in [0, 1, 2, 3, 4, 9, 14, 100, 1 << 30, (1 << 31) + 7] {
                        let bits = sampler.get(dimension).to_bits();
                        digest = (digest ^ bits).wrapping_mul(0x0100_0000_01b3).rotate_left(29);
                    }
                }
            }
        }
        digest
    };
    assert_eq!(
        KINDS.map(digest),
        [0x08ac_ddf2_e00f_243c, 0xb0a9_ace4_7963_2071, 0x1331_24dd_1d2d_f6fa],
    );
}
