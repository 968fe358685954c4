//! Every sampling routine against its own density: the table of `verify::chi2`, with a million
//! points for each row. The family-wise significance is 1 %, shared over the table by Sidak's
//! correction. A failing histogram is written for plotting.

use std::collections::HashSet;
use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;
use std::path::Path;

use photosphere::math::DVec3;
use photosphere::sampling::Hemisphere;
use photosphere::verify::chi2::{Histogram, SamplingTest, chi_square_test, sampling_tests};
use photosphere::verify::statistics::sidak;
use rayon::prelude::*;

const SIGNIFICANCE: f64 = 0.01;
const POINTS: u32 = 1_000_000;

#[test]
fn every_routine_draws_from_its_density() {
    let tests = sampling_tests();
    let each = sidak(SIGNIFICANCE, tests.len());
    let verdicts: Vec<_> =
        tests.par_iter().with_max_len(1).map(|test| chi_square_test(test, POINTS, 0)).collect();
    let mut failed = Vec::new();
    for (test, verdict) in tests.iter().zip(verdicts) {
        let p = verdict.p_value;
        println!("{:<60} p = {p:.4}", test.name);
        if p < each {
            write_histogram(&test.name, &verdict.histogram);
            failed.push(format!("{}: p = {p:.2e} < {each:.2e}", test.name));
        }
    }
    let histograms = env!("CARGO_TARGET_TMPDIR");
    assert!(failed.is_empty(), "{failed:#?}, histograms in {histograms}");
}

#[test]
fn every_row_has_its_own_name() {
    let tests = sampling_tests();
    let names: HashSet<&str> = tests.iter().map(|test| test.name.as_str()).collect();
    assert_eq!(names.len(), tests.len());
}

fn cosine_against(pdf: fn(DVec3) -> f64) -> f64 {
    let drawn = |u: [f64; 4]| Some(Hemisphere::Cosine.sample([u[0], u[1]]));
    chi_square_test(
        &SamplingTest::over_hemisphere("cosine against something", drawn, pdf),
        POINTS,
        0,
    )
    .p_value
}

#[test]
fn a_wrong_density_is_found() {
    assert!(cosine_against(|w| w.z / PI) > 1e-3);
    assert!(cosine_against(|_| 1.0 / TAU) < 1e-9);
    // An error of one percent is seen as well, be it too much or too little.
    assert!(cosine_against(|w| 1.01 * w.z / PI) < 1e-9);
    assert!(cosine_against(|w| 0.99 * w.z / PI) < 1e-9);
    // So are points where there should be none, and densities that are no numbers.
    assert!(cosine_against(|w| if w.x > 0.99 { 0.0 } else { w.z / PI }) < 1e-9);
    assert!(cosine_against(|_| f64::NAN) < 1e-9);
}

#[test]
fn wrong_probabilities_and_wrong_areas_are_found() {
    let choice = |probabilities: [f64; 3]| {
        let thirds = |u: [f64; 4]| Some((u[0] * 3.0) as usize);
        chi_square_test(
            &SamplingTest::over_indices("thirds", probabilities.into(), thirds),
            POINTS,
            0,
        )
        .p_value
    };
    assert!(choice([1.0 / 3.0; 3]) > 1e-3);
    assert!(choice([0.34, 0.33, 0.33]) < 1e-9);
    let square = |side: f64, pdf: f64| {
        let uniform = move |u: [f64; 4]| Some([side * u[0], side * u[1]]);
        let range = [[0.0; 2], [2.0; 2]];
        chi_square_test(
            &SamplingTest::over_rectangle("square", range, uniform, move |_| pdf),
            POINTS,
            0,
        )
        .p_value
    };
    assert!(square(2.0, 0.25) > 1e-3);
    assert!(square(2.0, 0.24) < 1e-9, "too little");
    assert!(square(1.9, 0.25) < 1e-9, "too small a square");
    assert!(square(2.1, 0.25) < 1e-9, "points outside");
}

#[test]
fn directions_over_the_whole_sphere_are_judged() {
    let both = |below: f64| {
        let sample = move |u: [f64; 4]| {
            let w = Hemisphere::UniformSolidAngle.sample([u[0], u[1]]);
            Some(if u[2] < below { DVec3::new(w.x, w.y, -w.z) } else { w })
        };
        chi_square_test(&SamplingTest::over_sphere("both sides", sample, |_| 0.5 / TAU), POINTS, 0)
            .p_value
    };
    assert!(both(0.5) > 1e-3);
    assert!(both(0.52) < 1e-9);
}

fn write_histogram(name: &str, histogram: &Histogram) {
    let mut text = format!("# {name}\n# row column expected observed\n");
    let columns = histogram.cells[1];
    for (i, (e, o)) in histogram.expected.iter().zip(&histogram.observed).enumerate() {
        writeln!(text, "{} {} {e} {o}", i / columns, i % columns).expect("a string has room");
    }
    let name: String = name.chars().map(|c| if c.is_alphanumeric() { c } else { '-' }).collect();
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("chi2-{name}.txt"));
    std::fs::write(path, text).expect("the target directory can be written to");
}
