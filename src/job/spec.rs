//! A render job as a value: what to compute, which samples of which pixels, when to stop, and how.

use std::ops::Range;
use std::time::Duration;

use serde::{Deserialize, Serialize};

use crate::accel::{BackendChoice, BuildQuality};
use crate::error::{Error, Result, Suggestion};
use crate::film::{Aov, BLOCK_SIZE, Layer};
use crate::sampling::SamplerKind;
use crate::scene::Settings;
use crate::scene::settings::{ImageSettings, IntegratorSettings, PaperSettings, RenderSettings};

use super::metadata::set_sample_count;
use super::noise::NoiseTarget;

/// Samples per pixel of a render that only its time limit ends: more than any render reaches, in
/// whole blocks, and a multiple of all common sub-pixel counts.
pub const UNLIMITED_SAMPLES: u32 = 74_565 * 60 * 60 * BLOCK_SIZE;

/// A render job: everything besides the scene that [`run`](super::run) needs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Job {
    /// The settings that define the picture: size and crop, integrator, samples per pixel, seed.
    pub settings: Settings,
    /// Renders only these samples of every pixel. Both ends are multiples of 16, except that the
    /// range may end at the last sample. `None` means all up to
    /// `settings.render.samples_per_pixel`.
    pub samples: Option<Range<u32>>,
    /// Criteria that end the render before it has all samples.
    pub until: StopCriteria,
    /// The AOVs of the picture besides the beauty.
    pub layers: Vec<Aov>,
    /// The intersector.
    pub accel: BackendChoice,
    /// Build quality of the intersector.
    pub quality: BuildQuality,
    /// Number of threads; 0 means one per core. The picture does not depend on it.
    pub threads: usize,
}

/// Criteria that end a render before every pixel has all of its samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StopCriteria {
    /// Each tile of 16 x 16 pixels ends when it meets this target.
    pub noise: Option<NoiseTarget>,
    /// Time limit, counted over all runs of the render. Every pixel gets at least 16 samples.
    pub time: Option<Duration>,
}

impl Default for Job {
    /// 640 x 480 pixels with 64 samples each, with the fastest intersector on all cores.
    fn default() -> Self {
        Self::from_settings(Settings::default())
    }
}

impl Job {
    /// A job for all samples that these settings ask for.
    pub fn from_settings(settings: Settings) -> Self {
        Self {
            settings,
            samples: None,
            until: StopCriteria::default(),
            layers: Aov::DEFAULT.to_vec(),
            accel: BackendChoice::Auto,
            quality: BuildQuality::default(),
            threads: 0,
        }
    }

    /// A picture of this size in pixels, with 64 samples per pixel.
    pub fn with_size(width: u32, height: u32) -> Self {
        let image = ImageSettings { width, height, ..ImageSettings::default() };
        Self::from_settings(Settings { image, ..Settings::default() })
    }

    /// Sets the number of samples per pixel.
    #[must_use]
    pub fn samples_per_pixel(mut self, samples: u32) -> Self {
        self.set_samples_per_pixel(samples);
        self
    }

    /// Renders until 95 % of the values are within this fraction of their pixel's brightness, for
    /// example 0.02. At most 65536 samples per pixel, unless their number was set before.
    #[must_use]
    pub fn noise_target(mut self, error: f64) -> Self {
        self.until.noise = Some(NoiseTarget::new(error));
        match self.settings.render.samples_per_pixel {
            UNLIMITED_SAMPLES => self.samples_per_pixel(StopCriteria::DEFAULT_MAX_SAMPLES),
            _ => self.at_most_by_default(StopCriteria::DEFAULT_MAX_SAMPLES),
        }
    }

    /// Renders until this time has passed, with as many samples per pixel as that allows, unless
    /// their number was set before.
    #[must_use]
    pub fn time(mut self, time: Duration) -> Self {
        self.until.time = Some(time);
        self.at_most_by_default(UNLIMITED_SAMPLES)
    }

    /// Replaces the default number of samples per pixel by `max_samples`.
    fn at_most_by_default(self, max_samples: u32) -> Self {
        let default = RenderSettings::default().samples_per_pixel;
        let is_default = self.settings.render.samples_per_pixel == default;
        if is_default { self.samples_per_pixel(max_samples) } else { self }
    }

    /// Replaces the default AOVs by these, besides the beauty.
    #[must_use]
    pub fn aovs(mut self, layers: &[Aov]) -> Self {
        self.layers = layers.to_vec();
        self.without_repeated_layers()
    }

    /// Removes repeated layers, keeping the first of each.
    #[must_use]
    pub(super) fn without_repeated_layers(mut self) -> Self {
        let mut kept = Vec::new();
        self.layers.retain(|layer| {
            let is_new = !kept.contains(layer);
            kept.push(*layer);
            is_new
        });
        self
    }

