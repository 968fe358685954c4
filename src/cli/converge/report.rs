//! What `photosphere converge` found, in words and in JSON.

use std::fmt;

use serde::Serialize;
use serde_json::{Value, json};

use crate::cli::args::ConvergeArgs;
use crate::cli::print::{self, row};
use crate::error::Error;
use crate::scene::settings::Image;
use crate::verify::converge::{Axis, Metric, Reference, Series};
use crate::verify::statistics;

/// How sure the intervals are.
const CONFIDENCE: f64 = 0.95;

/// Says why there is nothing to plot.
pub(super) fn nothing_to_plot(reference: &Reference, metric: Metric) -> Error {
    match reference.noise(metric) {
        Some(0.0) | None => Error::input(
            "every picture equals the reference: there is no error to plot",
        )
        .with_help("each sample of this scene gives the same, so it needs one; try another scene"),
        Some(_) => Error::input("there is no error above the reference's own noise to plot")
            .with_help("make the reference better with --reference-spp"),
    }
}

/// A mean with its interval.
#[derive(Serialize)]
struct Estimate {
    mean: f64,
    half_interval_95: f64,
}

impl From<statistics::Estimate> for Estimate {
    fn from(of: statistics::Estimate) -> Self {
        Self { mean: of.mean, half_interval_95: of.margin(CONFIDENCE) }
    }
}

/// `3.7200e-2 +- 1.2e-4`.
impl fmt::Display for Estimate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.4e} +- {:.1e}", self.mean, self.half_interval_95)
    }
}

/// What was found.
pub(super) struct Report<'a> {
    pub(super) args: &'a ConvergeArgs,
    pub(super) metric: Metric,
    pub(super) image: Image,
    pub(super) reference: &'a Reference,
    pub(super) reference_integrator: String,
    /// Those of both halves.
    pub(super) reference_samples: u64,
    pub(super) series: &'a [Series],
}

impl Report<'_> {
    pub(super) fn title(&self) -> String {
        let path = &self.args.scene.path;
        let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
        let Image { width, height, .. } = self.image;
        format!("{name}, {width} x {height} pixels, {} seeds", self.args.seeds)
    }

    pub(super) fn about_reference(&self) -> String {
        let what = match &self.args.reference {
            Some(path) => path.display().to_string(),
            None => format!(
                "{}, 2 x {} samples per pixel",
                self.reference_integrator,
                self.reference_samples / 2
            ),
        };
        match self.reference.noise(self.metric) {
            Some(own) => {
                let metric = self.metric.name();
                format!("reference: {what}; its own {metric} of {own:.3e} is taken away")
            }
            None => format!("reference: {what}; its own error is not known and stays in"),
        }
    }

    /// A reference that is nearly as noisy as what it judges is no reference.
    pub(super) fn warn_of_noise(&self) {
        let points = self.series.iter().flat_map(|one| &one.points);
        let errors = points.map(|point| point.error(self.metric).mean);
        // An error that is no number is not the least.
        let least = errors.fold(f64::INFINITY, f64::min);
        if self.reference.noise(self.metric).is_some_and(|own| own > 0.0 && own >= 0.5 * least) {
            print::warning(
                "the reference is nearly as noisy as the best point; raise --reference-spp",
            );
        }
    }

    pub(super) fn json(&self) -> Value {
        let estimate = |of: statistics::Estimate| json!(Estimate::from(of));
        let one = |one: &Series| {
            let slope = |axis| one.fit(self.metric, axis).map(|fit| estimate(fit.slope));
            let point = |point: &crate::verify::converge::Point| {
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
            "output": self.args.output.display().to_string(),
            "metric": self.metric.name(),
            "width": self.image.width,
            "height": self.image.height,
            "seeds": self.args.seeds,
            "threads": rayon::current_num_threads(),
            "reference": match &self.args.reference {
                Some(path) => json!({ "file": path.display().to_string() }),
                None => json!({
                    "integrator": self.reference_integrator,
                    "samples_per_pixel": self.reference_samples,
                }),
            },
            "reference_error": self.reference.noise(self.metric),
            "series": self.series.iter().map(one).collect::<Vec<_>>(),
        })
    }
}

impl fmt::Display for Report<'_> {
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
                    format!("{:.3} +- {:.3}", fit.slope.mean, fit.slope.margin(CONFIDENCE))
                })
            });
            writeln!(f, "slope against samples {samples}, against seconds {seconds}")?;
        }
        Ok(())
    }
}
