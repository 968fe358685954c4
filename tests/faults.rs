//! The suite finds mistakes: each deliberate one is switched on alone, and the check that is named
//! beside it must fail, which passes without. docs/verification.md shows the same table.
//!
//! Needs the feature `faults`: `cargo test --release --features faults --test faults`. A mistake is
//! switched on for the whole process, so there is one test function.

use std::collections::BTreeSet;
use std::path::Path;

use photosphere::accel::Backend;
use photosphere::fault::{Fault, switch_to};
use photosphere::task::CancelToken;
use photosphere::verify::all_checks_on;
use photosphere::verify::check::{CheckResult, Effort};

/// Which check finds which mistake: the first whose name begins so.
const FOUND_BY: &[(Fault, &str)] = &[
    (Fault::CosinePdfUniform, "hemisphere Cosine"),
    (Fault::AngleJacobianMissing, "hemisphere UniformAngle"),
    (Fault::PowerCosineNorm, "power cosine, exponent 20"),
    (Fault::PmfOffByOne, "discrete choice"),
    (Fault::FilterNotNormalized, "filter gaussian"),
    (Fault::ConeSmallAngle, "cone of a sphere 2 radii away"),
    (Fault::ConeUniformInAngle, "cone of a sphere 2 radii away"),
    (Fault::CapComplement, "cap of a sphere from afar"),
    (Fault::CapPdfWithoutCosine, "cap of a sphere from afar"),
    (Fault::ProjectedCapUniform, "projected cap of a sphere 3 radii away, 60 degrees"),
    (Fault::FarRootForNear, "occluder: path"),
    (Fault::NearRootForFar, "balls that overlap"),
    (Fault::ExitDistanceIgnored, "furnace: path"),
    (Fault::ExclusionLost, "sphere-light: path"),
    (Fault::EmitterOccludesItself, "sphere-light: path"),
    (Fault::NormalFacesAway, "furnace: path"),
    (Fault::SpheresRoundedToF32, "balls with narrow gaps"),
    (Fault::RayRoundedToF32, "clusters inside clusters"),
    (Fault::NotClosestHit, "a gas of balls"),
    (Fault::PrunedTooEarly, "a gas of balls"),
    (Fault::PacketConeTooNarrow, "a gas of balls"),
    (Fault::LambertWithoutPi, "sphere-light: path"),
    (Fault::CosineTwice, "furnace: path"),
    (Fault::LobePdfsSwapped, "bsdf phong, exponent 3"),
    (Fault::AlphaIsRoughness, "ggx normals, roughness 0.6, against the formula"),
    (Fault::HalfVectorJacobianLost, "ggx reflection, roughness 0.4"),
    (Fault::OnePolarization, "lamp-in-glass: path"),
    (Fault::RefractionJacobianLost, "bsdf glass, eta 1.50, roughness 0.6"),
    (Fault::HalfVectorEtaSwapped, "bsdf glass, eta 1.50, roughness 0.6"),
    (Fault::MultiscatterSampledByCosine, "light between facets, roughness 0.5"),
    (Fault::MultiscatterWrongSide, "both ways through glass, eta 1.50, roughness 1"),
    (Fault::CoatWithoutBaseAttenuation, "energy of principled white diffuse, coated"),
    (Fault::EtaSquaredDropped, "lamp-in-glass: path"),
    (Fault::IorSwapped, "lamp-in-glass: path"),
    (Fault::AbsorbedTwice, "lamp-in-dark-glass: path"),
    (Fault::MediumStackNotPopped, "glass-in-a-field: path"),
    (Fault::LightPmfUniform, "choice among three emitters"),
    (Fault::LightTreePmfHalf, "many-lamps: path"),
    (Fault::InsideEmitterPdfWithoutCosine, "light from inside an emitter"),
    (Fault::ConnectionSideSwapped, "connection through glass"),
    (Fault::ConnectionRootMissing, "connection through glass, reflected"),
    (Fault::ConnectionEtaSquaredMissing, "lamp-out-of-glass: path"),
    (Fault::ConnectionFresnelMissing, "lamp-out-of-glass: path"),
    (Fault::ConnectionMisForgotten, "wide-lamp-over-a-mirror: path"),
    (Fault::ConnectionWeightMissing, "wide-lamp-over-a-mirror: path"),
    (Fault::PixelCornerForCenter, "mirror-before-the-eye: path"),
    (Fault::FirstBlockDropped, "furnace: path"),
    (Fault::DividedByWrongCount, "sphere-light: paper"),
    (Fault::DirectCosineMissing, "sphere-light: path"),
    (Fault::BsdfMisWeightMissing, "sphere-light: path"),
    (Fault::MisWeightsSwapped, "sphere-light: path"),
    (Fault::RouletteUncompensated, "furnace: path"),
    (Fault::DepthOffByOne, "furnace-cut-short: path"),
    (Fault::RandomNumberReused, "sphere-light: paper"),
    (Fault::ShadowRayOpacityLost, "thin-occluder: path"),
    (Fault::PassedMediumLost, "fog: path"),
    (Fault::MisRecordLost, "fog: path"),
    (Fault::TrapEverywhere, "trapped-light: path"),
    (Fault::CatcherVisibilityLost, "shadow-catcher: path"),
    (Fault::CatcherWithoutCosine, "shadow-catcher: path"),
    (Fault::BackgroundCameraOnly, "glass-in-a-field: path"),
];

