//! The options of `photosphere compare`.

use std::path::PathBuf;

use clap::Args;

use crate::report::compare::{CompareMetric, CompareOptions};

use super::values::{named, one_of, positive, positive_or_zero};

/// Say how far a picture is from a reference
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  photosphere compare fig2.exr best.exr
  photosphere compare fig2.exr best.exr --metric relmse,flip --max-flip 0.05
  photosphere compare a.pfm b.hdr --metric mean --max-mean 0.001 --json
  photosphere compare fig2.exr best.exr --twin seed1.exr --heatmap where.png

B is the reference. Both may be .exr, .hdr, .pfm (linear light) or .png (decoded from sRGB to linear;
8 bits, cut off at 1), ours or any other program's. Of .exr files every layer that both have is
compared; R, G, B without a layer's name are the layer `beauty`. Layers that only one has are named
and left out, as are those, other than the beauty, with pixels that are not finite.

  mse     mean over pixels and channels of (A - B)^2
  rmse    its square root
  relmse  mean of ((A - B) / (|B| + 0.01))^2, which is pbrt's MRSE
  psnr    10 log10(peak^2 / mse) in decibels; the peak is 1 or what --peak
          says; infinite (null in JSON) for equal pictures
  flip    LDR-FLIP (Andersson et al. 2020), mean over pixels: 0 looks the same,
          1 could not differ more; 67 pixels per degree, light cut off to [0, 1]
  mean    means of A and B and their ratio, channel by channel; no ratio
          (null in JSON) where B is black and A is not

Means get 95 % confidence intervals where the noise of the pixels is known: from a layer `variance` in
the file (the variance of each pixel's value), or for A from --twin. Both intervals take the pixels as
independent of each other. Else there is no interval; it is unknown where a variance is infinite.

A --max-... that is exceeded in any compared layer makes the exit code 1. Pictures of different sizes,
and pixels of the beauty or of a --layer that are not finite, are refused (3), as are files that cannot
be read (4).")]
pub struct CompareArgs {
    /// The picture
    #[arg(value_name = "A")]
    pub picture: PathBuf,

    /// The reference that it is compared with
    #[arg(value_name = "B")]
    pub reference: PathBuf,

    /// What to measure; all by default
    #[arg(long = "metric", value_name = "NAMES", value_parser = one_of(named::<CompareMetric>()), value_delimiter = ',')]
    metrics: Vec<CompareMetric>,

    /// This layer only; may be repeated
    #[arg(long = "layer", value_name = "NAME")]
    pub layers: Vec<String>,

    /// The brightest value that PSNR refers to
    #[arg(long, value_name = "VALUE", default_value_t = 1.0, value_parser = positive)]
    pub peak: f64,

    /// A once more with other random numbers; tells how noisy its mean is
    #[arg(long, value_name = "FILE")]
    pub twin: Option<PathBuf>,

    /// Draw where the pictures differ, in the layer that is compared first
    #[arg(long, value_name = "FILE")]
    pub heatmap: Option<PathBuf>,

    /// What the heat map shows: flip on a scale from 0 to 1; rmse or relmse (the root of the
    /// pixel's error) on one from 0 to the largest
    #[arg(long, value_name = "NAME", default_value = "flip", requires = "heatmap")]
    #[arg(value_parser = one_of(MAPPED.map(|metric| (metric.name().into(), metric))))]
    pub heatmap_of: CompareMetric,

    #[command(flatten)]
    limits: Limits,

    /// Print JSON instead of a table
    #[arg(long)]
    pub json: bool,
}

/// What a heat map can show.
const MAPPED: [CompareMetric; 3] =
    [CompareMetric::Flip, CompareMetric::Rmse, CompareMetric::Relmse];

/// What is still good enough.
#[derive(Args, Debug)]
struct Limits {
    /// Fail when the MSE is larger
    #[arg(long, value_name = "VALUE", value_parser = positive_or_zero)]
    max_mse: Option<f64>,

    /// Fail when the RMSE is larger
    #[arg(long, value_name = "VALUE", value_parser = positive_or_zero)]
    max_rmse: Option<f64>,

    /// Fail when the relMSE is larger
    #[arg(long, value_name = "VALUE", value_parser = positive_or_zero)]
    max_relmse: Option<f64>,

    /// Fail when the FLIP is larger
    #[arg(long, value_name = "VALUE", value_parser = positive_or_zero)]
    max_flip: Option<f64>,

    /// Fail when the ratio of the means is farther from 1 in any channel
    #[arg(long, value_name = "VALUE", value_parser = positive_or_zero)]
    max_mean: Option<f64>,

    /// Fail when the PSNR is smaller
    #[arg(long, value_name = "DECIBELS")]
    min_psnr: Option<f64>,
}

impl Limits {
    /// Returns every limit that is set. For PSNR a limit is a minimum.
    fn set(&self) -> Vec<(CompareMetric, f64)> {
        let all = [
            (CompareMetric::Mse, self.max_mse),
            (CompareMetric::Rmse, self.max_rmse),
            (CompareMetric::Relmse, self.max_relmse),
            (CompareMetric::Psnr, self.min_psnr),
            (CompareMetric::Flip, self.max_flip),
            (CompareMetric::Mean, self.max_mean),
        ];
        all.into_iter().filter_map(|(metric, limit)| Some((metric, limit?))).collect()
    }
}

impl CompareArgs {
    /// Returns what to measure: the requested metrics or all, and always those with a limit.
    pub fn options(&self) -> CompareOptions {
        let limits = self.limits.set();
        let is_wanted = |metric: &CompareMetric| {
            let is_limited = limits.iter().any(|(limited, _)| limited == metric);
            self.metrics.is_empty() || self.metrics.contains(metric) || is_limited
        };
        let metrics =
            CompareMetric::NAMES.iter().map(|(_, metric)| *metric).filter(is_wanted).collect();
        CompareOptions { metrics, limits, peak: self.peak }
    }
}
