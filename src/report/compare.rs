//! Compares an image with a reference: layer by layer as text and JSON, and as a heat map.

use std::fmt;
use std::path::Path;

use serde::Serialize;
use serde_json::{Value, json};

use crate::color::Rgb;
use crate::draw::text::row;
use crate::image_io::Picture;
use crate::image_io::{BEAUTY, LayeredImage};
use crate::math::DVec3;
use crate::names::named_enum;
use crate::verify::metrics::{
    ImageMean, flip, heatmap, mean_error, psnr, relative_squared, squared,
};

/// Name of the layer with the variance of the beauty.
pub const VARIANCE: &str = "variance";

/// Metric for comparing two images.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CompareMetric {
    /// Mean squared error.
    Mse,
    /// Root mean squared error.
    Rmse,
    /// Mean relative squared error.
    Relmse,
    /// Peak signal-to-noise ratio in decibels.
    Psnr,
    /// Mean LDR-FLIP over the pixels.
    Flip,
    /// Means and their ratio, per channel.
    Mean,
}

named_enum! {
    CompareMetric {
        Mse = "mse",
        Rmse = "rmse",
        Relmse = "relmse",
        Psnr = "psnr",
        Flip = "flip",
        Mean = "mean",
    }
}

/// Metrics with a single value, in table order.
const SCALAR_METRICS: [CompareMetric; 5] = [
    CompareMetric::Mse,
    CompareMetric::Rmse,
    CompareMetric::Relmse,
    CompareMetric::Psnr,
    CompareMetric::Flip,
];

/// Images of one size: A, the reference B, and an optional twin of A.
#[derive(Clone, Debug)]
pub struct ImagePair {
    /// The image.
    pub a: LayeredImage,
    /// The reference.
    pub b: LayeredImage,
    /// The image rendered with different random numbers, used to estimate the noise of its mean.
    pub twin: Option<LayeredImage>,
}

/// Metrics to compute and limits to check.
#[derive(Clone, Debug)]
pub struct CompareOptions {
    /// Metrics to compute.
    pub metrics: Vec<CompareMetric>,
    /// Largest allowed value per metric; smallest for PSNR.
    pub limits: Vec<(CompareMetric, f64)>,
    /// Peak value that PSNR refers to.
    pub peak: f64,
}

/// Differences between the layers of two images.
#[derive(Clone, Debug)]
pub struct Comparison<'a> {
    pair: &'a ImagePair,
    options: &'a CompareOptions,
    layers: Vec<LayerDifference>,
}

/// Differences in one layer.
#[derive(Clone, Debug)]
struct LayerDifference {
    layer: String,
    mse: f64,
    relmse: f64,
    psnr: f64,
    /// Computed only on request, as it takes the longest.
    flip: Option<f64>,
    means: (ImageMean, ImageMean),
    ratio: (DVec3, Option<DVec3>),
}

/// A limit that was exceeded.
#[derive(Clone, Debug, Serialize)]
pub struct ExceededLimit {
    layer: String,
    metric: CompareMetric,
    value: f64,
    limit: f64,
}

impl ImagePair {
    /// Names of the layers that both images have.
    pub fn common(&self) -> Vec<&str> {
        let names = self.a.layers.iter().map(|layer| layer.name.as_str());
        names.filter(|name| *name != VARIANCE && self.b.layer(name).is_some()).collect()
    }

    /// Names of the layers of [`Self::common`] that have a difference. A layer other than the
    /// beauty has none if a pixel is infinite or NaN, such as the depth of a miss.
    pub fn comparable(&self) -> Vec<&str> {
        let mut names = self.common();
        names.retain(|name| *name == BEAUTY || self.non_finite(name).is_none());
        names
    }

    /// Describes the pixels of a layer that are infinite or NaN, if there are any.
    fn non_finite(&self, layer: &str) -> Option<String> {
        let of = |(name, picture): (&str, &LayeredImage)| {
            let (count, first) = picture.layer(layer)?.count_non_finite()?;
            let (x, y) = (first % picture.width, first / picture.width);
            let pixels = if count == 1 { "pixel that is" } else { "pixels that are" };
            let what = format!("{name} has {count} {pixels} infinite or not a number in it");
            Some(format!("{what}, the first at {x}, {y}"))
        };
        [("A", &self.a), ("B", &self.b)].into_iter().find_map(of)
    }

