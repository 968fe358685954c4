//! Reads `[render]`, including the sample count of the paper's sub-pixels.

use crate::scene::keys::render as keys;
use crate::scene::settings::{
    IntegratorKind, IntegratorSettings, PaperSettings, PathTermination, PathTerminationKind,
    RenderSettings, SamplerKind,
};
use crate::scene::toml::document::{Table, TableValues};
use crate::scene::value_types::Span;

pub(super) fn read(table: &Table<'_>, integrator_of_file: Option<&str>) -> RenderSettings {
    let usual = RenderSettings::default();
    let kind = table.get(&keys::INTEGRATOR).unwrap_or_default();
    let estimator = table.get(&keys::ESTIMATOR).unwrap_or_default();
    let given = table.get(&keys::SAMPLES);
    let seed = table.get(&keys::SEED).map_or(usual.seed, i64::unsigned_abs);
    let sampler = table.get(&keys::SAMPLER).unwrap_or(default_sampler(kind));
    let paper = table.optional_section("paper", |inner| {
        let mut paper = read_paper(inner);
        if kind == IntegratorKind::Paper {
            paper.samples = reconcile_samples(table, inner, &paper, given, integrator_of_file);
        }
        paper
    });
    let shadows = table
        .optional_section("raycast", |inner| inner.get(&keys::raycast::SHADOWS))
        .unwrap_or(false);
    let distance = table.optional_section("ambient_occlusion", |inner| {
        inner.get(&keys::ambient_occlusion::DISTANCE)
    });
    let many = given.unwrap_or(usual.samples_per_pixel);
    let (integrator, samples_per_pixel) = match kind {
        IntegratorKind::Path => (IntegratorSettings::Path, many),
        IntegratorKind::Direct => (IntegratorSettings::Direct, many),
        IntegratorKind::AmbientOcclusion => {
            (IntegratorSettings::AmbientOcclusion { distance }, many)
        }
        IntegratorKind::Normals => (IntegratorSettings::Normals, given.unwrap_or(1)),
        IntegratorKind::Paper => (IntegratorSettings::Paper(paper), total_samples(table, &paper)),
        IntegratorKind::Raycast => (IntegratorSettings::Raycast { shadows }, given.unwrap_or(1)),
    };
    let mut render =
        RenderSettings { integrator, estimator, samples_per_pixel, seed, sampler, ..usual };
    render.visit_keys(&mut TableValues(table));
    render
}

/// The paper's figures use independent random numbers.
fn default_sampler(kind: IntegratorKind) -> SamplerKind {
    if kind == IntegratorKind::Paper { SamplerKind::Independent } else { SamplerKind::Sobol }
}

fn read_paper(table: &Table<'_>) -> PaperSettings {
    let usual = PaperSettings::default();
    let subpixels = table.get(&keys::paper::SUBPIXELS).unwrap_or(usual.subpixels);
    let samples = table.get(&keys::paper::SAMPLES).unwrap_or(usual.samples);
    let hemisphere = table.get(&keys::paper::HEMISPHERE).unwrap_or_default();
    let stop = table.get(&keys::paper::STOP).unwrap_or_default();
    let threshold = table.get(&keys::paper::THRESHOLD);
    if stop != PathTerminationKind::Threshold && table.span_of("threshold").is_some() {
        let path = table.path_to("threshold");
        let message = format!("`{path}` needs `stop = \"threshold\"`");
        table.error_at("threshold", message, None);
    }
    let stop = match stop {
        PathTerminationKind::Roulette => PathTermination::Roulette,
        PathTerminationKind::Depth => PathTermination::Depth,
        PathTerminationKind::Threshold => PathTermination::Threshold(threshold.unwrap_or(0.01)),
    };
    let miss = table.get(&keys::paper::MISS).unwrap_or_default();
    let jitter = table.get(&keys::paper::JITTER).unwrap_or(usual.jitter);
    PaperSettings { subpixels, samples, hemisphere, stop, miss, jitter }
}

/// The number of paths per sub-pixel, from all sample settings.
///
/// `samples_per_pixel` is binding if it was meant for this integrator: in an option, or in a file
/// that selects it; an option wins over the sub-pixels' samples of a file. In a file that selects
/// another integrator it is followed if possible.
fn reconcile_samples(
    render: &Table<'_>,
    table: &Table<'_>,
    paper: &PaperSettings,
    given: Option<u32>,
    integrator_of_file: Option<&str>,
) -> u32 {
    let (Some(given), Some(span)) = (given, render.span_of("samples_per_pixel")) else {
        return paper.samples;
    };
    let report = render.diagnostics();
    let binds = integrator_of_file == Some("paper") || !report.is_in_file(&span);
    let subpixels = paper.subpixels.pow(2);
    let is_multiple = given % subpixels == 0;
    let samples_span = table.span_of("samples");
    let k = paper.subpixels;
    if !is_multiple && binds {
        let message = format!(
            "`render.samples_per_pixel` must be a multiple of the {k} x {k} sub-pixels, not {given}"
        );
        let below = given / subpixels * subpixels;
        let near = match below {
            0 => format!("try {subpixels}"),
            _ => format!("try {below} or {}", below.saturating_add(subpixels)),
        };
        render.error_at("samples_per_pixel", message, near);
        return paper.samples;
    }
    let is_of_file = |span: &Span| report.is_in_file(span);
    let wins = !is_of_file(&span) && samples_span.as_ref().is_some_and(is_of_file);
    match samples_span {
        None if is_multiple => given / subpixels,
        Some(_) if wins => given / subpixels,
        Some(samples_span) if binds && u64::from(given) != paper.samples_per_pixel() => {
            let message = format!(
                "`render.samples_per_pixel` is {given}, but {k} x {k} sub-pixels of {} samples \
                 make {}",
                paper.samples,
                paper.samples_per_pixel()
            );
            let help = format!(
                "`render.paper.samples` is set in {}; remove one of them",
                report.describe_span(&samples_span)
            );
            render.error_at("samples_per_pixel", message, help);
            paper.samples
        }
        _ => paper.samples,
    }
}

/// Samples per pixel as u32, or an error.
fn total_samples(table: &Table<'_>, paper: &PaperSettings) -> u32 {
    let total = paper.samples_per_pixel();
    u32::try_from(total).unwrap_or_else(|_| {
        let message =
            format!("`render.paper` asks for {total} samples per pixel, more than 2^32 - 1");
        table.error_at("paper", message, None);
        table.mark_invalid("samples_per_pixel");
        u32::MAX
    })
}
