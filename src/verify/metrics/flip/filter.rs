//! Filters of FLIP: contrast sensitivity, and detection of edges and points. All are separable, so
//! two short passes suffice.

use rayon::prelude::*;

use crate::sampling::exp;

/// One value per pixel, in rows of `width`.
#[derive(Clone)]
pub(super) struct ScalarImage {
    width: usize,
    pub(super) values: Vec<f64>,
}

/// Weights at offsets -r to r.
type Kernel = Vec<f64>;

/// Gaussian terms `(a, b)` of each channel's contrast sensitivity (table 1 of the paper).
const SENSITIVITY: [&[(f64, f64)]; 3] =
    [&[(1.0, 0.0047)], &[(1.0, 0.0053)], &[(34.1, 0.04), (13.5, 0.025)]];
/// The widest Gaussian; it sets the radius of all filters.
const WIDEST: f64 = 0.04;
/// Two standard deviations of the edge detector, in degrees.
const EDGE_WIDTH: f64 = 0.082;

impl ScalarImage {
    pub(super) fn new(width: usize, values: Vec<f64>) -> Self {
        Self { width, values }
    }

    pub(super) fn map(&self, f: impl Fn(f64) -> f64) -> Self {
        Self { width: self.width, values: self.values.iter().map(|&v| f(v)).collect() }
    }

    fn height(&self) -> usize {
        self.values.len() / self.width
    }

    /// Correlates with `along_x` times `along_y`, clamping to the nearest pixel at the border.
    fn filtered(&self, along_x: &Kernel, along_y: &Kernel) -> Self {
        let mut horizontal = vec![0.0; self.values.len()];
        horizontal.par_chunks_mut(self.width).zip(self.values.par_chunks(self.width)).for_each(
            |(out, row)| {
                let r = along_x.len() / 2;
                let padded: Vec<f64> = (0..row.len() + 2 * r)
                    .map(|i| row[i.saturating_sub(r).min(row.len() - 1)])
                    .collect();
                for (value, window) in out.iter_mut().zip(padded.windows(along_x.len())) {
                    *value = window.iter().zip(along_x).map(|(v, w)| v * w).sum();
                }
            },
        );
        let mut filtered = vec![0.0; self.values.len()];
        filtered.par_chunks_mut(self.width).enumerate().for_each(|(y, out)| {
            let r = along_y.len() / 2;
            for (i, w) in along_y.iter().enumerate() {
                let source_row = (y + i).saturating_sub(r).min(self.height() - 1);
                let row = &horizontal[source_row * self.width..(source_row + 1) * self.width];
                out.iter_mut().zip(row).for_each(|(value, v)| *value += w * v);
            }
        });
        Self { width: self.width, values: filtered }
    }
}

/// Blurs each channel by the contrast sensitivity of the eye.
pub(super) fn contrast_sensitivity(
    planes: &[ScalarImage; 3],
    pixels_per_degree: f64,
) -> [ScalarImage; 3] {
    use std::f64::consts::PI;
    let radius = (3.0 * (WIDEST / (2.0 * PI * PI)).sqrt() * pixels_per_degree).ceil() as i32;
    std::array::from_fn(|channel| {
        let mut sum = planes[channel].map(|_| 0.0);
        let mut total = 0.0;
        for &(a, b) in SENSITIVITY[channel] {
            let weight = |x: f64| exp(-PI * PI * (x / pixels_per_degree).powi(2) / b);
            let kernel = kernel(radius, weight);
            let scale = a * (PI / b).sqrt();
            let part = planes[channel].filtered(&kernel, &kernel);
            sum.values.iter_mut().zip(part.values).for_each(|(sum, v)| *sum += scale * v);
            total += scale * kernel.iter().sum::<f64>().powi(2);
        }
        sum.map(|v| v / total)
    })
}

/// Strength of edges and points, from the first and second derivative of a Gaussian.
pub(super) fn features(lightness: &ScalarImage, pixels_per_degree: f64) -> [Vec<f64>; 2] {
    let sigma = 0.5 * EDGE_WIDTH * pixels_per_degree;
    let radius = (3.0 * sigma).ceil() as i32;
    let gauss = |x: f64| exp(-(x * x) / (2.0 * sigma * sigma));
    let smooth = kernel(radius, gauss);
    let strength = |derivative: Kernel| -> Vec<f64> {
        let derivative = balanced(derivative, &smooth);
        let along_x = lightness.filtered(&derivative, &smooth);
        let along_y = lightness.filtered(&smooth, &derivative);
        along_x.values.iter().zip(along_y.values).map(|(&x, y)| libm::hypot(x, y)).collect()
    };
    let first = kernel(radius, |x| -x * gauss(x));
    let second = kernel(radius, |x| (x * x / (sigma * sigma) - 1.0) * gauss(x));
    [strength(first), strength(second)]
}

fn kernel(radius: i32, weight: impl Fn(f64) -> f64) -> Kernel {
    (-radius..=radius).map(|x| weight(f64::from(x))).collect()
}

/// Scales the positive and the negative weights so that, times `across`, they sum to 1 and to -1.
fn balanced(kernel: Kernel, across: &Kernel) -> Kernel {
    let across: f64 = across.iter().sum();
    let sum = |sign: f64| kernel.iter().map(|w| (sign * w).max(0.0)).sum::<f64>() * across;
    let (positive, negative) = (sum(1.0), sum(-1.0));
    kernel.iter().map(|&w| if w < 0.0 { w / negative } else { w / positive }).collect()
}
