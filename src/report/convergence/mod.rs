//! Reports convergence as text, as JSON, and as a plot.

mod plot;

use std::fmt;
use std::path::Path;

use serde::Serialize;
use serde_json::{Value, json};

use crate::draw::text::row;
use crate::error::Result;
use crate::scene::settings::ImageSettings;
use crate::verify::converge::{Axis, ConvergencePoint, ErrorMetric, Reference, Series};
use crate::verify::statistics;

/// Confidence level of the intervals.
const CONFIDENCE: f64 = 0.95;

/// A mean with its confidence interval.
#[derive(Serialize)]
struct Estimate {
    mean: f64,
    half_width_95: f64,
}

impl From<statistics::MeanEstimate> for Estimate {
    fn from(estimate: statistics::MeanEstimate) -> Self {
        Self { mean: estimate.mean, half_width_95: estimate.confidence_half_width(CONFIDENCE) }
    }
}

/// Formatted as `3.7200e-2 +- 1.2e-4`.
impl fmt::Display for Estimate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.4e} +- {:.1e}", self.mean, self.half_width_95)
    }
}

/// Report of a convergence study.
#[derive(Clone, Copy, Debug)]
pub struct ConvergenceReport<'a> {
    /// Scene file.
    pub scene: &'a Path,
    /// Image size.
    pub image: ImageSettings,
    /// Images behind every point.
    pub seeds: u32,
    /// Error metric reported.
    pub metric: ErrorMetric,
    /// Reference that the images were compared with.
    pub reference: &'a Reference,
    /// Source of the reference.
    pub origin: ReferenceOrigin<'a>,
    /// The curves.
    pub series: &'a [Series],
}

/// Source of a reference.
#[derive(Clone, Copy, Debug)]
pub enum ReferenceOrigin<'a> {
    /// An image file.
    File(&'a Path),
    /// Two renders with this integrator and this many samples per pixel each.
    Halves(&'a str, u32),
}

impl ConvergenceReport<'_> {
    /// Draws the plot as SVG.
    ///
    /// # Errors
    /// If nothing can be drawn because no error is positive and finite.
    pub fn svg(&self) -> Result<String> {
        plot::svg(self.series, self.metric, &self.title(), &self.reference_note())
    }

    fn title(&self) -> String {
        let name = self.scene.file_name().unwrap_or(self.scene.as_os_str()).to_string_lossy();
        let ImageSettings { width, height, .. } = self.image;
        format!("{name}, {width} x {height} pixels, {} seeds", self.seeds)
    }

    fn reference_note(&self) -> String {
        let source = match self.origin {
            ReferenceOrigin::File(path) => path.display().to_string(),
            ReferenceOrigin::Halves(integrator, samples) => {
                format!("{integrator}, 2 x {samples} samples per pixel")
            }
        };
        match self.reference.noise(self.metric) {
            Some(noise) => {
                let metric = self.metric.name();
                format!("reference: {source}; its own {metric} of {noise:.3e} is subtracted")
            }
            None => format!("reference: {source}; its own error is unknown and not subtracted"),
        }
    }

    /// Returns the report as JSON; `output` is the file that has the plot.
    pub fn json(&self, output: &Path) -> Value {
        let estimate = |estimate: statistics::MeanEstimate| json!(Estimate::from(estimate));
        let curve = |curve: &Series| {
            let slope = |axis| curve.fit(self.metric, axis).map(|fit| estimate(fit.slope));
            let point = |point: &ConvergencePoint| {
                json!({
                    "samples_per_pixel": point.samples,
                    "error": estimate(point.error(self.metric)),
                    "seconds": estimate(point.seconds()),
                    "cost": estimate(point.cost(self.metric)),
                    "pixels_with_half_of_the_error": point.concentration(self.metric).pixels,
                })
            };
            json!({
                "name": curve.name,
                "points": curve.points.iter().map(point).collect::<Vec<_>>(),
                "slope_against_samples": slope(Axis::Samples),
                "slope_against_seconds": slope(Axis::Seconds),
            })
        };
        json!({
            "output": output.display().to_string(),
            "metric": self.metric.name(),
            "width": self.image.width,
            "height": self.image.height,
            "seeds": self.seeds,
            "threads": rayon::current_num_threads(),
            "reference": match self.origin {
                ReferenceOrigin::File(path) => json!({ "file": path.display().to_string() }),
                ReferenceOrigin::Halves(integrator, samples) => json!({
                    "integrator": integrator,
                    "samples_per_pixel": 2 * u64::from(samples),
                }),
            },
            "reference_error": self.reference.noise(self.metric),
            "series": self.series.iter().map(curve).collect::<Vec<_>>(),
        })
    }
}

impl fmt::Display for ConvergenceReport<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}\n{}", self.title(), self.reference_note())?;
        let squared = match self.metric {
            ErrorMetric::Rmse => "MSE",
            ErrorMetric::Relmse => "relMSE",
        };
        writeln!(f, "means and slopes with 95 % intervals; cost is {squared} x seconds")?;
        let columns = [8, 2, -24, -24, -1];
        for curve in self.series {
            let header = row(columns, ["spp", "", self.metric.name(), "seconds", "cost"]);
            write!(f, "\n{}\n{header}", curve.name)?;
            for point in &curve.points {
                let figures = [point.error(self.metric), point.seconds(), point.cost(self.metric)];
                let [error, seconds, cost] =
                    figures.map(|estimate| Estimate::from(estimate).to_string());
                let cells = [&point.samples.to_string(), "", &error, &seconds, &*cost];
                f.write_str(&row(columns, cells))?;
            }
            let [samples, seconds] = [Axis::Samples, Axis::Seconds].map(|axis| {
                curve.fit(self.metric, axis).map_or("none".to_owned(), |fit| {
                    format!(
                        "{:.3} +- {:.3}",
                        fit.slope.mean,
                        fit.slope.confidence_half_width(CONFIDENCE)
                    )
                })
            });
            writeln!(f, "slope against samples {samples}, against seconds {seconds}")?;
        }
        Ok(())
    }
}
