//! When a render ends, and who looks on until then.

use std::path::PathBuf;
use std::time::Duration;

use clap::{ArgGroup, Args};

use crate::color::ViewTransform;
use crate::job::{NoiseTarget, Quality, StopCriteria, UNLIMITED_SAMPLES};
use crate::scene::Override;

use super::values::{confidence, duration, named, noise, one_of};

/// When the picture is good enough.
#[derive(Args, Debug)]
pub struct StopArgs {
    /// Render each tile of 16 x 16 pixels until its relative error is below this, such as 1% or
    /// 0.01 (docs/stopping.md)
    #[arg(long, value_name = "ERROR", value_parser = noise, conflicts_with = "spp", allow_hyphen_values = true)]
    #[arg(group = "target")]
    pub noise: Option<f64>,

    /// Render each tile until its errors no longer show: preview, good or print
    /// (docs/stopping.md)
    #[arg(long, value_name = "NAME", value_parser = one_of(named::<Quality>()), conflicts_with_all = ["spp", "noise"])]
    #[arg(group = "target")]
    pub quality: Option<Quality>,

    /// The fraction of the values of each tile whose error must be below --noise
    #[arg(long, value_name = "SHARE", value_parser = confidence, requires = "target", conflicts_with = "quality", default_value = "95%", allow_hyphen_values = true)]
    pub confidence: f64,

    /// The maximum samples per pixel with --noise or --quality, from 64. If they do not suffice,
    /// the picture is written anyway, and the exit code is 1
    #[arg(long, value_name = "N", requires = "target", default_value_t = 65536)]
    #[arg(value_parser = clap::value_parser!(u32).range(64..))]
    pub max_spp: u32,

    /// Stop after this time, such as 30s, 5m or 1h, but not before each pixel has 16 samples, the
    /// least that is a picture, however long they take. Without --spp, only the time decides. A
    /// resumed render has what is left of its time
    #[arg(long, value_name = "TIME", value_parser = duration, allow_hyphen_values = true)]
    pub time: Option<Duration>,
}

/// Who looks on.
#[derive(Args, Debug)]
#[command(group = ArgGroup::new("viewer").multiple(true))]
pub struct WatchArgs {
    /// Update this .png file with the picture so far
    #[arg(long, value_name = "FILE", group = "viewer")]
    pub preview: Option<PathBuf>,

    /// The time between two updates of --preview and --tev
    #[arg(long, value_name = "TIME", value_parser = duration, requires = "viewer", default_value = "2s", allow_hyphen_values = true)]
    pub preview_every: Duration,

    /// Show the picture so far in the viewer tev, which listens at this address; tev's own default
    /// is 127.0.0.1:14158
    #[arg(long, value_name = "HOST:PORT", group = "viewer")]
    pub tev: Option<String>,
}

impl StopArgs {
    /// When a render ends whose pictures are looked at through this view transform.
    pub fn stop_criteria(&self, view: ViewTransform) -> StopCriteria {
        let of_noise = |error| NoiseTarget { error, confidence: self.confidence, display: None };
        let of_quality = self.quality.map(|quality| quality.target(view));
        StopCriteria { noise: self.noise.map(of_noise).or(of_quality), time: self.time }
    }

    /// Returns true if the noise of the picture decides when the render ends.
    pub fn has_target(&self) -> bool {
        self.noise.is_some() || self.quality.is_some()
    }

    /// The option that ends each run by what its machine has done by then.
    pub fn limit_option(&self) -> Option<&'static str> {
        self.time.map(|_| "--time")
    }

    /// What the options change in the scene: the most samples that there can be.
    pub fn overrides(&self, given_spp: bool) -> Option<Override> {
        let most = |samples: u32| Override::new("render.samples_per_pixel", samples.to_string());
        match (self.has_target(), self.time) {
            (true, _) => {
                let given = self.max_spp.to_string();
                Some(most(self.max_spp).with_option(["--max-spp", &given]))
            }
            (false, Some(_)) if !given_spp => Some(most(UNLIMITED_SAMPLES).with_option(["--time"])),
            _ => None,
        }
    }
}
