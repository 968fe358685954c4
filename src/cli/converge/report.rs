//! What `photosphere converge` found, in words and in JSON.

use serde_json::{Value, json};

use crate::error::Error;
use crate::verify::converge::{Axis, Metric, Point, Reference, Series};
use crate::verify::statistics::Estimate;

use super::super::args::ConvergeArgs;
use super::super::print;
use super::Study;

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

/// A reference that is nearly as noisy as what it judges is no reference.
pub(super) fn warn_of_noise(reference: &Reference, series: &[Series], metric: Metric) {
    let least = series
        .iter()
        .flat_map(|one| &one.points)
        .map(|point| point.error(metric).mean)
        .fold(f64::INFINITY, |least, error| if error >= least { least } else { error });
    if reference.noise(metric).is_some_and(|own| own > 0.0 && own >= 0.5 * least) {
        print::warning("the reference is nearly as noisy as the best point; raise --reference-spp");
    }
}

/// `0.03720 +- 0.00012`, the interval in two digits.
fn with_margin(estimate: Estimate) -> String {
    format!("{:.4e} +- {:.1e}", estimate.mean, estimate.margin(CONFIDENCE))
}

pub(super) fn in_words(title: &str, about: &str, series: &[Series], metric: Metric) -> String {
    let mut text = format!("{title}\n{about}\nmeans and slopes with 95 % intervals\n");
    for one in series {
        text +=
            &format!("\n{}\n{:>8}  {:<24}{:<24}cost\n", one.name, "spp", metric.name(), "seconds");
        for point in &one.points {
            text += &format!(
                "{:>8}  {:<24}{:<24}{}\n",
                point.samples,
                with_margin(point.error(metric)),
                with_margin(point.seconds()),
                with_margin(point.cost(metric)),
            );
        }
        let slope = |axis| match one.fit(metric, axis) {
            Some(fit) => format!("{:.3} +- {:.3}", fit.slope.mean, fit.slope.margin(CONFIDENCE)),
            None => "none".to_owned(),
        };
        text += &format!(
            "slope against samples {}, against seconds {}\n",
            slope(Axis::Samples),
            slope(Axis::Seconds)
        );
    }
    text
}

pub(super) fn in_json(
    args: &ConvergeArgs,
    study: &Study<'_>,
    reference: &Reference,
    series: &[Series],
) -> Value {
    let metric = Metric::from(args.metric);
    let estimate = |estimate: Estimate| json!({ "mean": estimate.mean, "half_interval_95": estimate.margin(CONFIDENCE) });
    let point = |point: &Point| {
        json!({
            "samples_per_pixel": point.samples,
            "error": estimate(point.error(metric)),
            "seconds": estimate(point.seconds()),
            "cost": estimate(point.cost(metric)),
        })
    };
    let one = |one: &Series| {
        let slope = |axis| one.fit(metric, axis).map(|fit| estimate(fit.slope));
        json!({
            "name": one.name,
            "points": one.points.iter().map(point).collect::<Vec<_>>(),
            "slope_against_samples": slope(Axis::Samples),
            "slope_against_seconds": slope(Axis::Seconds),
        })
    };
    let image = study.own.image;
    json!({
        "output": args.output.display().to_string(),
        "metric": metric.name(),
        "width": image.width,
        "height": image.height,
        "seeds": args.seeds,
        "threads": rayon::current_num_threads(),
        "reference": match &args.reference {
            Some(path) => json!({ "file": path.display().to_string() }),
            None => json!({
                "integrator": study.reference_integrator,
                "samples_per_pixel": 2 * u64::from(study.reference_half()),
            }),
        },
        "reference_error": reference.noise(metric),
        "series": series.iter().map(one).collect::<Vec<_>>(),
    })
}