    /// Remarks on the files that help interpret the figures.
    pub fn remarks(&self) -> Vec<String> {
        let png = "a PNG is decoded from sRGB to linear light; it has 8 bits and is clamped at 1";
        let has_png = self.a.is_display_referred || self.b.is_display_referred;
        let mut remarks: Vec<String> = has_png.then(|| png.to_owned()).into_iter().collect();
        for (name, picture, other) in [("A", &self.a, &self.b), ("B", &self.b, &self.a)] {
            let names = picture.layers.iter().map(|layer| &*layer.name);
            let is_only_here = |name: &&str| *name != VARIANCE && other.layer(name).is_none();
            let only_here: Vec<&str> = names.filter(is_only_here).collect();
            if !only_here.is_empty() {
                remarks.push(format!("only {name} has: {}", only_here.join(", ")));
            }
        }
        let comparable = self.comparable();
        for layer in self.common().into_iter().filter(|layer| !comparable.contains(layer)) {
            let reason = self.non_finite(layer).unwrap_or_default();
            remarks.push(format!("left out: `{layer}`; {reason}"));
        }
        remarks
    }

    /// Returns a heat map of one layer with its caption. FLIP uses a scale from 0 to 1, other
    /// metrics the root of each pixel's error from 0 to the largest.
    pub fn heatmap(&self, layer: &str, metric: CompareMetric) -> (Picture, String) {
        let (a, b) = (pixels(&self.a, layer), pixels(&self.b, layer));
        let root_errors = |error: fn(Rgb, Rgb) -> f64| -> Vec<f64> {
            a.iter().zip(b).map(|(&a, &b)| error(a, b).sqrt()).collect()
        };
        let (values, quantity) = match metric {
            CompareMetric::Relmse => {
                (root_errors(relative_squared), "relative error of the channels")
            }
            CompareMetric::Flip => (flip::map(a, b, self.a.width, flip::PIXELS_PER_DEGREE), "FLIP"),
            _ => (root_errors(squared), "root mean square error of the channels"),
        };
        let largest = values.iter().copied().fold(0.0, f64::max);
        let scale_max = if metric == CompareMetric::Flip { 1.0 } else { largest };
        let caption = format!(
            "heat map of `{layer}`: {quantity}; its scale runs from 0 (black, left) to {} (light yellow, \
             right), the largest is {}",
            format_short(scale_max),
            format_short(largest)
        );
        (heatmap::draw(&values, self.a.width, scale_max), caption)
    }

    /// Means of a layer in A and B, with their standard errors if known.
    fn means(&self, name: &str) -> (ImageMean, ImageMean) {
        let mean = |picture: &LayeredImage| {
            let pixels = pixels(picture, name);
            match picture.layer(VARIANCE).filter(|_| name == BEAUTY) {
                Some(variance) => ImageMean::with_variance(pixels, &variance.pixels),
                None => ImageMean::of(pixels),
            }
        };
        let twin = self.twin.as_ref().and_then(|twin| twin.layer(name));
        let a = match twin {
            Some(twin) => ImageMean::with_twin(pixels(&self.a, name), &twin.pixels),
            None => mean(&self.a),
        };
        (a, mean(&self.b))
    }
}

fn pixels<'a>(picture: &'a LayeredImage, name: &str) -> &'a [Rgb] {
    &picture.layer(name).expect("the layer was chosen because it is there").pixels
}

impl<'a> Comparison<'a> {
    /// Compares the given layers, which both images must have.
    pub fn of(pair: &'a ImagePair, options: &'a CompareOptions, layers: &[String]) -> Self {
        let layers = layers.iter().map(|layer| LayerDifference::of(pair, options, layer)).collect();
        Self { pair, options, layers }
    }

    /// Returns the limits that are exceeded.
    pub fn exceeded(&self) -> Vec<ExceededLimit> {
        let check_limit = |difference: &LayerDifference, metric, limit| {
            let value = difference.value(metric);
            let is_good =
                if metric == CompareMetric::Psnr { value >= limit } else { value <= limit };
            (!is_good).then(|| ExceededLimit {
                layer: difference.layer.clone(),
                metric,
                value,
                limit,
            })
        };
        let exceeded_in_layer = |difference| {
            self.options
                .limits
                .iter()
                .filter_map(move |&(m, limit)| check_limit(difference, m, limit))
        };
        self.layers.iter().flat_map(exceeded_in_layer).collect()
    }

    /// Returns all figures as JSON; the paths are those of A and B.
    pub fn json(&self, picture: &Path, reference: &Path) -> Value {
        let layer = |result: &LayerDifference| {
            let mut object = json!({ "layer": result.layer });
            for metric in self.scalar_metrics() {
                object[metric.name()] = json!(result.value(metric));
            }
            if self.options.metrics.contains(&CompareMetric::Mean) {
                let (a, b) = &result.means;
                object["mean_a"] = json!(a.value);
                object["mean_a_half_width_95"] = json!(a.half_width_95());
                object["mean_b"] = json!(b.value);
                object["mean_b_half_width_95"] = json!(b.half_width_95());
                object["mean_ratio"] = json!(result.ratio.0);
                object["mean_ratio_half_width_95"] = json!(result.ratio.1);
            }
            object
        };
        json!({
            "picture": picture.display().to_string(),
            "reference": reference.display().to_string(),
            "width": self.pair.a.width,
            "height": self.pair.a.height,
            "peak": self.options.peak,
            "layers": self.layers.iter().map(layer).collect::<Vec<_>>(),
            "exceeded": self.exceeded(),
            "remarks": self.pair.remarks(),
        })
    }

