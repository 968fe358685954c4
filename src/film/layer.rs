//! The layers that a film sums for every pixel.

use crate::color::{PathRadiance, Rgb, VisibleSurface};
use crate::names::named_enum;

use super::exact_sum::{U192, step_for_exponent};

/// A layer whose pixels are means over their samples.
///
/// To add one, add a variant, complete the matches that the compiler reports, and give
/// [`PathRadiance`] or [`VisibleSurface`] a field that the integrators fill in. A film without the
/// layer has no cost. A quantity that is not a mean, such as the id at a pixel's centre, is not a
/// film layer: it does not depend on the samples and can be computed when the picture is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Layer {
    /// Emission and environment seen by the camera, and light scattered once.
    Direct,
    /// All other light.
    Indirect,
    /// Fraction of the pixel covered by surfaces.
    Alpha,
    /// The directly visible emission, a part of direct light.
    Emission,
    /// Colour of the first surface.
    Albedo,
    /// Normal of the first surface.
    Normal,
    /// Distance to the first surface along the camera ray, summed over the samples that hit one.
    Depth,
    /// Position on the first surface, summed over the samples that hit one.
    Position,
    /// Colour of the first surface that is no mirror or smooth glass, as seen in those.
    DenoisingAlbedo,
    /// Normal of that surface.
    DenoisingNormal,
    /// Number of samples whose first hit is each sphere. Has no channels: its counts are stored
    /// separately.
    Coverage,
}

named_enum! {
    Layer {
        Direct = "direct",
        Indirect = "indirect",
        Alpha = "alpha",
        Emission = "emission",
        Albedo = "albedo",
        Normal = "normal",
        Depth = "depth",
        Position = "position",
        DenoisingAlbedo = "denoising_albedo",
        DenoisingNormal = "denoising_normal",
        Coverage = "coverage",
    }
}

impl Layer {
    /// Every layer.
    pub const ALL: &[Self] = &[
        Self::Direct,
        Self::Indirect,
        Self::Alpha,
        Self::Emission,
        Self::Albedo,
        Self::Normal,
        Self::Depth,
        Self::Position,
        Self::DenoisingAlbedo,
        Self::DenoisingNormal,
        Self::Coverage,
    ];

    /// Number of channels, up to three.
    pub fn channels(self) -> usize {
        match self {
            Self::Coverage => 0,
            Self::Alpha | Self::Depth => 1,
            Self::Direct
            | Self::Indirect
            | Self::Emission
            | Self::Albedo
            | Self::Normal
            | Self::Position
            | Self::DenoisingAlbedo
            | Self::DenoisingNormal => 3,
        }
    }

    /// Returns true if the layer depends on the first visible surface, which integrators record
    /// only on request.
    pub fn uses_visible_surface(self) -> bool {
        match self {
            Self::Direct | Self::Indirect | Self::Alpha => false,
            Self::Emission
            | Self::Albedo
            | Self::Normal
            | Self::Depth
            | Self::Position
            | Self::DenoisingAlbedo
            | Self::DenoisingNormal
            | Self::Coverage => true,
        }
    }

    /// Returns true if a pixel's value is the mean over the samples that hit a surface.
    pub(super) fn is_hit_mean(self) -> bool {
        matches!(self, Self::Depth | Self::Position)
    }

    /// Returns the exponent of the steps in which a block is summed.
    pub(super) fn step(self, scale: RadianceScale) -> i32 {
        step_for_exponent::<i128>(match self {
            Self::Direct | Self::Indirect | Self::Emission => scale.exponent + HEADROOM,
            // Fractions of 1, and coordinates of unit vectors.
            Self::Alpha
            | Self::Albedo
            | Self::Normal
            | Self::DenoisingAlbedo
            | Self::DenoisingNormal => HEADROOM,
            // Sixteen times the largest coordinate; the steps are 2^-38.
            Self::Depth | Self::Position => 60,
            Self::Coverage => 0,
        })
    }

