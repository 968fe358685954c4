//! Render settings as plain values: the picture's size and what is computed for each pixel. The
//! fields correspond to the keys of `[image]` and `[render]` in a scene file.

use serde::{Deserialize, Serialize};

use crate::math::Rect;
use crate::names::named_enum;

pub use crate::light::LightSamplerKind;
pub use crate::sampling::{FilterKind, Hemisphere, SamplerKind};

/// Everything besides the scene that determines the value of a sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// Image settings.
    pub image: ImageSettings,
    /// Render settings.
    pub render: RenderSettings,
}

/// `[image]`: picture size and pixel filter.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ImageSettings {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// The crop window; `None` renders the whole picture.
    pub crop: Option<Rect>,
    /// The pixel filter h(p).
    pub filter: FilterKind,
    /// Half the filter's extent in pixels.
    pub filter_radius: f64,
}

impl Default for ImageSettings {
    /// 640 x 480 pixels with a box filter of one pixel.
    fn default() -> Self {
        let filter = FilterKind::default();
        let filter_radius = Self::default_filter_radius(filter);
        Self { width: 640, height: 480, crop: None, filter, filter_radius }
    }
}

impl ImageSettings {
    /// Default radius of a filter in pixels.
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

/// `[render]`: integrator and sampling.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RenderSettings {
    /// The integrator and its options.
    pub integrator: IntegratorSettings,
    /// How `path` and `direct` sample lights.
    pub estimator: Estimator,
    /// How `path` and `direct` find light by way of polished balls. Files of versions that only
    /// had chance do not say so.
    #[serde(default = "Caustics::of_earlier_versions")]
    pub caustics: Caustics,
    /// Samples per pixel.
    pub samples_per_pixel: u32,
    /// Maximum path length in edges: 1 is directly visible emitters, 2 adds direct light. `None`:
    /// no limit.
    pub max_depth: Option<u32>,
    /// Maximum contribution of one path to a channel of indirect light, in W/(sr m^2); biased.
    /// `None`: no limit.
    pub clamp_indirect: Option<f64>,
    /// Random seed.
    pub seed: u64,
    /// The sampler for a pixel's random numbers.
    pub sampler: SamplerKind,
    /// How next-event estimation chooses a light (`light_choice`).
    pub light_choice: LightSamplerKind,
}

impl Default for RenderSettings {
    /// The integrator `path` with 64 samples per pixel.
    fn default() -> Self {
        Self {
            integrator: IntegratorSettings::Path,
            estimator: Estimator::default(),
            caustics: Caustics::default(),
            samples_per_pixel: 64,
            max_depth: None,
            clamp_indirect: None,
            seed: 0,
            sampler: SamplerKind::default(),
            light_choice: LightSamplerKind::default(),
        }
    }
}

/// An integrator with its options.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "kebab-case", deny_unknown_fields)]
pub enum IntegratorSettings {
    /// `"path"`: path tracing.
    Path,
    /// `"direct"`: path tracing limited to emission and direct light.
    Direct,
    /// `"ambient-occlusion"`: the openness of each point.
    AmbientOcclusion {
        /// Maximum distance of occluders; `None`: no limit.
        distance: Option<f64>,
    },
    /// `"normals"`: surface normals as colours.
    Normals,
    /// `"paper"`: the paper's integrator, which finds emitters by hemisphere sampling.
    Paper(PaperSettings),
    /// `"raycast"`: one ray and a shading model, the paper's starting point.
    Raycast {
        /// True if emitters cast shadows.
        shadows: bool,
    },
}

/// How lights are sampled. All estimators have the same mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Estimator {
    /// `"mis"`: next-event estimation and BSDF sampling, combined by multiple importance sampling.
    #[default]
    Mis,
    /// `"light"`: next-event estimation only, wherever it is possible.
    Light,
    /// `"bsdf"`: BSDF sampling only.
    Bsdf,
}

named_enum! { Estimator { Mis = "mis", Light = "light", Bsdf = "bsdf" } }

/// How light is found that reaches a surface by way of a polished ball. Both have the same mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Caustics {
    /// `"connect"`: paths are also connected to lights over mirror, metal and glass balls, in
    /// closed form; see [`crate::light::specular`].
    #[default]
    Connect,
    /// `"chance"`: only where BSDF sampling leads over the ball to the light.
    Chance,
}

impl Caustics {
    fn of_earlier_versions() -> Self {
        Self::Chance
    }
}

named_enum! { Caustics { Connect = "connect", Chance = "chance" } }

/// `[render.paper]`: options of the integrator `paper`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PaperSettings {
    /// Sub-pixels along each side of a pixel, k.
    pub subpixels: u32,
    /// Paths per sub-pixel, N.
    pub samples: u32,
    /// How hemisphere directions are sampled.
    pub hemisphere: Hemisphere,
    /// When a path ends.
    pub stop: PathTermination,
    /// Treatment of camera rays that miss all spheres.
    pub miss: MissPolicy,
    /// Jitter within a sub-pixel: 1 covers it, 0 stays at its centre.
    pub jitter: f64,
}

impl Default for PaperSettings {
    /// The paper's values: 2 x 2 sub-pixels with 4 paths each.
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
    /// Samples per pixel: k^2 N.
    pub fn samples_per_pixel(&self) -> u64 {
        u64::from(self.subpixels).pow(2).saturating_mul(u64::from(self.samples))
    }
}

/// When a path ends, besides `max_depth`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PathTermination {
    /// Russian roulette: unbiased.
    #[default]
    Roulette,
    /// Only at `max_depth`: biased by the light of longer paths.
    Depth,
    /// When the largest component of the throughput falls below this value: biased.
    Threshold(f64),
}

/// The path termination rules, without thresholds.
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
    /// The type of this rule.
    pub fn kind(&self) -> PathTerminationKind {
        match self {
            Self::Roulette => PathTerminationKind::Roulette,
            Self::Depth => PathTerminationKind::Depth,
            Self::Threshold(_) => PathTerminationKind::Threshold,
        }
    }
}

/// Treatment of camera rays that miss all spheres.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MissPolicy {
    /// The ray sees the background.
    #[default]
    Background,
    /// The ray is sampled again, as the paper's text says: biased at silhouettes.
    Redraw,
}

named_enum! { MissPolicy { Background = "background", Redraw = "redraw" } }

/// The integrators, without options.
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
    /// The type of this integrator.
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
