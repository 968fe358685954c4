//! Sampling of unit-square warps, pixel filters and discrete distributions.

use crate::sampling::{DiscreteDistribution, Filter, FilterKind, Hemisphere, hemisphere};

use super::SamplingTest;

pub(super) fn tests() -> Vec<SamplingTest> {
    let mut tests = Vec::new();
    for hemisphere in [Hemisphere::Cosine, Hemisphere::UniformSolidAngle, Hemisphere::UniformAngle]
    {
        tests.push(SamplingTest::over_hemisphere(
            format!("hemisphere {hemisphere:?}"),
            move |u| Some(hemisphere.sample([u[0], u[1]])),
            move |w| hemisphere.pdf(w.z),
        ));
    }
    for (exponent, up_to) in [(1.0, 1.6), (20.0, 1.6), (1000.0, 0.2)] {
        tests.push(power_cosine(exponent, up_to));
    }
    for (name, kind, radius) in [
        ("box", FilterKind::Box, 0.5),
        ("tent", FilterKind::Tent, 1.0),
        ("gaussian", FilterKind::Gaussian, 1.5),
        ("blackman-harris", FilterKind::BlackmanHarris, 2.0),
    ] {
        tests.push(filter(name, kind, radius));
    }
    tests.push(discrete());
    tests
}

fn power_cosine(exponent: f64, up_to: f64) -> SamplingTest {
    SamplingTest::over_cap(
        format!("power cosine, exponent {exponent}"),
        up_to.min(std::f64::consts::FRAC_PI_2),
        move |u| Some(hemisphere::sample_power_cosine(exponent, [u[0], u[1]])),
        move |w| hemisphere::power_cosine_pdf(exponent, w.z),
    )
}

fn filter(name: &str, kind: FilterKind, radius: f64) -> SamplingTest {
    let filter = Filter::new(kind, radius);
    let density = filter.clone();
    SamplingTest::over_rectangle(
        format!("filter {name}"),
        [[-radius; 2], [radius; 2]],
        move |u| Some(filter.sample([u[0], u[1]])),
        move |at| density.pdf(at),
    )
}

fn discrete() -> SamplingTest {
    let distribution =
        DiscreteDistribution::new([0.1, 3.0, 0.0, 0.7, 1e-3]).expect("valid weights");
    let probabilities = (0..5).map(|i| distribution.pmf(i)).collect();
    SamplingTest::over_indices("discrete choice", probabilities, move |u| {
        Some(distribution.sample(u[0]))
    })
}