    /// Sets the number of samples per pixel. The `paper` integrator rounds it up to whole sub-pixel
    /// grids.
    pub fn set_samples_per_pixel(&mut self, samples: u32) {
        set_sample_count(&mut self.settings, samples);
    }

    /// The samples that every pixel will have when the render is complete.
    ///
    /// # Errors
    /// If [`Self::samples`] is not a valid range for these settings.
    pub fn sample_range(&self) -> Result<Range<u32>> {
        let last = self.settings.render.samples_per_pixel;
        let Some(Range { start, end }) = self.samples.clone() else { return Ok(0..last) };
        let invalid = |reason: String, help: String| {
            Err(Error::input(format!("the samples {start}..{end} {reason}")).with_help(help))
        };
        if start >= end {
            return invalid(
                "are empty".to_owned(),
                "give the first sample and the one after the last".to_owned(),
            );
        }
        if start % BLOCK_SIZE != 0 {
            let suggestion = start / BLOCK_SIZE * BLOCK_SIZE;
            return invalid(
                format!("must start on a multiple of {BLOCK_SIZE}"),
                format!("samples are summed in blocks of {BLOCK_SIZE}; try {suggestion}..{end}"),
            );
        }
        if end > last {
            let error = invalid(
                format!("exceed the {last} samples per pixel"),
                "raise the samples per pixel".to_owned(),
            );
            return error.map_err(|error| {
                error.with_suggestion(Suggestion::SamplesPerPixel, end.to_string())
            });
        }
        if end % BLOCK_SIZE != 0 && end != last {
            let suggestion =
                end.checked_next_multiple_of(BLOCK_SIZE).map_or(last, |end| end.min(last));
            return invalid(
                format!("must end on a multiple of {BLOCK_SIZE}, or at the last sample, {last}"),
                format!("samples are summed in blocks of {BLOCK_SIZE}; try {start}..{suggestion}"),
            );
        }
        Ok(start..end)
    }

    /// Returns true if the picture has an alpha channel. `transparent` is the scene's background
    /// setting.
    pub fn has_alpha(&self, transparent: bool) -> bool {
        transparent || self.layers.contains(&Aov::Mean(Layer::Alpha))
    }

    /// Validates the job.
    ///
    /// # Errors
    /// Describes the first problem.
    pub(super) fn validate(&self) -> Result<()> {
        self.sample_range()?;
        self.until.validate(&self.settings.render)?;
        if self.until.noise.is_some() && self.samples.is_some() {
            let message = "a noise target needs all samples of a pixel, not a range of them";
            return Err(
                Error::input(message).with_help("leave out the noise target or the samples")
            );
        }
        Ok(())
    }
}

impl StopCriteria {
    /// Default maximum number of samples per pixel for a render with a noise target.
    pub const DEFAULT_MAX_SAMPLES: u32 = 65_536;

    /// Rejects samplers and sub-pixel grids that need to know the number of samples in advance.
    ///
    /// # Errors
    /// Names the unsuitable setting and an alternative.
    pub fn validate(&self, render: &RenderSettings) -> Result<()> {
        let criterion = match (self.noise, self.time) {
            (None, None) => return Ok(()),
            (Some(_), _) => "a noise target",
            (None, Some(_)) => "a time limit",
        };
        self.noise.map_or(Ok(()), NoiseTarget::validate)?;
        let reject = |reason: &str, help: &str| {
            let message = format!("{criterion} decides when to stop, but {reason}");
            Err(Error::input(message).with_help(help))
        };
        if render.sampler == SamplerKind::Stratified {
            let reason = "stratified sampling needs the number of samples in advance";
            return reject(reason, "choose the sampler `sobol` or `independent`");
        }
        // The settings are not validated yet and may hold any number.
        let fit = |cells: u32| cells > 0 && BLOCK_SIZE % cells == 0;
        match render.integrator {
            IntegratorSettings::Paper(PaperSettings { subpixels: k, .. })
                if !k.checked_pow(2).is_some_and(fit) =>
            {
                let reason = format!(
                    "{k} x {k} sub-pixels do not fit into its blocks of {BLOCK_SIZE} samples"
                );
                reject(&reason, "use 1, 2 or 4 sub-pixels along each side")
            }
            _ => Ok(()),
        }
    }

    /// Removes the time limit. The limit of one part does not apply to a merged render.
    pub fn clear_limits(&mut self) {
        self.time = None;
    }

    /// The target by which errors are reported: that of the noise, or the usual one.
    pub(super) fn reported_target(&self) -> NoiseTarget {
        // Without a target, only its confidence matters.
        self.noise.unwrap_or(NoiseTarget::new(0.01))
    }
}
