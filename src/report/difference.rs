//! Describes the difference between two images of one render.

use std::cmp::Ordering;
use std::collections::BTreeSet;
use std::fmt::Write;

use crate::film::Film;
use crate::image_io::RawChannel;

/// Minimum samples per pixel. Fewer make fewer than two blocks, which have no spread.
const FEWEST: u32 = 32;

/// Describes the difference between two display images, in 8-bit steps.
pub fn in_steps(then: &[RawChannel], now: &[RawChannel]) -> String {
    let (mut most, mut pixels) = (0, BTreeSet::new());
    for (then, now) in then.iter().zip(now) {
        for (pixel, (a, b)) in then.bits.iter().zip(&now.bits).enumerate() {
            if a != b {
                pixels.insert(pixel);
                // 8-bit values are stored times 257.
                most = most.max(a.abs_diff(*b) / 257);
            }
        }
    }
    format!("{} pixels differ, by up to {most} of 255 steps\n", pixels.len())
}

/// Differences in the beauty of two linear images.
#[derive(Default)]
struct Differences {
    values: usize,
    largest: Worst,
    /// Sums over the values with a known error: of differences, and of the variances of those.
    difference: f64,
    variance: f64,
    /// Largest difference, in standard errors.
    worst: Worst,
    /// Number of values that differ but have no known error.
    unjudged: usize,
}

/// The largest of several numbers, with its pixel.
#[derive(Clone, Copy, Default)]
struct Worst {
    value: f64,
    pixel: usize,
}

impl Worst {
    fn see(&mut self, value: f64, pixel: usize) {
        // NaN counts as larger.
        let is_more = value.partial_cmp(&self.value).is_none_or(Ordering::is_gt);
        if is_more && !self.value.is_nan() {
            *self = Self { value, pixel };
        }
    }

    fn place(self, width: usize) -> String {
        format!("in column {}, row {}", self.pixel % width, self.pixel / width)
    }
}

/// Describes the difference of the beauty, in units of the standard error of both images; in
/// absolute terms where that is unknown.
pub fn in_standard_errors(then: &[RawChannel], now: &[RawChannel], film: &Film) -> String {
    let Some(found) = compared(then, now, film) else {
        return "one of the two has no beauty\n".to_owned();
    };
    if found.values == 0 {
        return "the beauty agrees to the bit\n".to_owned();
    }
    let width = film.frame().window.width as usize;
    let mut words = format!("{} values of the beauty differ", found.values);
    if found.variance > 0.0 {
        let mean = found.difference.abs() / found.variance.sqrt();
        let (worst, place) = (found.worst.value, found.worst.place(width));
        let _ = write!(
            words,
            "; their mean is off by {mean:.2} standard errors, and the worst, {place}, by {worst:.2}"
        );
    }
    let Worst { value, .. } = found.largest;
    let _ =
        write!(words, "; the largest difference is {value:.3e}, {}", found.largest.place(width));
    if found.unjudged > 0 {
        let which = match found.unjudged == found.values {
            true => "none of them".to_owned(),
            false => format!("{} of them not", found.unjudged),
        };
        let reason = match film.sample_count_range().0 < FEWEST {
            true => format!("too few samples: there must be {FEWEST}"),
            false => "their samples do not differ".to_owned(),
        };
        let _ = write!(words, "; {which} can be judged by a standard error ({reason})");
    }
    words + "\n"
}

fn compared(then: &[RawChannel], now: &[RawChannel], film: &Film) -> Option<Differences> {
    let variance = film.variance().unwrap_or_default();
    let bits = |from: &[RawChannel], name: &str| {
        from.iter().find(|channel| channel.name == name).map(|channel| channel.bits.clone())
    };
    let mut found = Differences::default();
    for (axis, name) in ["R", "G", "B"].into_iter().enumerate() {
        let values = bits(then, name)?.into_iter().zip(bits(now, name)?);
        for (pixel, (a, b)) in values.enumerate() {
            let off = f64::from(f32::from_bits(a)) - f64::from(f32::from_bits(b));
            let of_both = 2.0 * f64::from(variance.get(pixel).map_or(f32::INFINITY, |v| v[axis]));
            let is_known = of_both > 0.0 && of_both.is_finite() && off.is_finite();
            if is_known {
                found.difference += off;
                found.variance += of_both;
            }
            if a == b {
                continue;
            }
            found.values += 1;
            found.largest.see(off.abs(), pixel);
            match is_known {
                true => found.worst.see(off.abs() / of_both.sqrt(), pixel),
                false => found.unjudged += 1,
            }
        }
    }
    Some(found)
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
        let (film, then) = film(samples);
        let mut now = then.clone();
        let value = f32::from_bits(now[0].bits[pixel]) + 0.25;
        now[0].bits[pixel] = value.to_bits();
        in_standard_errors(&then, &now, &film)
    }

    #[test]
    fn errors_that_are_not_known_are_not_told() {
        let text_of_known = text_of(64, 0);
        assert!(text_of_known.contains("1 values of the beauty differ; their mean is off by"));
        assert!(text_of_known.contains("the worst, in column 0, row 0, by "), "{text_of_known}");
        let few = "1 values of the beauty differ; the largest difference is 2.500e-1, in column 0, row 0; \
                   none of them can be judged by a standard error (too few samples: there must be 32)\n";
        assert_eq!(text_of(16, 0), few);
        let alike = text_of(64, 1);
        assert!(!alike.contains("inf") && !alike.contains("NaN"), "{alike}");
        assert!(alike.contains("none of them can be judged"), "{alike}");
        assert!(alike.contains("(their samples do not differ)"), "{alike}");
        let (film, then) = film(16);
        assert_eq!(in_standard_errors(&then, &then, &film), "the beauty agrees to the bit\n");
    }
}
