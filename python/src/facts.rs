//! Facts that Python asks for: options, keys, colour maps, elements, ticks.

use photosphere::appearance::{ColorMap, Element, Ticks, named_color};
use photosphere::cli::keywords as options;
use photosphere::color::srgb8_from_linear;
use photosphere::scene::keys;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Name, value (`None` for a flag), help, default and choices of every option of
/// `photosphere render`.
pub(crate) type KeywordFacts = (String, Option<String>, String, Option<String>, Vec<String>);

/// Lists the options of `photosphere render`.
#[pyfunction]
pub(crate) fn keywords() -> Vec<KeywordFacts> {
    let all = options::keywords().into_iter();
    all.map(|keyword| {
        let options::Keyword { name, value, help, default, choices } = keyword;
        (name, value, help, default, choices)
    })
    .collect()
}

/// The JSON schema of scene files, as text.
#[pyfunction]
pub(crate) fn schema() -> String {
    keys::schema().to_string()
}

/// 256 colours of a colour map in 8-bit sRGB.
#[pyfunction]
pub(crate) fn colormap(name: &str) -> PyResult<Vec<[u8; 3]>> {
    let map = ColorMap::named(name).ok_or_else(|| {
        let known: Vec<&str> = ColorMap::NAMES.iter().map(|(name, _)| *name).collect();
        let near = photosphere::names::did_you_mean(name, known.iter().copied());
        let near = near.map(|near| format!("; {near}")).unwrap_or_default();
        PyValueError::new_err(format!("there is no colour map `{name}`{near}"))
    })?;
    let color = |step: u8| map.linear(f64::from(step) / 255.0).to_array().map(srgb8_from_linear);
    Ok((0..=255).map(color).collect())
}

/// The linear colour of a name such as "white", or of "#102030"; `None` for other texts.
#[pyfunction]
pub(crate) fn color(text: &str) -> Option<[f32; 3]> {
    named_color(text).map(|color| color.to_array())
}

/// Covalent and van der Waals radius of an element in angstrom, and its colour in 8-bit sRGB.
#[pyfunction]
pub(crate) fn element(symbol: &str) -> Option<(f64, f64, [u8; 3])> {
    let element = Element::of_label(symbol)?;
    let color = element.color().to_array().map(srgb8_from_linear);
    Some((element.covalent_radius, element.vdw_radius_or_default(), color))
}

/// Values and labels of the ticks of a colour bar.
#[pyfunction]
pub(crate) fn ticks(low: f64, high: f64, log: bool, most: usize) -> (Vec<f64>, Vec<String>) {
    let ticks =
        if log { Ticks::logarithmic(low, high, most) } else { Ticks::linear(low, high, most) };
    let labels = ticks.labels();
    (ticks.values, labels)
}
