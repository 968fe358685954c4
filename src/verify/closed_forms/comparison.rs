//! Renders a closed-form scene with independent seeds and compares the images with the exact
//! solution.
//!
//! Pixels are grouped so that each group receives an equal share of the light. A single pixel,
//! above all a dark one, has so few samples that hit light that its mean is far from normally
//! distributed. The mean of each group over the seeds is compared with the exact mean over the same
//! pixels by Student's t-test, and so is the mean of the whole image. The p-value of the check is
//! the smallest one times the number of tests. Pixels without any light form another group: they
//! must be black.
//!
//! A stratified or low-discrepancy sampler makes some images all alike: the same number of samples
//! hits the emitter in each, except for a rare event that no seed has shown. The standard error is
//! then too small. A deviation is therefore also excused with the probability that none of the
//! pixels of any seed shows the event (one differing sample) that would explain it.

use std::path::Path;

use tempfile::TempDir;

use crate::accel::{Accel, Backend, BuildOptions};
use crate::draw::{CellColors, Cells};
use crate::error::{Error, Result};
use crate::film::Aov;
use crate::image_io::{Picture, temp_folder};
use crate::job::render_with_accel;
use crate::scene::{Override, PreparedScene, read_text};
use crate::task::CancelToken;
use crate::verify::check::{CheckMeasurement, Effort, TestStatistic, seed};
use crate::verify::statistics::{MeanEstimate, ROUNDING};

use super::{ClosedForm, RenderVariant};

/// Independent renders behind every standard error.
const SEEDS: u64 = 32;
/// Pixel groups with equal shares of the image's light.
const GROUPS: usize = 12;
/// Quadrature nodes over a pixel, along each side.
const NODES: usize = 4;
/// Difference, in standard errors, drawn in full colour.
const FULL_COLOR: f64 = 4.0;

pub(super) fn measure(
    form: &ClosedForm,
    variant: &RenderVariant,
    backend: Backend,
    effort: Effort,
    name: &str,
    cancel: &CancelToken,
) -> Result<CheckMeasurement> {
    let folder = table_folder(form)?;
    let mut prepared = prepared(form, variant, effort, folder.as_ref())?;
    let build = BuildOptions { threads: 1, cancel: cancel.clone(), ..Default::default() };
    let accel = backend.build(prepared.scene().spheres(), &build)?;
    let solution = (form.solution)(&prepared, NODES);
    let render = |index: u64| {
        prepared.set_seed(seed(name, index));
        picture(&prepared, accel.as_ref(), cancel)
    };
    let pictures: Vec<Picture> = (0..SEEDS).map(render).collect::<Result<_>>()?;
    let samples = prepared.render_settings().samples_per_pixel;
    let values: Vec<PixelValues> =
        pictures.iter().map(|picture| PixelValues::of(picture, form)).collect();
    Ok(compare(&values, &solution, samples))
}

/// Writes the scene's tables, which are embedded in the program, to a folder, since scenes read
/// theirs from one.
fn table_folder(form: &ClosedForm) -> Result<Option<TempDir>> {
    if form.tables.is_empty() {
        return Ok(None);
    }
    let io_error = |error| Error::file("write in", &std::env::temp_dir(), error);
    let folder = temp_folder()?;
    for (name, bytes) in form.tables {
        std::fs::write(folder.path().join(name), bytes).map_err(io_error)?;
    }
    Ok(Some(folder))
}

fn prepared(
    form: &ClosedForm,
    variant: &RenderVariant,
    effort: Effort,
    folder: Option<&TempDir>,
) -> Result<PreparedScene> {
    let samples = form.samples * effort.select([2, 8, 32]);
    let sample_override = format!("render.samples_per_pixel={samples}");
    let overrides: Vec<Override> =
        variant.overrides().chain([&*sample_override]).filter_map(parse_override).collect();
    let file = format!("scenes/verify/{}.toml", form.name);
    let folder = folder.map_or(Path::new(""), TempDir::path);
    let (scene, settings) = read_text(&file, form.scene_toml, folder, &overrides)?.build()?;
    PreparedScene::new(&scene, settings)
}

fn parse_override(pair: &str) -> Option<Override> {
    let (key, value) = pair.split_once('=')?;
    Some(Override::new(key, value))
}

