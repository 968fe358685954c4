//! Chi-square tests as checks: one check per row of the table, with its histograms as images.

use crate::draw::{CellColors, Cells};

use super::check::{Check, CheckGroup, CheckMeasurement, Effort, TestStatistic};
use super::chi2::{ChiSquareResult, Histogram, SamplingTest, chi_square_test, sampling_tests};

/// Points drawn for each row.
const SAMPLES: [u32; 3] = [200_000, 1_000_000, 4_000_000];
/// Deviation of a count, in standard deviations, drawn in full colour.
const FULL_COLOR: f64 = 4.0;

/// Returns one check per row of the table.
pub(super) fn checks(effort: Effort) -> Vec<Check> {
    let points = effort.select(SAMPLES);
    sampling_tests().into_iter().map(|test| check(test, points)).collect()
}

fn check(test: SamplingTest, points: u32) -> Check {
    Check::new(CheckGroup::ChiSquare, test.name.clone(), move |_| {
        let result = chi_square_test(&test, points, 0);
        let ChiSquareResult { p_value, statistic, degrees_of_freedom, histogram } = &result;
        let detail = format!(
            "chi-square {statistic:.1} of {degrees_of_freedom} degrees of freedom, {points} points"
        );
        Ok(CheckMeasurement::new(TestStatistic::PValue(*p_value), detail)
            .with_images(figures(histogram)))
    })
}

fn figures(histogram: &Histogram) -> Vec<Cells> {
    let Histogram { cells, expected, observed } = histogram;
    let observed: Vec<f64> = observed.iter().map(|&count| count as f64).collect();
    let max_count = expected.iter().chain(&observed).copied().fold(1.0, f64::max);
    let deviation = |(&expected, &observed): (&f64, &f64)| {
        if expected >= 1.0 { (observed - expected) / expected.sqrt() } else { f64::NAN }
    };
    let difference = expected.iter().zip(&observed).map(deviation).collect();
    let figure = |caption: &str, values, colors| Cells {
        caption: caption.to_owned(),
        width: cells[1],
        values,
        colors,
    };
    let light = CellColors::Light(max_count);
    vec![
        figure("observed", observed, light),
        figure("expected", expected.clone(), light),
        figure(
            "difference: red too many, blue too few, full colour at 4 standard deviations",
            difference,
            CellColors::Signed(FULL_COLOR),
        ),
    ]
}
