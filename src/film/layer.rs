//! What is summed for every pixel.

use crate::color::Radiance;

use super::fixed::{Wide, step_below};

/// A layer whose pixels are means over their samples.
///
/// To add one, add a variant, let the compiler find its places below, and give [`Radiance`] the value
/// that an integrator fills in. A film without the layer spends nothing on it. What is not a mean, such
/// as the id at a pixel's centre, is no layer of the film: it does not depend on the samples and can
/// be computed when the picture is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Layer {
    /// Emission and background seen by the camera, and light scattered once.
    Direct,
    /// All other light.
    Indirect,
    /// The share of the pixel that something covers.
    Alpha,
}

impl Layer {
    /// Every layer there is.
    pub const ALL: &[Self] = &[Self::Direct, Self::Indirect, Self::Alpha];

    /// The name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Direct => "direct",
            Self::Indirect => "indirect",
            Self::Alpha => "alpha",
        }
    }

    /// How many numbers a pixel has, up to three.
    pub fn channels(self) -> usize {
        match self {
            Self::Direct | Self::Indirect => 3,
            Self::Alpha => 1,
        }
    }

    /// The steps in which a block is summed.
    pub(super) fn step(self, scale: Scale) -> i32 {
        step_below::<i128>(match self {
            Self::Direct | Self::Indirect => scale.brightest + HEADROOM,
            // Shares of 1.
            Self::Alpha => HEADROOM,
        })
    }

    /// A sample's value; the channels that the layer has not are 0.
    pub(super) fn of(self, sample: &Radiance) -> [f32; 3] {
        match self {
            Self::Direct => sample.direct.to_array(),
            Self::Indirect => sample.indirect.to_array(),
            Self::Alpha => [sample.alpha, 0.0, 0.0],
        }
    }

    /// Goes on with the running sums of some pixels, each by its samples in their order; `sums` are the
    /// planes of the layer's channels.
    pub(super) fn add(self, sums: &mut [f64], runs: &[&[Radiance]]) {
        // The choice of the layer stands outside of the loops.
        match self {
            Self::Direct => add_all(sums, runs, |sample| wide(Self::Direct.of(sample))),
            Self::Indirect => add_all(sums, runs, |sample| wide(Self::Indirect.of(sample))),
            Self::Alpha => add_all(sums, runs, |sample| [f64::from(sample.alpha)]),
        }
    }
}

/// Goes on with the squares of the samples' beauty.
pub(super) fn add_squares(sums: &mut [f64], runs: &[&[Radiance]]) {
    add_all(sums, runs, |sample| {
        let [direct, indirect] = [sample.direct, sample.indirect].map(|color| wide(color.into()));
        std::array::from_fn::<_, 3, _>(|axis| {
            let beauty = direct[axis] + indirect[axis];
            beauty * beauty
        })
    });
}

fn wide(values: [f32; 3]) -> [f64; 3] {
    values.map(f64::from)
}

fn add_all<const CHANNELS: usize>(
    sums: &mut [f64],
    runs: &[&[Radiance]],
    of: impl Fn(&Radiance) -> [f64; CHANNELS],
) {
    let pixels = runs.len();
    for (pixel, run) in runs.iter().enumerate() {
        let mut running: [f64; CHANNELS] =
            std::array::from_fn(|channel| sums[channel * pixels + pixel]);
        for sample in *run {
            let values = of(sample);
            for channel in 0..CHANNELS {
                running[channel] += values[channel];
            }
        }
        for channel in 0..CHANNELS {
            sums[channel * pixels + pixel] = running[channel];
        }
    }
}

/// A block may be `2^HEADROOM` times as bright as the brightest light of the scene: each of its 16
/// samples 2^30 or a thousand million times. (A sample exceeds the lights where a path has a weight
/// above 1, because light was aimed at with a small probability.)
pub(super) const HEADROOM: i32 = 34;

/// How large the values of a scene are: the power of two above its brightest light.
///
/// A block of light is rounded to steps of `2^(brightest + 34 - 98)`, that is of 2^-64 of the brightest
/// light, once for 16 samples. So the mean of a pixel is off by at most 2^-69 of that light. In f32
/// it has 24 bits; they are all right down to 2^-45 of the brightest light, which is the darkness of
/// 3e-14 beside a lamp of 1, or of 1e-6 beside the sun's disc of 4e7 W/(sr m^2).
///
/// Squares are summed in steps of `2^(2 brightest + 64 - 163)`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Scale {
    brightest: i32,
}

impl Scale {
    /// The scale for lights up to this radiance in any channel; finite, not negative.
    pub fn of_brightest(radiance: f32) -> Self {
        debug_assert!(radiance >= 0.0 && radiance.is_finite());
        let bits = f64::from(radiance).to_bits();
        let exponent = (bits >> 52) as i32 - 1023;
        let is_power = bits & ((1 << 52) - 1) == 0;
        // Nothing shines: there is nothing to be exact about.
        let brightest = if radiance > 0.0 { exponent + i32::from(!is_power) } else { 0 };
        Self { brightest }
    }

    /// From [`Self::exponent`], as files hold it; `None` where no radiance has it.
    pub fn of_exponent(exponent: i32) -> Option<Self> {
        (-149..=128).contains(&exponent).then_some(Self { brightest: exponent })
    }

    /// The brightest light is not above `2^exponent`.
    pub fn exponent(self) -> i32 {
        self.brightest
    }

    /// The steps in which squares are summed.
    pub(super) fn step_of_squares(self) -> i32 {
        step_below::<Wide>(2 * (self.brightest + HEADROOM) - 4)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scale_is_the_power_of_two_above() {
        let exponent = |radiance| Scale::of_brightest(radiance).exponent();
        assert_eq!([1.0, 1.01, 2.0, 14.0, 0.5, 0.0].map(exponent), [0, 1, 1, 4, -1, 0]);
        assert_eq!(exponent(f32::MAX), 128);
        assert_eq!(exponent(f32::from_bits(1)), -149);
        for exponent in [-149, 0, 128] {
            assert_eq!(Scale::of_exponent(exponent).map(Scale::exponent), Some(exponent));
        }
        assert_eq!(Scale::of_exponent(129), None);
    }

    #[test]
    fn steps_are_as_the_documentation_says() {
        let scale = Scale::of_brightest(8.0);
        assert_eq!(Layer::Direct.step(scale), 3 - 64);
        assert_eq!(Layer::Alpha.step(scale), -64);
        assert_eq!(scale.step_of_squares(), 2 * 3 + 64 - 163);
    }
}