fn picture(prepared: &PreparedScene, accel: &dyn Accel, cancel: &CancelToken) -> Result<Picture> {
    let rendered = render_with_accel(prepared, accel, &Aov::DEFAULT, cancel)?;
    cancel.check()?;
    Ok(rendered.picture)
}

/// An image reduced to one value per pixel: the weighted mean of its channels.
struct PixelValues {
    width: usize,
    pixels: Vec<f64>,
}

impl PixelValues {
    fn of(picture: &Picture, form: &ClosedForm) -> Self {
        let value = |pixel| picture.beauty(pixel).as_dvec3().dot(form.channels.into());
        Self { width: picture.width, pixels: (0..picture.len()).map(value).collect() }
    }
}

fn compare(pictures: &[PixelValues], solution: &[Option<f64>], samples: u32) -> CheckMeasurement {
    let groups = groups(solution);
    let all: Vec<usize> = groups.iter().flatten().copied().collect();
    let tests = groups.iter().chain([&all]);
    let smallest =
        tests.map(|group| p_value(group, pictures, solution, samples)).fold(1.0, f64::min);
    let p = (smallest * (groups.len() + 1) as f64).min(1.0);
    let (found, expected) = (seed_mean(&all, pictures), mean_solution(&all, solution));
    let worst = groups
        .iter()
        .map(|group| seed_mean(group, pictures).t(mean_solution(group, solution)).abs());
    let detail = format!(
        "{:.6} ± {:.6}, exact {expected:.6}: t = {:.2}; the largest |t| of {} groups {:.2}; \
         {:.1e} samples",
        found.mean,
        found.standard_error,
        found.t(expected),
        groups.len(),
        worst.fold(0.0, f64::max),
        (pictures.len() * solution.len()) as f64 * f64::from(samples)
    );
    CheckMeasurement::new(TestStatistic::PValue(p), detail).with_images(figures(pictures, solution))
}

/// Groups the compared pixels: the black ones, and the others in row-major order, cut whenever
/// another share of the light is full.
fn groups(solution: &[Option<f64>]) -> Vec<Vec<usize>> {
    let is_lit = |pixel: &usize| solution[*pixel].is_some_and(|light| light > 0.0);
    let compared = (0..solution.len()).filter(|&pixel| solution[pixel].is_some());
    let (lit, black): (Vec<usize>, Vec<usize>) = compared.partition(is_lit);
    let total: f64 = lit.iter().filter_map(|&pixel| solution[pixel]).sum();
    let mut groups = vec![Vec::new(); GROUPS];
    let mut accumulated = 0.0;
    for pixel in lit {
        let group = (GROUPS as f64 * accumulated / total) as usize;
        groups[group.min(GROUPS - 1)].push(pixel);
        accumulated += solution[pixel].unwrap_or_default();
    }
    groups.push(black);
    groups.retain(|group| !group.is_empty());
    groups
}

/// The p-value of a group: by Student's t-test, or by the event that no seed has shown.
fn p_value(
    group: &[usize],
    pictures: &[PixelValues],
    solution: &[Option<f64>],
    samples: u32,
) -> f64 {
    let (found, expected) = (seed_mean(group, pictures), mean_solution(group, solution));
    let t_p_value = found.p_value(expected);
    if !(found.mean.is_finite() && expected > 0.0) {
        return t_p_value;
    }
    // The largest change one sample can make to its pixel's mean, and the fraction of pixels that
    // must see it to explain the deviation.
    let change = 2.0 * brightest(solution) / f64::from(samples);
    let fraction = ((found.mean - expected).abs() / change).min(1.0);
    let observations = (group.len() * pictures.len()) as f64;
    t_p_value.max(libm::exp(observations * libm::log1p(-fraction)))
}

/// Largest value of the exact solution.
fn brightest(solution: &[Option<f64>]) -> f64 {
    solution.iter().flatten().copied().fold(0.0, f64::max)
}

fn seed_mean(group: &[usize], pictures: &[PixelValues]) -> MeanEstimate {
    let mean = |picture: &PixelValues| {
        group.iter().map(|&pixel| picture.pixels[pixel]).sum::<f64>() / group.len() as f64
    };
    MeanEstimate::from_values(&pictures.iter().map(mean).collect::<Vec<_>>())
}

