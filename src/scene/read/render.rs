//! `[render]`, and how many samples the paper's sub-pixels make of it.

use crate::math::MAX_COORDINATE;
use crate::scene::description::{
    Estimator, Hemisphere, Integrator, LightChoice, Miss, Paper, Render, SamplerKind, Stop,
};
use crate::scene::document::Table;
use crate::scene::values::{Choice, Flag, Limits, Number, Whole};

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Path,
    Direct,
    AmbientOcclusion,
    Normals,
    Paper,
    Raycast,
}

#[derive(Clone, Copy, PartialEq)]
enum StopKind {
    Roulette,
    Depth,
    Threshold,
}

const INTEGRATORS: Choice<Kind> = Choice(&[
    ("path", Kind::Path),
    ("direct", Kind::Direct),
    ("ambient-occlusion", Kind::AmbientOcclusion),
    ("normals", Kind::Normals),
    ("paper", Kind::Paper),
    ("raycast", Kind::Raycast),
]);

const ESTIMATORS: Choice<Estimator> =
    Choice(&[("mis", Estimator::Mis), ("light", Estimator::Light), ("bsdf", Estimator::Bsdf)]);

const SAMPLERS: Choice<SamplerKind> = Choice(&[
    ("sobol", SamplerKind::Sobol),
    ("independent", SamplerKind::Independent),
    ("stratified", SamplerKind::Stratified),
]);

const HEMISPHERES: Choice<Hemisphere> = Choice(&[
    ("cosine", Hemisphere::Cosine),
    ("uniform-solid-angle", Hemisphere::UniformSolidAngle),
    ("uniform-angle", Hemisphere::UniformAngle),
]);

const STOPS: Choice<StopKind> = Choice(&[
    ("roulette", StopKind::Roulette),
    ("depth", StopKind::Depth),
    ("threshold", StopKind::Threshold),
]);

const MISSES: Choice<Miss> = Choice(&[("background", Miss::Background), ("redraw", Miss::Redraw)]);

const LIGHT_CHOICES: Choice<LightChoice> = Choice(&[
    ("hierarchy", LightChoice::Hierarchy),
    ("power", LightChoice::Power),
    ("uniform", LightChoice::Uniform),
]);

/// The most sub-pixels along one side of a pixel.
const FINEST: u32 = 256;

/// Samples of a pixel where the scene does not say.
const USUAL_SAMPLES: u32 = 64;

/// Paths of a sub-pixel where the scene does not say; the paper's number.
const USUAL_PATHS: u32 = 4;

pub(super) fn read(table: &Table<'_>, integrator_of_file: Option<&str>) -> Option<Render> {
    let kind = table.optional("integrator", INTEGRATORS).unwrap_or(Kind::Path);
    let estimator = table.optional("estimator", ESTIMATORS).unwrap_or_default();
    let given = table.optional("samples_per_pixel", Whole(1..=u32::MAX));
    let max_depth = table.optional("max_depth", Whole(1..=u32::MAX));
    let clamp_indirect =
        table.optional("clamp_indirect", Number(Limits::AboveTo(0.0, super::BRIGHTEST)));
    let seed = table.optional("seed", Whole(0..=i64::MAX)).unwrap_or(0);
    // The paper's figures show independent numbers.
    let usual = if kind == Kind::Paper { SamplerKind::Independent } else { SamplerKind::Sobol };
    let sampler = table.optional("sampler", SAMPLERS).unwrap_or(usual);
    let light_choice = table.optional("light_choice", LIGHT_CHOICES).unwrap_or_default();
    let paper = table.optional_section("paper", |inner| {
        let mut paper = read_paper(inner);
        if kind == Kind::Paper {
            demand_depth(table, inner, &paper);
            paper.samples = reconcile(table, inner, &paper, given, integrator_of_file);
        }
        Some(paper)
    })?;
    let shadows = table.optional_section("raycast", |inner| {
        Some(inner.optional("shadows", Flag).unwrap_or(false))
    })?;
    let distance = table.optional_section("ambient_occlusion", |inner| {
        let distance = Number(Limits::AboveTo(0.0, MAX_COORDINATE));
        Some(inner.optional("distance", distance).unwrap_or(f64::INFINITY))
    })?;
    let many = given.unwrap_or(USUAL_SAMPLES);
    let (integrator, samples_per_pixel) = match kind {
        Kind::Path => (Integrator::Path, many),
        Kind::Direct => (Integrator::Direct, many),
        Kind::AmbientOcclusion => (Integrator::AmbientOcclusion { distance }, many),
        Kind::Normals => (Integrator::Normals, given.unwrap_or(1)),
        Kind::Paper => (Integrator::Paper(paper), counted(table, &paper)?),
        Kind::Raycast => (Integrator::Raycast { shadows }, given.unwrap_or(1)),
    };
    Some(Render {
        integrator,
        estimator,
        light_choice,
        samples_per_pixel,
        max_depth,
        clamp_indirect,
        seed: seed.unsigned_abs(),
        sampler,
    })
}

