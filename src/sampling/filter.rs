//! The pixel reconstruction filter h(p), importance-sampled.
//!
//! Sample positions in a pixel have density h, so every sample has the same weight and affects one
//! pixel only, and a constant scene gives that constant under every filter.

use std::f64::consts::PI;

use crate::fault::fault;

use crate::names::named_enum;

use super::{DiscreteDistribution, cos, exp};

/// The kind of a pixel filter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FilterKind {
    /// Constant up to the radius.
    #[default]
    Box,
    /// Falls linearly to 0 at the radius.
    Tent,
    /// A Gaussian cut off at the radius, where it has fallen to three standard deviations.
    Gaussian,
    /// The 4-term Blackman-Harris window (Harris 1978, table 1, minimum 92 dB).
    BlackmanHarris,
}

named_enum! {
    FilterKind {
        Box = "box",
        Tent = "tent",
        Gaussian = "gaussian",
        BlackmanHarris = "blackman-harris",
    }
}

/// A separable filter of a given radius, prepared for sampling.
#[derive(Clone, Debug)]
pub struct Filter {
    profile: Profile,
    radius: f64,
}

/// The filter's profile along one axis, over `[-1, 1]`.
#[derive(Clone, Debug)]
enum Profile {
    Box,
    Tent,
    /// The profile averaged over equal bins; sampled exactly as piecewise constant.
    Tabulated(DiscreteDistribution),
}

const BINS: usize = 1024;

impl Filter {
    /// Creates a filter that is 0 beyond `radius` pixels from the pixel's centre, along each axis.
    pub fn new(kind: FilterKind, radius: f64) -> Self {
        let bins = |shape: fn(f64) -> f64| {
            let centers = (0..BINS).map(|i| (i as f64 + 0.5) / BINS as f64 * 2.0 - 1.0);
            DiscreteDistribution::new(centers.map(shape))
                .expect("a window function is positive inside")
        };
        let profile = match kind {
            FilterKind::Box => Profile::Box,
            FilterKind::Tent => Profile::Tent,
            FilterKind::Gaussian => Profile::Tabulated(bins(|x| exp(-4.5 * x * x))),
            FilterKind::BlackmanHarris => Profile::Tabulated(bins(blackman_harris)),
        };
        Self { profile, radius }
    }

    /// Samples an offset from the pixel's centre, in pixels.
    pub fn sample(&self, u: [f64; 2]) -> [f64; 2] {
        u.map(|u| self.profile.sample(u) * self.radius)
    }

    /// Returns the radius of a box filter; `None` for other filters. [`Self::sample`] then equals
    /// [`sample_box`] of either number, times the radius.
    pub fn box_radius(&self) -> Option<f64> {
        matches!(self.profile, Profile::Box).then_some(self.radius)
    }

    /// Returns the pdf of [`Self::sample`], per square pixel.
    pub fn pdf(&self, offset: [f64; 2]) -> f64 {
        let scale = if fault!(FilterNotNormalized) { 1.0 } else { self.radius };
        offset.into_iter().map(|x| self.profile.pdf(x / self.radius) / scale).product()
    }

    /// Returns the `u` that maps to an offset.
    pub fn invert(&self, offset: [f64; 2]) -> [f64; 2] {
        offset.map(|x| self.profile.invert(x / self.radius))
    }
}

/// Samples a position in a box from -1 to 1.
#[inline(always)]
pub fn sample_box(u: f64) -> f64 {
    2.0 * u - 1.0
}

impl Profile {
    fn sample(&self, u: f64) -> f64 {
        match self {
            Self::Box => sample_box(u),
            Self::Tent if u < 0.5 => (2.0 * u).sqrt() - 1.0,
            Self::Tent => 1.0 - (2.0 - 2.0 * u).sqrt(),
            Self::Tabulated(bins) => {
                let bin = bins.sample(u);
                (bin as f64 + bins.remap(bin, u)) / BINS as f64 * 2.0 - 1.0
            }
        }
    }

