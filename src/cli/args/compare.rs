//! The options of `photosphere compare`.

use std::path::PathBuf;

use clap::Args;

use crate::report::compare::{CompareMetric, CompareOptions};

use super::values::{named, one_of, positive, positive_or_zero};

/// Measure how far a picture is from a reference
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  photosphere compare fig2.exr best.exr
  photosphere compare fig2.exr best.exr --metric relmse,flip --max-flip 0.05
  photosphere compare a.pfm b.hdr --metric mean --max-mean 0.001 --json
  photosphere compare fig2.exr best.exr --twin seed1.exr --heatmap where.png

B is the reference. Both may be .exr, .hdr, .pfm (linear light) or .png (decoded from sRGB to linear;
8 bits, clipped at 1), from photosphere or any other program. Every layer that both .exr files have
is compared; the channels R, G, B without a layer name are the layer `beauty`. Layers that only one
file has are listed and left out, as are those, other than the beauty, with pixels that are not finite.

  mse     mean over pixels and channels of (A - B)^2
  rmse    its square root
  relmse  mean of ((A - B) / (|B| + 0.01))^2, which is pbrt's MRSE
  psnr    10 log10(peak^2 / mse) in decibels; the peak is 1, or --peak;
          infinite (null in JSON) for equal pictures
  flip    LDR-FLIP (Andersson et al. 2020), mean over pixels: from 0, no visible
          difference, to 1; 67 pixels per degree, light clipped to [0, 1]
  mean    means of A and B and their ratio, channel by channel; no ratio
          (null in JSON) where B is black and A is not

Means have a 95 % confidence interval if the noise of the pixels is known: from the layer `variance` of
the file (the variance of each pixel's value) or, for A, from --twin. Both assume that pixels are
independent. The interval is unknown if a variance is infinite.

The exit code is 1 if any compared layer exceeds a limit (--max-..., --min-psnr), 3 if the pictures
differ in size, or the beauty or a --layer has pixels that are not finite, and 4 if a file cannot be
read.")]
pub struct CompareArgs {
    /// The picture
    #[arg(value_name = "A")]
    pub picture: PathBuf,

    /// The reference
    #[arg(value_name = "B")]
    pub reference: PathBuf,

    /// The metrics to compute [default: all]
    #[arg(long = "metric", value_name = "NAMES", value_parser = one_of(named::<CompareMetric>()), value_delimiter = ',')]
    metrics: Vec<CompareMetric>,

    /// Compare only this layer; may be repeated
    #[arg(long = "layer", value_name = "NAME")]
    pub layers: Vec<String>,

    /// The peak value for PSNR
    #[arg(long, value_name = "VALUE", default_value_t = 1.0, value_parser = positive)]
    pub peak: f64,

    /// A rendered with another seed; gives the confidence interval of A's mean
    #[arg(long, value_name = "FILE")]
    pub twin: Option<PathBuf>,

    /// Write a heat map of the differences in the first compared layer
    #[arg(long, value_name = "FILE")]
    pub heatmap: Option<PathBuf>,

    /// What the heat map shows: flip, on a scale from 0 to 1; rmse or relmse (the root of each
    /// pixel's error), on a scale from 0 to the largest
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
    /// Fail if the MSE is larger
    #[arg(long, value_name = "VALUE", value_parser = positive_or_zero)]
    max_mse: Option<f64>,

    /// Fail if the RMSE is larger
    #[arg(long, value_name = "VALUE", value_parser = positive_or_zero)]
    max_rmse: Option<f64>,

    /// Fail if the relMSE is larger
    #[arg(long, value_name = "VALUE", value_parser = positive_or_zero)]
    max_relmse: Option<f64>,

    /// Fail if the FLIP is larger
    #[arg(long, value_name = "VALUE", value_parser = positive_or_zero)]
    max_flip: Option<f64>,

    /// Fail if the ratio of the means differs from 1 by more than this in any channel
    #[arg(long, value_name = "VALUE", value_parser = positive_or_zero)]
    max_mean: Option<f64>,

    /// Fail if the PSNR is smaller
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