fn read_paper(table: &Table<'_>) -> Paper {
    let subpixels = table.optional("subpixels", Whole(1..=FINEST)).unwrap_or(2);
    let samples = table.optional("samples", Whole(1..=u32::MAX)).unwrap_or(USUAL_PATHS);
    let hemisphere = table.optional("hemisphere", HEMISPHERES).unwrap_or_default();
    let stop = table.optional("stop", STOPS).unwrap_or(StopKind::Roulette);
    let threshold = table.optional("threshold", Number(Limits::AboveTo(0.0, 1.0)));
    if stop != StopKind::Threshold && table.span_of("threshold").is_some() {
        let path = table.path_to("threshold");
        let message = format!("`{path}` means nothing without `stop = \"threshold\"`");
        table.report().add(table.wrong("threshold", message));
    }
    let stop = match stop {
        StopKind::Roulette => Stop::Roulette,
        StopKind::Depth => Stop::Depth,
        StopKind::Threshold => Stop::Threshold(threshold.unwrap_or(0.01)),
    };
    let miss = table.optional("miss", MISSES).unwrap_or_default();
    let jitter = table.optional("jitter", Number(Limits::FromTo(0.0, 1.0))).unwrap_or(1.0);
    Paper { subpixels, samples, hemisphere, stop, miss, jitter }
}

/// A path that only stops at a depth needs to know at which.
fn demand_depth(render: &Table<'_>, table: &Table<'_>, paper: &Paper) {
    if paper.stop == Stop::Depth && render.span_of("max_depth").is_none() {
        let message = "`render.paper.stop = \"depth\"` needs `render.max_depth`";
        let help = "add `max_depth = 6` to `[render]`".to_owned();
        render.report().add(table.wrong("stop", message).help(help));
    }
}

/// The paths of a sub-pixel, from all that is said of samples.
///
/// `samples_per_pixel` binds where it was meant for this integrator: in an option, or in a file that
/// asks for it. In a file that asks for another it is followed where it can be.
fn reconcile(
    render: &Table<'_>,
    table: &Table<'_>,
    paper: &Paper,
    given: Option<u32>,
    integrator_of_file: Option<&str>,
) -> u32 {
    let (Some(given), Some(span)) = (given, render.span_of("samples_per_pixel")) else {
        return paper.samples;
    };
    let report = render.report();
    let binds = integrator_of_file == Some("paper") || !report.is_in_file(&span);
    let subpixels = paper.subpixels.pow(2);
    let is_multiple = given % subpixels == 0;
    let samples_span = table.span_of("samples");
    let k = paper.subpixels;
    if !is_multiple && binds {
        let message = format!(
            "`render.samples_per_pixel` must be a multiple of the {k} x {k} sub-pixels, not {given}"
        );
        let near = (given / subpixels).max(1) * subpixels;
        report.add(render.wrong("samples_per_pixel", message).help(format!("try {near}")));
        return paper.samples;
    }
    match samples_span {
        None if is_multiple => given / subpixels,
        Some(samples_span) if binds && u64::from(given) != samples_of_pixel(paper) => {
            let message = format!(
                "`render.samples_per_pixel` is {given}, but {k} x {k} sub-pixels of {} samples \
                 make {}",
                paper.samples,
                samples_of_pixel(paper)
            );
            let help = format!(
                "`render.paper.samples` is set in {}; leave one of the two out",
                report.words_for(&samples_span)
            );
            report.add(render.wrong("samples_per_pixel", message).help(help));
            paper.samples
        }
        _ => paper.samples,
    }
}

fn samples_of_pixel(paper: &Paper) -> u64 {
    u64::from(paper.subpixels).pow(2) * u64::from(paper.samples)
}

/// The same as a u32, or a mistake.
fn counted(table: &Table<'_>, paper: &Paper) -> Option<u32> {
    let total = samples_of_pixel(paper);
    if let Ok(total) = u32::try_from(total) {
        return Some(total);
    }
    let message = format!("`render.paper` asks for {total} samples per pixel, more than 2^32 - 1");
    table.report().add(table.wrong("paper", message));
    None
}
