//! How a scene is rendered, as plain values: the picture's size and what is computed for each pixel.
//! These are the keys of `[image]` and `[render]` in a scene file.

use serde::{Deserialize, Serialize};

use crate::math::Rect;
use crate::names::named_enum;

pub use crate::light::LightSamplerKind;
pub use crate::sampling::{FilterKind, Hemisphere, SamplerKind};

/// Everything that decides what a sample of a pixel is worth, beside the scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// The picture.
    pub image: ImageSettings,
    /// The light.
    pub render: RenderSettings,
}

/// `[image]`: the picture's size and the pixel's weight function.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ImageSettings {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// The part that is rendered; `None` is all of it.
    pub crop: Option<Rect>,
    /// The pixel's weight h(p).
    pub filter: FilterKind,
    /// Half the filter's extent in pixels.
    pub filter_radius: f64,
}

impl Default for ImageSettings {
    /// 640 x 480 pixels, each with a box of its own size.
    fn default() -> Self {
        let filter = FilterKind::default();
        let filter_radius = Self::default_filter_radius(filter);
        Self { width: 640, height: 480, crop: None, filter, filter_radius }
    }
}

impl ImageSettings {
    /// The radius of a filter where none is given, in pixels.
    pub fn default_filter_radius(filter: FilterKind) -> f64 {
        match filter {
            FilterKind::Box => 0.5,
            FilterKind::Tent => 1.0,
            FilterKind::Gaussian => 1.5,
            FilterKind::BlackmanHarris => 2.0,
        }
    }

    /// The part of the picture that is rendered.
    pub fn pixel_bounds(&self) -> Rect {
        let Self { width, height, .. } = *self;
        self.crop.unwrap_or(Rect { x: 0, y: 0, width, height })
    }
}

/// `[render]`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RenderSettings {
    /// `integrator`, with the keys of its own table.
    pub integrator: IntegratorSettings,
    /// How lights are found by `path` and `direct`.
    pub estimator: Estimator,
    /// Samples of each pixel.
    pub samples_per_pixel: u32,
    /// The longest path, in edges: 1 is lamps seen directly, 2 direct light. `None`: no limit.
    pub max_depth: Option<u32>,
    /// The most that one path may add to a channel of indirect light, in W/(sr m^2): biased.
    /// `None`: no limit.
    pub clamp_indirect: Option<f64>,
    /// Chooses the random numbers.
    pub seed: u64,
    /// How random numbers are spread over a pixel's samples.
    pub sampler: SamplerKind,
    /// `light_choice`: which lamp a point aims at.
    pub light_choice: LightSamplerKind,
}

impl Default for RenderSettings {
    /// The integrator `path` with 64 samples of each pixel.
    fn default() -> Self {
        Self {
            integrator: IntegratorSettings::Path,
            estimator: Estimator::default(),
            samples_per_pixel: 64,
            max_depth: None,
            clamp_indirect: None,
            seed: 0,
            sampler: SamplerKind::default(),
            light_choice: LightSamplerKind::default(),
        }
    }
}

/// The estimators.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "kebab-case", deny_unknown_fields)]
pub enum IntegratorSettings {
    /// `"path"`: next-event estimation and hemisphere sampling, combined.
    Path,
    /// `"direct"`: the same for light that was scattered once at most.
    Direct,
    /// `"ambient-occlusion"`: how open each point is.
    AmbientOcclusion {
        /// How near things must be to count; `None`: no limit.
        distance: Option<f64>,
    },
    /// `"normals"`: the normals as colours.
    Normals,
    /// `"paper"`: the paper's own, lamps found by chance.
    Paper(PaperSettings),
    /// `"raycast"`: one ray and a shading model, the paper's starting point.
    Raycast {
        /// Whether lamps cast shadows.
        shadows: bool,
    },
}

/// How lights are found. All give the same mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Estimator {
    /// `"mis"`: aimed at and met by chance, combined by multiple importance sampling.
    #[default]
    Mis,
    /// `"light"`: aimed at only, where they can be.
    Light,
    /// `"bsdf"`: met by chance only.
    Bsdf,
}

