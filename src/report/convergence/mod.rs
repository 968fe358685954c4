//! Reports convergence as text, as JSON, and as a plot.

mod plot;

use std::fmt;
use std::path::Path;

use serde::Serialize;
use serde_json::{Value, json};

use crate::draw::text::row;
use crate::error::Result;
use crate::scene::settings::ImageSettings;
use crate::verify::converge::{Axis, ChartPoint, ErrorMetric, Reference, Series};
use crate::verify::statistics;

/// Confidence level of the intervals.
const CONFIDENCE: f64 = 0.95;

/// A mean with its confidence interval.
#[derive(Serialize)]
struct Estimate {
    mean: f64,
    half_interval_95: f64,
}

impl From<statistics::MeanEstimate> for Estimate {
    fn from(of: statistics::MeanEstimate) -> Self {
        Self { mean: of.mean, half_interval_95: of.confidence_half_width(CONFIDENCE) }
    }
}

/// Formatted as `3.7200e-2 +- 1.2e-4`.
impl fmt::Display for Estimate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.4e} +- {:.1e}", self.mean, self.half_interval_95)
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
        plot::svg(self.series, self.metric, &self.title(), &self.about_reference())
    }

    fn title(&self) -> String {
        let name = self.scene.file_name().unwrap_or(self.scene.as_os_str()).to_string_lossy();
        let ImageSettings { width, height, .. } = self.image;
        format!("{name}, {width} x {height} pixels, {} seeds", self.seeds)
    }

    fn about_reference(&self) -> String {
        let what = match self.origin {
            ReferenceOrigin::File(path) => path.display().to_string(),
            ReferenceOrigin::Halves(integrator, samples) => {
                format!("{integrator}, 2 x {samples} samples per pixel")
            }
        };
        match self.reference.noise(self.metric) {
            Some(own) => {
                let metric = self.metric.name();
                format!("reference: {what}; its own {metric} of {own:.3e} is taken away")
            }
            None => format!("reference: {what}; its own error is not known and stays in"),
        }
    }

    /// Returns the report as JSON; `output` is the file that has the plot.
    pub fn json(&self, output: &Path) -> Value {
        let estimate = |of: statistics::MeanEstimate| json!(Estimate::from(of));
        let one = |one: &Series| {
            let slope = |axis| one.fit(self.metric, axis).map(|fit| estimate(fit.slope));
            let point = |point: &ChartPoint| {
                json!({
                    "samples_per_pixel": point.samples,
                    "error": estimate(point.error(self.metric)),
                    "seconds": estimate(point.seconds()),
                    "cost": estimate(point.cost(self.metric)),
                })
            };
            json!({
                "name": one.name,
                "points": one.points.iter().map(point).collect::<Vec<_>>(),
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
            "series": self.series.iter().map(one).collect::<Vec<_>>(),
        })
    }
}

impl fmt::Display for ConvergenceReport<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}\n{}", self.title(), self.about_reference())?;
        writeln!(f, "means and slopes with 95 % intervals")?;
        let columns = [8, 2, -24, -24, -1];
        for one in self.series {
            let head = row(columns, ["spp", "", self.metric.name(), "seconds", "cost"]);
            write!(f, "\n{}\n{head}", one.name)?;
            for point in &one.points {
                let figures = [point.error(self.metric), point.seconds(), point.cost(self.metric)];
                let [error, seconds, cost] = figures.map(|of| Estimate::from(of).to_string());
                let cells = [&point.samples.to_string(), "", &error, &seconds, &*cost];
                f.write_str(&row(columns, cells))?;
            }
            let [samples, seconds] = [Axis::Samples, Axis::Seconds].map(|axis| {
                one.fit(self.metric, axis).map_or("none".to_owned(), |fit| {
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
