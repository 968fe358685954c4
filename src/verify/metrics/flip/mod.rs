//! FLIP: the difference perceived when flipping between two images.
//!
//! LDR-FLIP of P. Andersson, J. Nilsson, T. Akenine-Möller, M. Oskarsson, K. Åström and M. D.
//! Fairchild, "FLIP: A Difference Evaluator for Alternating Images", Proc. ACM Comput. Graph.
//! Interact. Tech. 3(2), 2020. Colours are blurred as by the eye at a given distance, then compared
//! in a perceptually uniform space. Differences in edges and points add to the result.
//!
//! FLIP compares displayed images: radiance is clamped to [0, 1], as in our `.png` but without
//! rounding to 8 bits. No exposure is applied, so everything above 1 is white.

mod color;
mod filter;

use crate::color::Rgb;
use crate::math::DVec3;
use crate::sampling::powf;

use filter::ScalarImage;

/// Pixels per degree of visual angle: a screen 0.7 m wide with 3840 pixels, seen from 0.7 m (the
/// paper's default).
pub const PIXELS_PER_DEGREE: f64 = 3840.0 * std::f64::consts::PI / 180.0;

/// Exponent q_c of colour differences.
const COLOR_EXPONENT: f64 = 0.7;
/// Differences up to a fraction p_c of the largest one are mapped to a fraction p_t of the scale.
const KNEE: (f64, f64) = (0.4, 0.95);
/// Exponent q_f of feature differences.
const FEATURE_EXPONENT: f64 = 0.5;

/// Returns the difference at every pixel, from 0 (looks identical) to 1. Both images are `width`
/// pixels wide. Symmetric in `a` and `b`.
pub fn map(a: &[Rgb], b: &[Rgb], width: usize, pixels_per_degree: f64) -> Vec<f64> {
    let (a, b) = (
        PerceptualFeatures::new(a, width, pixels_per_degree),
        PerceptualFeatures::new(b, width, pixels_per_degree),
    );
    let largest = largest_difference();
    let pixel = |i: usize| {
        let color = color_difference(a.colors[i], b.colors[i], largest);
        let feature = (a.edges[i] - b.edges[i]).abs().max((a.points[i] - b.points[i]).abs());
        let feature = powf(feature / std::f64::consts::SQRT_2, FEATURE_EXPONENT);
        powf(color, 1.0 - feature)
    };
    (0..a.colors.len()).map(pixel).collect()
}

/// Perceptual features of an image.
struct PerceptualFeatures {
    /// Blurred colours, in L*a*b* with the Hunt effect.
    colors: Vec<DVec3>,
    /// Edge strength at each pixel.
    edges: Vec<f64>,
    /// Point and line strength at each pixel.
    points: Vec<f64>,
}

impl PerceptualFeatures {
    fn new(picture: &[Rgb], width: usize, pixels_per_degree: f64) -> Self {
        let on_screen = |color: &Rgb| color.as_dvec3().clamp(DVec3::ZERO, DVec3::ONE);
        let opponent: Vec<DVec3> =
            picture.iter().map(|color| color::opponent(on_screen(color))).collect();
        let plane =
            |axis: usize| ScalarImage::new(width, opponent.iter().map(|c| c[axis]).collect());
        let planes = [plane(0), plane(1), plane(2)];
        let blurred = filter::contrast_sensitivity(&planes, pixels_per_degree);
        let blurred = |i: usize| DVec3::from_array(std::array::from_fn(|c| blurred[c].values[i]));
        let linear = |i: usize| color::from_opponent(blurred(i)).clamp(DVec3::ZERO, DVec3::ONE);
        let [lightness, ..] = planes;
        let lightness = lightness.map(|y| (y + 16.0) / 116.0);
        let [edges, points] = filter::features(&lightness, pixels_per_degree);
        let colors = (0..picture.len()).map(|i| color::hunt_lab(linear(i))).collect();
        Self { colors, edges, points }
    }
}

/// Largest difference between two displayable colours, green and blue.
fn largest_difference() -> f64 {
    let [green, blue] = [DVec3::Y, DVec3::Z].map(color::hunt_lab);
    powf(color::hyab(green, blue), COLOR_EXPONENT)
}