    fn scalar_metrics(&self) -> impl Iterator<Item = CompareMetric> {
        SCALAR_METRICS.into_iter().filter(|metric| self.options.metrics.contains(metric))
    }
}

impl fmt::Display for Comparison<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let LayeredImage { width, height, .. } = self.pair.a;
        writeln!(f, "{width} x {height} pixels; B is the reference")?;
        if self.scalar_metrics().next().is_some() {
            let header: String =
                self.scalar_metrics().map(|m| format!("{:>13}", m.name())).collect();
            writeln!(f, "{:<12}{header}", "layer")?;
            for result in &self.layers {
                let value = |metric| format!("{:>13}", format_short(result.value(metric)));
                let values: String = self.scalar_metrics().map(value).collect();
                writeln!(f, "{:<12}{values}", result.layer)?;
            }
        }
        if self.options.metrics.contains(&CompareMetric::Mean) {
            f.write_str(&row(MEANS, ["means", "", "A", "B", "A / B"]))?;
            self.layers.iter().try_for_each(|result| f.write_str(&result.means()))?;
        }
        Ok(())
    }
}

/// Column widths of the table of means.
const MEANS: [i32; 5] = [-12, -7, -24, -24, -1];

impl LayerDifference {
    fn of(pair: &ImagePair, options: &CompareOptions, name: &str) -> Self {
        let (a, b) = (pixels(&pair.a, name), pixels(&pair.b, name));
        let mse = mean_error(a, b, squared);
        let flip = options.metrics.contains(&CompareMetric::Flip).then(|| {
            let map = flip::map(a, b, pair.a.width, flip::PIXELS_PER_DEGREE);
            map.iter().sum::<f64>() / map.len() as f64
        });
        let means = pair.means(name);
        Self {
            layer: name.to_owned(),
            mse,
            relmse: mean_error(a, b, relative_squared),
            psnr: psnr(mse, options.peak),
            flip,
            ratio: means.0.ratio(&means.1),
            means,
        }
    }

    fn value(&self, metric: CompareMetric) -> f64 {
        match metric {
            CompareMetric::Mse => self.mse,
            CompareMetric::Rmse => self.mse.sqrt(),
            CompareMetric::Relmse => self.relmse,
            CompareMetric::Psnr => self.psnr,
            CompareMetric::Flip => self.flip.unwrap_or(f64::NAN),
            CompareMetric::Mean => (self.ratio.0 - 1.0).abs().max_element(),
        }
    }

    /// One line per channel.
    fn means(&self) -> String {
        let (a, b) = &self.means;
        let line = |(axis, channel): (usize, &str)| {
            let with_interval = |value: DVec3, half: Option<DVec3>| match half {
                Some(half) if !half[axis].is_finite() => {
                    format!("{} +- unknown", format_short(value[axis]))
                }
                Some(half) => format!("{} +- {:.1e}", format_short(value[axis]), half[axis]),
                None => format_short(value[axis]),
            };
            let layer = if axis == 0 { &*self.layer } else { "" };
            let [a, b] = [a, b].map(|mean| with_interval(mean.value, mean.half_width_95()));
            let ratio = match self.ratio.0[axis].is_finite() {
                true => with_interval(self.ratio.0, self.ratio.1),
                false => "none, B is black".to_owned(),
            };
            row(MEANS, [layer, channel, &a, &b, &ratio])
        };
        ["red", "green", "blue"].into_iter().enumerate().map(line).collect()
    }
}

impl fmt::Display for ExceededLimit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { layer, metric, value, limit } = self;
        let (name, allowed) = match metric {
            CompareMetric::Mean => ("ratio of means - 1", "at most"),
            CompareMetric::Psnr => ("psnr", "at least"),
            other => (other.name(), "at most"),
        };
        let value = match metric {
            CompareMetric::Mean if value.is_infinite() => "infinite, since B is black".to_owned(),
            _ => format_short(*value),
        };
        write!(f, "failed: {name} of `{layer}` is {value}, allowed is {allowed} {limit}")
    }
}

/// Formats five digits, with an exponent for very small or large numbers.
fn format_short(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        x if x.is_finite() && !(1e-3..1e5).contains(&x) => format!("{value:.4e}"),
        _ => format!("{value:.5}"),
    }
}
