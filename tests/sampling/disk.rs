//! What keeping neighbours together is worth where light is sampled over a disk.

use photosphere::sampling::{Sampler, SamplerKind, sample_disk, sin_cos_2pi};

const SAMPLES: u32 = 16;
const PIXELS: u64 = 400;
const BATCHES: u64 = 16;
/// Student's t with 15 degrees of freedom at a one-sided significance of 1e-6.
const T: f64 = 7.3;

fn polar([u, v]: [f64; 2]) -> [f64; 2] {
    let (sin, cos) = sin_cos_2pi(v);
    [u.sqrt() * cos, u.sqrt() * sin]
}

/// Returns the sum of a pixel's variances over edges at 9 distances from the middle, in 16
/// directions.
fn variance(kind: SamplerKind, map: fn([f64; 2]) -> [f64; 2], batch: u64) -> f64 {
    let pixel = |pixel| -> Vec<[f64; 2]> {
        let sampler = |sample| Sampler::with_kind(kind, 3, pixel, sample, SAMPLES);
        (0..SAMPLES).map(|sample| map(sampler(sample).get_2d(2))).collect()
    };
    let pixels: Vec<_> = (batch * PIXELS..(batch + 1) * PIXELS).map(pixel).collect();
    let edges = (0..16).flat_map(|turn| (-4..=4).map(move |distance| (turn, distance)));
    let of_edge = |(turn, distance)| {
        let (sin, cos) = sin_cos_2pi((f64::from(turn) + 0.3) / 16.0);
        let offset = 0.2 * f64::from(distance);
        let lit = |points: &Vec<[f64; 2]>| {
            points.iter().filter(|[x, y]| x * cos + y * sin < offset).count() as f64
        };
        let counts: Vec<f64> = pixels.iter().map(lit).collect();
        let mean = counts.iter().sum::<f64>() / PIXELS as f64;
        counts.iter().map(|count| (count - mean).powi(2)).sum::<f64>() / (PIXELS - 1) as f64
    };
    edges.map(of_edge).sum()
}

#[test]
#[allow(clippy::print_stdout, reason = "the figures are worth reading with --nocapture")]
fn edges_across_a_disk_have_less_variance_than_in_polar_coordinates() {
    let concentric = |u| sample_disk(u).point;
    let ratio = |kind| {
        let batches = 0..BATCHES;
        let pairs: Vec<[f64; 2]> =
            batches.map(|b| [variance(kind, concentric, b), variance(kind, polar, b)]).collect();
        let [own, other] = [0, 1].map(|i| pairs.iter().map(|pair| pair[i]).sum::<f64>());
        let ratio = own / other;
        let squares = pairs.iter().map(|[a, b]| (a - ratio * b).powi(2)).sum::<f64>();
        let error = (squares * BATCHES as f64 / (BATCHES - 1) as f64).sqrt() / other;
        println!("{kind:?}: {ratio:.3} +- {error:.3}");
        (ratio, error)
    };
    let (value, error) = ratio(SamplerKind::Sobol);
    assert!(value + T * error < 0.95, "{value} +- {error}");
    // With independent numbers, all maps of equal density are alike.
    let (value, error) = ratio(SamplerKind::Independent);
    assert!((value - 1.0).abs() < T * error, "{value} +- {error}");
}