/// Colour difference in [0, 1].
fn color_difference(a: DVec3, b: DVec3, largest: f64) -> f64 {
    let (knee, knee_value) = (KNEE.0 * largest, KNEE.1);
    let difference = powf(color::hyab(a, b), COLOR_EXPONENT);
    if difference < knee {
        knee_value / knee * difference
    } else {
        knee_value + (difference - knee) / (largest - knee) * (1.0 - knee_value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: (usize, usize) = (40, 30);

    /// A colourful pattern that is easy to reproduce in any language.
    fn pattern(k: usize) -> Vec<Rgb> {
        let value = |i: usize, c: usize| {
            let x = i % SIZE.0;
            let number = i * (7 + 4 * c) + k * (13 * c + 5) * (x / 5) + 31 * c;
            (number % 97) as f32 / 96.0
        };
        (0..SIZE.0 * SIZE.1).map(|i| Rgb::new(value(i, 0), value(i, 1), value(i, 2))).collect()
    }

    fn uniform(r: f32, g: f32, b: f32) -> Vec<Rgb> {
        vec![Rgb::new(r, g, b); SIZE.0 * SIZE.1]
    }

    fn mean(a: &[Rgb], b: &[Rgb]) -> f64 {
        let map = map(a, b, SIZE.0, PIXELS_PER_DEGREE);
        map.iter().sum::<f64>() / map.len() as f64
    }

    fn close(value: f64, expected: f64) {
        assert!((value - expected).abs() < 1e-4, "{value} for {expected}");
    }

    // Expected values from the authors' program (flip-evaluator 1.7, in f32).

    #[test]
    fn a_pattern_has_the_values_of_the_authors_program() {
        let at = |map: &[f64], x: usize, y: usize| map[y * SIZE.0 + x];
        let map = |ppd| super::map(&pattern(0), &pattern(1), SIZE.0, ppd);
        let default = map(PIXELS_PER_DEGREE);
        close(default.iter().sum::<f64>() / default.len() as f64, 0.329_950);
        close(at(&default, 20, 15), 0.212_424);
        close(at(&default, 39, 29), 0.460_592);
        close(at(&default, 31, 7), 0.393_867);
        close(at(&default, 0, 0), 0.042_196);
        let near = map(20.0);
        close(near.iter().sum::<f64>() / near.len() as f64, 0.717_270);
        close(at(&near, 20, 15), 0.750_925);
    }

    #[test]
    fn plain_colours_have_the_values_of_the_authors_program() {
        close(mean(&uniform(0.0, 1.0, 0.0), &uniform(0.0, 0.0, 1.0)), 1.0);
        close(mean(&uniform(1.0, 1.0, 1.0), &uniform(0.0, 0.0, 0.0)), 0.967_397);
        close(mean(&uniform(0.5, 0.5, 0.5), &uniform(0.55, 0.5, 0.5)), 0.123_663);
        close(mean(&uniform(0.2, 0.3, 0.4), &uniform(0.3, 0.3, 0.4)), 0.228_610);
    }

    #[test]
    fn an_edge_has_the_values_of_the_authors_program() {
        let flat = uniform(0.2, 0.2, 0.2);
        let mut edge = flat.clone();
        for (i, pixel) in edge.iter_mut().enumerate() {
            if i % SIZE.0 >= 20 {
                *pixel = Rgb::splat(0.6);
            }
        }
        let map = map(&flat, &edge, SIZE.0, PIXELS_PER_DEGREE);
        close(map.iter().sum::<f64>() / map.len() as f64, 0.358_139);
        let row = &map[15 * SIZE.0..];
        for (x, expected) in [(0, 0.0), (15, 0.002_079), (18, 0.343_593), (19, 0.588_854)] {
            close(row[x], expected);
        }
        for (x, expected) in [(20, 0.732_018), (21, 0.774_261), (25, 0.699_780), (39, 0.622_307)] {
            close(row[x], expected);
        }
    }

    #[test]
    fn equal_pictures_do_not_differ_and_order_does_not_matter() {
        let (a, b) = (pattern(0), pattern(1));
        assert_eq!(mean(&a, &a), 0.0);
        assert!((mean(&a, &b) - mean(&b, &a)).abs() < 1e-12);
    }
}