    /// Returns true if a sample's value is finite.
    pub(super) fn is_finite(
        self,
        radiance: &PathRadiance,
        surface: Option<&VisibleSurface>,
    ) -> bool {
        let surface = surface.unwrap_or(&VisibleSurface::NONE);
        match self {
            Self::Direct => radiance.direct.is_finite(),
            Self::Indirect => radiance.indirect.is_finite(),
            Self::Alpha => radiance.alpha.is_finite(),
            Self::Emission => surface.emission.is_finite(),
            Self::Albedo => surface.albedo.is_finite(),
            Self::Normal => surface.normal.is_finite(),
            Self::Depth => surface.distance.is_finite(),
            Self::Position => surface.position.is_finite(),
            Self::DenoisingAlbedo => surface.denoising_albedo.is_finite(),
            Self::DenoisingNormal => surface.denoising_normal.is_finite(),
            Self::Coverage => true,
        }
    }

    /// Adds each pixel's samples, in order, to its running sums; `sums` are the planes of the
    /// layer's channels.
    pub(super) fn add(self, sums: &mut [f64], runs: &[SampleRun<'_>]) {
        let (radiance, surface) = (SampleRun::radiance, SampleRun::visible_surfaces);
        // The layer is matched outside of the loops.
        match self {
            Self::Direct => add_all(sums, runs, radiance, |radiance| rgb_to_f64(radiance.direct)),
            Self::Indirect => {
                add_all(sums, runs, radiance, |radiance| rgb_to_f64(radiance.indirect))
            }
            Self::Alpha => add_all(sums, runs, radiance, |radiance| [f64::from(radiance.alpha)]),
            Self::Emission => add_all(sums, runs, surface, |surface| rgb_to_f64(surface.emission)),
            Self::Albedo => add_all(sums, runs, surface, |surface| rgb_to_f64(surface.albedo)),
            Self::Normal => add_all(sums, runs, surface, |surface| rgb_to_f64(surface.normal)),
            Self::Depth => add_all(sums, runs, surface, |surface| [f64::from(surface.distance)]),
            Self::Position => add_all(sums, runs, surface, |surface| rgb_to_f64(surface.position)),
            Self::DenoisingAlbedo => {
                add_all(sums, runs, surface, |surface| rgb_to_f64(surface.denoising_albedo));
            }
            Self::DenoisingNormal => {
                add_all(sums, runs, surface, |surface| rgb_to_f64(surface.denoising_normal));
            }
            Self::Coverage => {}
        }
    }
}

/// Consecutive samples of a pixel.
#[derive(Clone, Copy, Debug, Default)]
pub struct SampleRun<'a> {
    /// Radiance of each sample.
    pub radiance: &'a [PathRadiance],
    /// First visible surface of each sample; empty if no layer needs it.
    pub visible_surfaces: &'a [VisibleSurface],
}

impl<'a> SampleRun<'a> {
    fn radiance(&self) -> &'a [PathRadiance] {
        self.radiance
    }

    fn visible_surfaces(&self) -> &'a [VisibleSurface] {
        self.visible_surfaces
    }

    pub(super) fn len(&self) -> usize {
        self.radiance.len()
    }

    pub(super) fn is_empty(&self) -> bool {
        self.radiance.is_empty()
    }

    /// Splits into the first `count` samples and the rest.
    pub fn split_at(&self, count: usize) -> (Self, Self) {
        let (radiance, other_radiance) = self.radiance.split_at(count);
        let (surface, other_surfaces) =
            self.visible_surfaces.split_at(count.min(self.visible_surfaces.len()));
        (
            Self { radiance, visible_surfaces: surface },
            Self { radiance: other_radiance, visible_surfaces: other_surfaces },
        )
    }
}

fn rgb_to_f64(values: Rgb) -> [f64; 3] {
    values.to_array().map(f64::from)
}