fn mean_solution(group: &[usize], solution: &[Option<f64>]) -> f64 {
    group.iter().filter_map(|&pixel| solution[pixel]).sum::<f64>() / group.len() as f64
}

/// The rendered image, the exact solution, and their difference.
fn figures(pictures: &[PixelValues], solution: &[Option<f64>]) -> Vec<Cells> {
    let width = pictures[0].width;
    let pixels: Vec<MeanEstimate> =
        (0..solution.len()).map(|pixel| seed_mean(&[pixel], pictures)).collect();
    let exact: Vec<f64> = solution.iter().map(|value| value.unwrap_or(f64::NAN)).collect();
    let rendered: Vec<f64> = pixels.iter().map(|pixel| pixel.mean).collect();
    let brightest = brightest(solution);
    let light = CellColors::Light(if brightest > 0.0 { brightest } else { 1.0 });
    // A pixel that hit no light has a standard error of zero. Use at least a quarter of the typical
    // error.
    let sum_of_squares: f64 = pixels.iter().map(|pixel| pixel.standard_error.powi(2)).sum();
    let typical_error = (sum_of_squares / pixels.len() as f64).sqrt();
    let deviation = |(pixel, &exact): (&MeanEstimate, &f64)| {
        let error = pixel.standard_error.max(0.25 * typical_error).max(ROUNDING * exact.abs());
        if pixel.mean == exact { 0.0 } else { (pixel.mean - exact) / error }
    };
    let difference = pixels.iter().zip(&exact).map(deviation).collect();
    let figure = |caption: &str, values, colors| Cells {
        caption: caption.to_owned(),
        width,
        values,
        colors,
    };
    vec![
        figure("rendered", rendered, light),
        figure("exact", exact, light),
        figure(
            "difference: red too bright, blue too dark, full colour at 4 standard errors",
            difference,
            CellColors::Signed(FULL_COLOR),
        ),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verify::check::Effort;
    use crate::verify::closed_forms::variants::combinations;
    use crate::verify::closed_forms::{CLOSED_FORMS, check};

    #[test]
    fn the_answers_do_not_depend_on_the_nodes_of_their_quadratures() {
        for form in CLOSED_FORMS {
            let (variant, _) = combinations(form, Effort::Quick, &[Backend::Native]).remove(0);
            let folder = table_folder(form).expect("a folder");
            let prepared = prepared(form, &variant, Effort::Quick, folder.as_ref());
            let prepared = prepared.unwrap_or_else(|e| panic!("{}: {e}", form.name));
            let [coarse, fine] = [NODES, 2 * NODES].map(|nodes| (form.solution)(&prepared, nodes));
            let brightest = fine.iter().flatten().copied().fold(0.0, f64::max);
            let compared = fine.iter().flatten().count();
            assert!(compared >= fine.len() / 3, "{}: {compared} of {}", form.name, fine.len());
            for (coarse, fine) in coarse.iter().flatten().zip(fine.iter().flatten()) {
                let deviation = (coarse - fine).abs();
                assert!(deviation <= 2e-5 * brightest, "{}: {coarse} {fine}", form.name);
            }
        }
    }

    #[test]
    fn an_answer_that_is_wrong_by_two_percent_fails() {
        static WRONG: std::sync::OnceLock<ClosedForm> = std::sync::OnceLock::new();
        let right = CLOSED_FORMS.iter().find(|form| form.name == "sphere-light").expect("is there");
        let wrong = WRONG.get_or_init(|| ClosedForm {
            solution: |scene, nodes| {
                let right = CLOSED_FORMS.iter().find(|form| form.name == "sphere-light");
                let solution = (right.expect("is there").solution)(scene, nodes);
                solution.into_iter().map(|value| Some(1.02 * value?)).collect()
            },
            ..*right
        });
        let backend = Backend::Native;
        let (variant, _) = combinations(right, Effort::Quick, &[backend]).remove(0);
        let passed = |form: &'static ClosedForm| {
            let outcome =
                check(form, &variant, backend, Effort::Quick).run(&CancelToken::default());
            outcome.expect("runs").passed
        };
        assert!(passed(right));
        assert!(!passed(wrong));
    }
}