named_enum! { Estimator { Mis = "mis", Light = "light", Bsdf = "bsdf" } }

/// `[render.paper]`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PaperSettings {
    /// Sub-pixels along each side of a pixel, k.
    pub subpixels: u32,
    /// Paths of each sub-pixel, N.
    pub samples: u32,
    /// How directions over the hemisphere are drawn.
    pub hemisphere: Hemisphere,
    /// When a path ends.
    pub stop: PathTermination,
    /// What becomes of a camera ray that meets nothing.
    pub miss: MissPolicy,
    /// The size of the random shift in a sub-pixel: 1 covers it, 0 stays at its centre.
    pub jitter: f64,
}

impl Default for PaperSettings {
    /// The paper's own: 2 x 2 sub-pixels of 4 paths.
    fn default() -> Self {
        Self {
            subpixels: 2,
            samples: 4,
            hemisphere: Hemisphere::default(),
            stop: PathTermination::default(),
            miss: MissPolicy::default(),
            jitter: 1.0,
        }
    }
}

impl PaperSettings {
    /// Samples of a pixel: k^2 N.
    pub fn samples_per_pixel(&self) -> u64 {
        u64::from(self.subpixels).pow(2).saturating_mul(u64::from(self.samples))
    }
}

/// When a path ends, beside `max_depth`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PathTermination {
    /// Russian roulette: unbiased.
    #[default]
    Roulette,
    /// At `max_depth` only: biased by what longer paths carry.
    Depth,
    /// When the largest component of the path's weight falls below this: biased.
    Threshold(f64),
}

/// The ways to end a path, without their thresholds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PathTerminationKind {
    /// [`PathTermination::Roulette`].
    #[default]
    Roulette,
    /// [`PathTermination::Depth`].
    Depth,
    /// [`PathTermination::Threshold`].
    Threshold,
}

named_enum! { PathTerminationKind { Roulette = "roulette", Depth = "depth", Threshold = "threshold" } }

impl PathTermination {
    /// The kind of this rule.
    pub fn kind(&self) -> PathTerminationKind {
        match self {
            Self::Roulette => PathTerminationKind::Roulette,
            Self::Depth => PathTerminationKind::Depth,
            Self::Threshold(_) => PathTerminationKind::Threshold,
        }
    }
}

/// What becomes of a camera ray that meets nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MissPolicy {
    /// It sees the background.
    #[default]
    Background,
    /// It is drawn again, as the paper's text says: biased at silhouettes.
    Redraw,
}

named_enum! { MissPolicy { Background = "background", Redraw = "redraw" } }

/// The integrators without their options.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum IntegratorKind {
    /// [`IntegratorSettings::Path`].
    #[default]
    Path,
    /// [`IntegratorSettings::Direct`].
    Direct,
    /// [`IntegratorSettings::AmbientOcclusion`].
    AmbientOcclusion,
    /// [`IntegratorSettings::Normals`].
    Normals,
    /// [`IntegratorSettings::Paper`].
    Paper,
    /// [`IntegratorSettings::Raycast`].
    Raycast,
}

named_enum! {
    IntegratorKind {
        Path = "path",
        Direct = "direct",
        AmbientOcclusion = "ambient-occlusion",
        Normals = "normals",
        Paper = "paper",
        Raycast = "raycast",
    }
}

impl IntegratorSettings {
    /// Which it is, without its options.
    pub fn kind(&self) -> IntegratorKind {
        match self {
            Self::Path => IntegratorKind::Path,
            Self::Direct => IntegratorKind::Direct,
            Self::AmbientOcclusion { .. } => IntegratorKind::AmbientOcclusion,
            Self::Normals => IntegratorKind::Normals,
            Self::Paper(_) => IntegratorKind::Paper,
            Self::Raycast { .. } => IntegratorKind::Raycast,
        }
    }
}