const HEADER: &str = "| fault | what is wrong | found by | statistic |";

#[test]
fn every_mistake_is_found_and_nothing_fails_without_one() {
    let listed: Vec<Fault> = FOUND_BY.iter().map(|(fault, _)| *fault).collect();
    assert_eq!(listed, Fault::ALL, "a check for each mistake, in their order");
    let mut wrong = Vec::new();
    let mut table = Vec::new();
    // Some checks find several mistakes; without any, once is enough.
    for check in FOUND_BY.iter().map(|(_, check)| *check).collect::<BTreeSet<_>>() {
        let without = run(check, None);
        if !without.passed {
            wrong.push(format!("{check} fails without a mistake: {}", without.detail));
        }
    }
    for &(fault, check) in FOUND_BY {
        let with = run(check, Some(fault));
        if with.passed {
            wrong.push(format!("{fault:?} is not found by {check}: {}", with.detail));
        }
        table.push(Row::new(fault, check, &with));
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert_documented(&table);
}

/// Runs a check with a mistake, or with none. The check is made anew each time: what it prepares,
/// it prepares with the mistake.
fn run(name: &str, fault: Option<Fault>) -> CheckResult {
    switch_to(fault);
    let checks = all_checks_on(Effort::Quick, &[Backend::Native]);
    let check = checks.iter().find(|check| check.name.starts_with(name));
    let check = check.unwrap_or_else(|| panic!("no check is called {name}"));
    let outcome = check.run(&CancelToken::default());
    switch_to(None);
    outcome.expect("the check runs")
}

/// A row of the documentation's table.
#[derive(Debug, PartialEq)]
struct Row {
    mistake: String,
    /// What is wrong, and the check that finds it.
    text: [String; 2],
    /// The check's statistic, in standard deviations or number of errors.
    statistic: f64,
    unit: String,
}

impl Row {
    fn new(fault: Fault, check: &str, outcome: &CheckResult) -> Self {
        Self {
            mistake: format!("`{fault:?}`"),
            text: [fault.breaks().to_owned(), check.to_owned()],
            statistic: outcome.statistic.round(),
            unit: if outcome.is_random { "sigma" } else { "errors" }.to_owned(),
        }
    }

    fn parse(line: &str) -> Option<Self> {
        let mut cells = line.trim_matches('|').split('|').map(|cell| cell.trim().to_owned());
        let (mistake, wrong, check) = (cells.next()?, cells.next()?, cells.next()?);
        let (statistic, unit) =
            cells.next()?.split_once(' ').map(|(n, u)| (n.parse(), u.into()))?;
        Some(Self { mistake, text: [wrong, check], statistic: statistic.ok()?, unit })
    }

    /// Returns true if both say the same, but for a factor of two in the statistic: it moves with
    /// the samples.
    fn agrees(&self, other: &Self) -> bool {
        let ratio = self.statistic / other.statistic;
        let alike = |row: &Self| (row.mistake.clone(), row.text.clone(), row.unit.clone());
        alike(self) == alike(other) && (0.5..=2.0).contains(&ratio)
    }

    fn line(&self) -> String {
        let Self { mistake, text: [wrong, check], statistic, unit } = self;
        format!("| {mistake} | {wrong} | {check} | {statistic} {unit} |")
    }
}

/// docs/verification.md has this very table.
fn assert_documented(table: &[Row]) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/verification.md");
    let document = std::fs::read_to_string(path).expect("the documentation can be read");
    let (_, after) = document.split_once(HEADER).unwrap_or(("", ""));
    let rows = after.trim_start().lines().skip(1).take_while(|line| line.starts_with('|'));
    let rows: Vec<Row> = rows.filter_map(Row::parse).collect();
    let agree = rows.len() == table.len() && rows.iter().zip(table).all(|(a, b)| a.agrees(b));
    let lines: Vec<String> = table.iter().map(Row::line).collect();
    assert!(
        agree,
        "docs/verification.md should say:\n{HEADER}\n|---|---|---|---|\n{}",
        lines.join("\n")
    );
}