fn add_all<'a, S: 'a, const CHANNELS: usize>(
    sums: &mut [f64],
    runs: &[SampleRun<'a>],
    samples: impl Fn(&SampleRun<'a>) -> &'a [S],
    channels: impl Fn(&S) -> [f64; CHANNELS],
) {
    let pixels = runs.len();
    for (pixel, run) in runs.iter().enumerate() {
        let mut running: [f64; CHANNELS] =
            std::array::from_fn(|channel| sums[channel * pixels + pixel]);
        for sample in samples(run) {
            let values = channels(sample);
            for channel in 0..CHANNELS {
                running[channel] += values[channel];
            }
        }
        for channel in 0..CHANNELS {
            sums[channel * pixels + pixel] = running[channel];
        }
    }
}

/// Headroom of a block above the brightest light of the scene, as a power of two: 2^30 for each of
/// its 16 samples. (A sample exceeds the lights where its path weight is above 1, because a light
/// was sampled with a small probability.)
pub(super) const HEADROOM: i32 = 34;

/// The magnitude of a scene's radiance: the power of two above its brightest light.
///
/// A block of light is rounded to steps of `2^(brightest + 34 - 98)`, that is of 2^-64 of the
/// brightest light, once for 16 samples. So the error of a pixel's mean is at most 2^-69 of that
/// light. All 24 bits of an f32 are correct down to 2^-45 of the brightest light: 3e-14 next to an
/// emitter of radiance 1, or 1e-6 next to the sun's disc of 4e7 W/(sr m^2).
///
/// The squares of blocks of the beauty, which is the sum of two layers, are summed in steps of
/// `2^(2 brightest + 70 - 163)`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(try_from = "i32", into = "i32")]
pub struct RadianceScale {
    exponent: i32,
}

impl From<RadianceScale> for i32 {
    fn from(scale: RadianceScale) -> Self {
        scale.exponent
    }
}

impl TryFrom<i32> for RadianceScale {
    type Error = &'static str;

    fn try_from(exponent: i32) -> Result<Self, Self::Error> {
        Self::from_exponent(exponent).ok_or("no radiance has this exponent")
    }
}

impl RadianceScale {
    /// Creates the scale for lights up to this radiance in any channel; finite, not negative.
    pub fn from_max_radiance(radiance: f32) -> Self {
        debug_assert!(radiance >= 0.0 && radiance.is_finite());
        let bits = f64::from(radiance).to_bits();
        let exponent = (bits >> 52) as i32 - 1023;
        let is_power = bits & ((1 << 52) - 1) == 0;
        // No lights: any scale is exact.
        let brightest = if radiance > 0.0 { exponent + i32::from(!is_power) } else { 0 };
        Self { exponent: brightest }
    }

    /// Creates the scale from [`Self::exponent`], as stored in files; `None` if no radiance has it.
    pub fn from_exponent(exponent: i32) -> Option<Self> {
        (-149..=128).contains(&exponent).then_some(Self { exponent })
    }

    /// Returns the exponent: the brightest light is at most `2^exponent`.
    pub fn exponent(self) -> i32 {
        self.exponent
    }

    /// Returns the exponent of the steps in which squares are summed.
    pub(super) fn square_step(self) -> i32 {
        step_for_exponent::<U192>(2 * (self.exponent + HEADROOM + 1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scale_is_the_power_of_two_above() {
        let exponent = |radiance| RadianceScale::from_max_radiance(radiance).exponent();
        assert_eq!([1.0, 1.01, 2.0, 14.0, 0.5, 0.0].map(exponent), [0, 1, 1, 4, -1, 0]);
        assert_eq!(exponent(f32::MAX), 128);
        assert_eq!(exponent(f32::from_bits(1)), -149);
        for exponent in [-149, 0, 128] {
            assert_eq!(
                RadianceScale::from_exponent(exponent).map(RadianceScale::exponent),
                Some(exponent)
            );
        }
        assert_eq!(RadianceScale::from_exponent(129), None);
    }

    #[test]
    fn steps_are_as_the_documentation_says() {
        let scale = RadianceScale::from_max_radiance(8.0);
        assert_eq!(Layer::Direct.step(scale), 3 - 64);
        assert_eq!(Layer::Alpha.step(scale), -64);
        assert_eq!(scale.square_step(), 2 * 3 + 70 - 163);
    }
}