    fn pdf(&self, x: f64) -> f64 {
        if x.abs() > 1.0 {
            return 0.0;
        }
        match self {
            Self::Box => 0.5,
            Self::Tent => 1.0 - x.abs(),
            Self::Tabulated(bins) => bins.pmf(bin_index(x)) * BINS as f64 / 2.0,
        }
    }

    fn invert(&self, x: f64) -> f64 {
        match self {
            Self::Box => (x + 1.0) / 2.0,
            Self::Tent if x < 0.0 => (x + 1.0) * (x + 1.0) / 2.0,
            Self::Tent => 1.0 - (1.0 - x) * (1.0 - x) / 2.0,
            Self::Tabulated(bins) => {
                let bin = bin_index(x);
                let cumulative: f64 = (0..bin).map(|i| bins.pmf(i)).sum();
                let fraction = (x + 1.0) / 2.0 * BINS as f64 - bin as f64;
                cumulative + fraction * bins.pmf(bin)
            }
        }
    }
}

fn bin_index(x: f64) -> usize {
    (((x + 1.0) / 2.0 * BINS as f64) as usize).min(BINS - 1)
}

fn blackman_harris(x: f64) -> f64 {
    let angle = PI * (x + 1.0);
    0.358_75 - 0.488_29 * cos(angle) + 0.141_28 * cos(2.0 * angle) - 0.011_68 * cos(3.0 * angle)
}

#[cfg(test)]
mod tests {
    use super::*;

    const KINDS: [FilterKind; 4] =
        [FilterKind::Box, FilterKind::Tent, FilterKind::Gaussian, FilterKind::BlackmanHarris];

    #[test]
    fn inverting_a_sample_gives_its_numbers_back() {
        for kind in KINDS {
            let filter = Filter::new(kind, 1.5);
            for i in 0..50 {
                let u = [(f64::from(i) + 0.5) / 50.0, (f64::from(i * 7 % 50) + 0.5) / 50.0];
                let back = filter.invert(filter.sample(u));
                assert!((back[0] - u[0]).abs() < 1e-9 && (back[1] - u[1]).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn offsets_stay_within_the_radius_and_are_symmetric() {
        for kind in KINDS {
            let filter = Filter::new(kind, 2.0);
            let left = filter.sample([0.1, 0.5])[0];
            let right = filter.sample([0.9, 0.5])[0];
            assert!((left + right).abs() < 1e-9);
            assert!(filter.sample([0.0, 1.0 - f64::EPSILON]).iter().all(|x| x.abs() <= 2.0));
        }
    }

    #[test]
    fn a_density_has_the_shape_of_its_name() {
        for (kind, at_half, at_edge) in [
            (FilterKind::Box, 1.0, 1.0),
            (FilterKind::Tent, 0.5, 0.0),
            (FilterKind::Gaussian, (-1.125f64).exp(), (-4.5f64).exp()),
            (FilterKind::BlackmanHarris, 0.217_47, 6e-5),
        ] {
            let filter = Filter::new(kind, 2.0);
            // Within a bin the density is constant.
            let ratio = |x: f64| filter.pdf([0.0, x]) / filter.pdf([0.0, 0.0]);
            for (x, expected) in [(1.0, at_half), (-1.0, at_half), (2.0, at_edge), (-2.0, at_edge)]
            {
                assert!((ratio(x) - expected).abs() < 5e-3, "{kind:?} at {x}: {}", ratio(x));
            }
            assert_eq!([2.001, -2.001].map(ratio), [0.0; 2], "{kind:?} ends at its radius");
        }
        let boxes = [0.25, 3.0].map(|radius| Filter::new(FilterKind::Box, radius));
        assert_eq!(boxes[0].pdf([0.1, -0.2]), 4.0);
        assert_eq!(boxes.map(|filter| filter.box_radius()), [Some(0.25), Some(3.0)]);
        assert!(Filter::new(FilterKind::Tent, 1.0).box_radius().is_none());
    }
}
