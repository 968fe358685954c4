//! Describes the difference between two images of one render.

use std::cmp::Ordering;
use std::collections::BTreeSet;
use std::fmt::Write;

use crate::film::Film;
use crate::image_io::RawChannel;

/// Minimum samples per pixel. Fewer make fewer than two blocks, which have no spread.
const MIN_SAMPLES: u32 = 32;

/// Describes the difference between two display images, in 8-bit steps.
pub fn describe_in_steps(original: &[RawChannel], reproduced: &[RawChannel]) -> String {
    let (mut max_steps, mut pixels) = (0, BTreeSet::new());
    for (original, reproduced) in original.iter().zip(reproduced) {
        for (pixel, (a, b)) in original.bits.iter().zip(&reproduced.bits).enumerate() {
            if a != b {
                pixels.insert(pixel);
                // 8-bit values are stored times 257.
                max_steps = max_steps.max(a.abs_diff(*b) / 257);
            }
        }
    }
    format!("{} pixels differ, by up to {max_steps} of 255 steps\n", pixels.len())
}

/// Differences in the beauty of two linear images.
#[derive(Default)]
struct Differences {
    values: usize,
    largest: MaxDifference,
    /// Sums over the values with a known error: of differences, and of the variances of those.
    difference: f64,
    variance: f64,
    /// Largest difference, in standard errors.
    worst: MaxDifference,
    /// Number of values that differ but have no known error.
    unknown_errors: usize,
}

/// The largest of several numbers, with its pixel.
#[derive(Clone, Copy, Default)]
struct MaxDifference {
    value: f64,
    pixel: usize,
}

impl MaxDifference {
    fn update(&mut self, value: f64, pixel: usize) {
        // NaN counts as larger.
        let is_larger = value.partial_cmp(&self.value).is_none_or(Ordering::is_gt);
        if is_larger && !self.value.is_nan() {
            *self = Self { value, pixel };
        }
    }

    fn describe_position(self, width: usize) -> String {
        format!("in column {}, row {}", self.pixel % width, self.pixel / width)
    }
}

/// Describes the difference of the beauty, in units of the standard error of both images; in
/// absolute terms where that is unknown.
pub fn describe_in_standard_errors(
    original: &[RawChannel],
    reproduced: &[RawChannel],
    film: &Film,
) -> String {
    let Some(differences) = compare(original, reproduced, film) else {
        return "one of the two pictures has no beauty\n".to_owned();
    };
    if differences.values == 0 {
        return "the beauty is bit-identical\n".to_owned();
    }
    let width = film.frame().window.width as usize;
    let mut text = format!("{} values of the beauty differ", differences.values);
    if differences.variance > 0.0 {
        let mean = differences.difference.abs() / differences.variance.sqrt();
        let (worst, position) =
            (differences.worst.value, differences.worst.describe_position(width));
        let _ = write!(
            text,
            "; their mean is off by {mean:.2} standard errors, and the worst, {position}, by {worst:.2}"
        );
    }
    let MaxDifference { value, .. } = differences.largest;
    let _ = write!(
        text,
        "; the largest difference is {value:.3e}, {}",
        differences.largest.describe_position(width)
    );
    if differences.unknown_errors > 0 {
        let count = match differences.unknown_errors == differences.values {
            true => "none of them".to_owned(),
            false => format!("{} of them not", differences.unknown_errors),
        };
        let reason = match film.sample_count_range().0 < MIN_SAMPLES {
            true => format!("too few samples: there must be {MIN_SAMPLES}"),
            false => "their samples do not differ".to_owned(),
        };
        let _ = write!(text, "; {count} can be judged by a standard error ({reason})");
    }
    text + "\n"
}

fn compare(original: &[RawChannel], reproduced: &[RawChannel], film: &Film) -> Option<Differences> {
    let variance = film.variance().unwrap_or_default();
    let bits = |from: &[RawChannel], name: &str| {
        from.iter().find(|channel| channel.name == name).map(|channel| channel.bits.clone())
    };
    let mut differences = Differences::default();
    for (axis, name) in ["R", "G", "B"].into_iter().enumerate() {
        let values = bits(original, name)?.into_iter().zip(bits(reproduced, name)?);
        for (pixel, (a, b)) in values.enumerate() {
            let difference = f64::from(f32::from_bits(a)) - f64::from(f32::from_bits(b));
            let variance_sum =
                2.0 * f64::from(variance.get(pixel).map_or(f32::INFINITY, |v| v[axis]));
            let is_known = variance_sum > 0.0 && variance_sum.is_finite() && difference.is_finite();
            if is_known {
                differences.difference += difference;
                differences.variance += variance_sum;
            }
            if a == b {
                continue;
            }
            differences.values += 1;
            differences.largest.update(difference.abs(), pixel);
            match is_known {
                true => differences.worst.update(difference.abs() / variance_sum.sqrt(), pixel),
                false => differences.unknown_errors += 1,
            }
        }
    }
    Some(differences)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::{PathRadiance, Rgb};
    use crate::film::{FilmFormat, FilmFrame, Layer, RadianceScale, SampleRun};

    /// Two pixels, the second with identical samples, and their image.
    fn film(samples: u32) -> (Film, Vec<RawChannel>) {
        let film = Film::new(&FilmFormat {
            frame: FilmFrame::full(2, 1),
            first_sample: 0,
            scale: RadianceScale::from_max_radiance(1.0),
            layers: vec![Layer::Direct, Layer::Indirect],
            sums_squares: true,
        });
        let film = film.expect("there is memory");
        let light = |pixel: u32, sample: u32| PathRadiance {
            direct: Rgb::splat(0.5 + (1 - pixel) as f32 * (sample / 16 % 2) as f32 * 0.1),
            ..PathRadiance::default()
        };
        let all: Vec<PathRadiance> =
            (0..2 * samples).map(|at| light(at / samples, at % samples)).collect();
        film.add(0, &[samples; 2], SampleRun { radiance: &all, visible_surfaces: &[] })
            .expect("not too bright");
        let picture = film.picture();
        let channel = |axis: usize| RawChannel {
            name: ["R", "G", "B"][axis].to_owned(),
            bits: (0..2).map(|pixel| picture.beauty(pixel)[axis].to_bits()).collect(),
        };
        (film, (0..3).map(channel).collect())
    }

    fn text_of(samples: u32, pixel: usize) -> String {
        let (film, original) = film(samples);
        let mut reproduced = original.clone();
        let value = f32::from_bits(reproduced[0].bits[pixel]) + 0.25;
        reproduced[0].bits[pixel] = value.to_bits();
        describe_in_standard_errors(&original, &reproduced, &film)
    }

    #[test]
    fn errors_that_are_not_known_are_not_told() {
        let text_of_known = text_of(64, 0);
        assert!(text_of_known.contains("1 values of the beauty differ; their mean is off by"));
        assert!(text_of_known.contains("the worst, in column 0, row 0, by "), "{text_of_known}");
        let expected = "1 values of the beauty differ; the largest difference is 2.500e-1, in column 0, row 0; \
                   none of them can be judged by a standard error (too few samples: there must be 32)\n";
        assert_eq!(text_of(16, 0), expected);
        let identical = text_of(64, 1);
        assert!(!identical.contains("inf") && !identical.contains("NaN"), "{identical}");
        assert!(identical.contains("none of them can be judged"), "{identical}");
        assert!(identical.contains("(their samples do not differ)"), "{identical}");
        let (film, original) = film(16);
        assert_eq!(
            describe_in_standard_errors(&original, &original, &film),
            "the beauty is bit-identical\n"
        );
    }
}
