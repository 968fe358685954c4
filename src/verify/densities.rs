//! The chi-square table as checks: a row is one check, its histograms are its pictures.

use crate::draw::{CellColors, Cells};

use super::check::{Check, Effort, Finding, Group, Measured};
use super::chi2::{Histogram, Pair, Verdict, judge, table};

/// Points drawn for each row.
const POINTS: [u32; 3] = [200_000, 1_000_000, 4_000_000];
/// Standard deviations of a count at which a cell has its full colour.
const FULL_COLOR: f64 = 4.0;

/// A check for each row.
pub(super) fn checks(effort: Effort) -> Vec<Check> {
    let points = effort.choose(POINTS);
    table().into_iter().map(|pair| check(pair, points)).collect()
}

fn check(pair: Pair, points: u32) -> Check {
    Check::new(Group::ChiSquare, pair.name.clone(), move |_| {
        let verdict = judge(&pair, points, 0);
        let Verdict { p_value, statistic, freedom, histogram } = &verdict;
        let detail =
            format!("chi-square {statistic:.1} of {freedom} degrees of freedom, {points} points");
        Ok(Measured::new(Finding::PValue(*p_value), detail).with_pictures(figures(histogram)))
    })
}

fn figures(histogram: &Histogram) -> Vec<Cells> {
    let Histogram { cells, expected, observed } = histogram;
    let observed: Vec<f64> = observed.iter().map(|&count| count as f64).collect();
    let most = expected.iter().chain(&observed).copied().fold(1.0, f64::max);
    let off = |(&expected, &observed): (&f64, &f64)| {
        if expected >= 1.0 { (observed - expected) / expected.sqrt() } else { f64::NAN }
    };
    let difference = expected.iter().zip(&observed).map(off).collect();
    let figure = |caption: &str, values, colors| Cells {
        caption: caption.to_owned(),
        width: cells[1],
        values,
        colors,
    };
    let light = CellColors::Light(most);
    vec![
        figure("drawn", observed, light),
        figure("density", expected.clone(), light),
        figure(
            "difference: red too many, blue too few, full colour at 4 standard deviations",
            difference,
            CellColors::Signed(FULL_COLOR),
        ),
    ]
}
