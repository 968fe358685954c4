//! The colours of particles.

use std::collections::BTreeSet;

use rayon::prelude::*;

use crate::color::{Rgb, linear_from_srgb};
use crate::math::DVec3;
use crate::names::did_you_mean;
use crate::particles::{Column, ColumnData, Particles, Role};
use crate::task::pages::collect;

use super::color_map::ColorMap;
use super::doubts::Missing;
use super::element::Element;
use super::elements::particle_elements;
use super::expression::Expression;
use super::failure::AppearanceError;
use super::named_color::{color_names, named_color};
use super::options::{Appearance, ColorChoice};
use super::palette::palette;
use super::particle_columns::ParticleColumns;
use super::radii::quoted;
use super::value_range::{RangeChoice, RangeEnd, ValueRange};

/// Colours of all particles, in linear Rec. 709.
#[derive(Clone, Debug, PartialEq)]
pub enum Colors {
    /// One for all.
    Constant(Rgb),
    /// One for each.
    Each(Vec<[f32; 3]>),
}

/// What the colours mean.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Legend {
    /// Nothing.
    #[default]
    Nothing,
    /// Categories with their names and colours.
    Categories {
        /// The name of the column.
        title: String,
        /// Names and linear colours, in order.
        entries: Vec<(String, Rgb)>,
    },
    /// Numbers.
    Range {
        /// The column or expression.
        title: String,
        /// The map.
        map: ColorMap,
        /// The numbers at its ends.
        range: ValueRange,
        /// True for the lower and the upper end of the map if particles have numbers beyond it.
        exceeded: [bool; 2],
    },
}

impl Legend {
    /// The share of a picture's width that it takes at the right; 0 if nothing is drawn.
    pub fn room(&self) -> f64 {
        match self {
            Self::Range { .. } => 0.12,
            Self::Categories { entries, .. } if entries.len() > 1 => 0.07,
            Self::Categories { .. } | Self::Nothing => 0.0,
        }
    }
}

/// The colour of numbers that are no numbers, and of atoms without a known element.
const UNKNOWN: [f32; 3] = [0.3, 0.3, 0.3];

/// What is wrong with a value that is missing.
const NO_NUMBER: &str = "no number";

/// The colour of particles of which nothing is known: sRGB (111, 155, 196).
const PLAIN: &str = "#6f9bc4";

/// Integers with more values than this are numbers, not categories.
const MAX_CATEGORIES: usize = 64;

/// What the options choose, with everything automatic resolved.
pub(super) struct Coloring {
    pub(super) colors: Colors,
    pub(super) legend: Legend,
    pub(super) choice: ColorChoice,
    /// The range, if numbers are mapped.
    pub(super) range: Option<RangeChoice>,
    /// The particles whose colour is not known.
    pub(super) unknown: Option<UnknownColors>,
}

/// Particles whose colour is not known.
pub(super) struct UnknownColors {
    pub(super) missing: Missing,
    /// What their colour depends on, and what is wrong with it.
    pub(super) what: String,
    pub(super) flaw: &'static str,
}

/// The colours that the options choose.
///
/// # Errors
/// If a column is missing, or no number can be mapped.
pub(super) fn colors(
    particles: &Particles,
    options: &Appearance,
) -> Result<Coloring, AppearanceError> {
    let choice = resolve(particles, &options.color);
    let plain = |colors, legend| {
        Ok(Coloring { colors, legend, choice: choice.clone(), range: None, unknown: None })
    };
    match &choice {
        ColorChoice::Rgb => {
            let (colors, unknown) = of_file(particles)?;
            Ok(Coloring { unknown, ..plain(colors, Legend::Nothing)? })
        }
        ColorChoice::Position => plain(of_position(particles), Legend::Nothing),
        ColorChoice::Element => {
            let (colors, legend) = of_elements(particles)?;
            plain(colors, legend)
        }
        ColorChoice::Type => {
            let Some(column) = particles.role(Role::Type) else {
                return Err(missing(particles, "has no column of types"));
            };
            let (colors, legend) = of_categories(column, particles.len());
            plain(colors, legend)
        }
        ColorChoice::Auto | ColorChoice::AutoOr(_) => {
            plain(Colors::Constant(Rgb::splat(0.5)), Legend::Nothing)
        }
        ColorChoice::Named(text) => match named_color(text) {
            Some(color) if particles.column(text).is_none() => {
                plain(Colors::Constant(color), Legend::Nothing)
            }
            _ => of_column_or_expression(particles, text, options),
        },
    }
}

/// Resolves `auto`.
fn resolve(particles: &Particles, choice: &ColorChoice) -> ColorChoice {
    let otherwise = match choice {
        ColorChoice::Auto => PLAIN,
        ColorChoice::AutoOr(otherwise) => otherwise,
        _ => return choice.clone(),
    };
    let has = |role| particles.role(role).is_some();
    if [Role::Red, Role::Green, Role::Blue].into_iter().all(has) {
        return ColorChoice::Rgb;
    }
    if particle_elements(particles).is_some() {
        return ColorChoice::Element;
    }
    match particles.role(Role::Type) {
        Some(types) if is_varied(types) => ColorChoice::Type,
        _ => ColorChoice::from(otherwise.to_owned()),
    }
}

/// Returns true if a column has at least two values.
fn is_varied(column: &Column) -> bool {
    match &column.data {
        ColumnData::Text(words) => words.names.len() > 1,
        data => (1..data.len()).any(|row| data.number(row) != data.number(0)),
    }
}

fn missing(particles: &Particles, what: &str) -> AppearanceError {
    AppearanceError::new("color", format!("`{}` {what}", particles.path.display()))
        .with_help("use auto, a column or the name of a colour".to_owned())
}

fn of_file(particles: &Particles) -> Result<(Colors, Option<UnknownColors>), AppearanceError> {
    let columns: Vec<&Column> = [Role::Red, Role::Green, Role::Blue]
        .into_iter()
        .filter_map(|role| particles.role(role))
        .collect();
    let [red, green, blue] = columns[..] else {
        return Err(missing(particles, "has no red, green and blue"));
    };
    let largest = |column: &Column| column.range().map_or(0.0, |[_, high]| high);
    let is_integer =
        matches!(red.data, ColumnData::U8(_) | ColumnData::I32(_) | ColumnData::I64(_));
    let most = largest(red).max(largest(green)).max(largest(blue));
    let white = if is_integer || most > 1.0 { 255.0 } else { 1.0 };
    let linear = |column: &Column, row: usize| {
        let value = (column.number(row) / white).clamp(0.0, 1.0);
        linear_from_srgb(value as f32)
    };
    let is_unknown =
        |row: usize| [red, green, blue].iter().any(|column| column.number(row).is_nan());
    let color = |row: usize| match is_unknown(row) {
        true => UNKNOWN,
        false => [red, green, blue].map(|column| linear(column, row)),
    };
    let missing = Missing::find(particles.len(), is_unknown);
    let what = || [red, green, blue].map(|column| format!("`{}`", column.name)).join(" or ");
    let unknown = missing.map(|missing| UnknownColors { missing, what: what(), flaw: NO_NUMBER });
    Ok((Colors::Each(collect((0..particles.len()).into_par_iter().map(color))), unknown))
}

/// Red, green and blue grow along x, y and z. The longest side of the bounding box sets the scale,
/// and colours lie between a dark and a light one so that form stays visible.
fn of_position(particles: &Particles) -> Colors {
    let positions = &particles.positions;
    let nothing = || (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let rows = || (0..positions.len()).into_par_iter();
    let (low, high) = rows()
        .map(|row| positions.get(row))
        .fold(nothing, |(low, high), p| (low.min(p), high.max(p)))
        .reduce(nothing, |(a, b), (c, d)| (a.min(c), b.max(d)));
    let side = (high - low).max_element().max(f64::MIN_POSITIVE);
    let middle = 0.5 * (low + high);
    let color = |row: usize| {
        let at = (positions.get(row) - middle) / side + 0.5;
        let at = at.clamp(DVec3::splat(0.001), DVec3::ONE);
        (at / at.length()).to_array().map(|x| linear_from_srgb(x as f32))
    };
    Colors::Each(collect(rows().map(color)))
}

fn of_elements(particles: &Particles) -> Result<(Colors, Legend), AppearanceError> {
    let Some(elements) = particle_elements(particles) else {
        return Err(missing(particles, "names no elements"));
    };
    let color = |kind: &Option<&Element>| kind.map_or(UNKNOWN, |e| e.color().to_array());
    let known: Vec<[f32; 3]> = elements.kinds.iter().map(color).collect();
    let rows = (0..particles.len()).into_par_iter();
    let colors = collect(rows.map(|row| known[elements.kind(row)]));
    let mut is_there = vec![false; elements.kinds.len()];
    (0..particles.len()).for_each(|row| is_there[elements.kind(row)] = true);
    let present = elements.kinds.iter().zip(is_there).filter(|(_, there)| *there);
    let mut present: Vec<&Element> = present.filter_map(|(kind, _)| *kind).collect();
    present.sort_by_key(|element| element.number);
    present.dedup();
    let entries = present.iter().map(|e| (e.symbol.to_owned(), e.color())).collect();
    Ok((Colors::Each(colors), Legend::Categories { title: String::new(), entries }))
}

/// One colour of the palette for each value of a column.
fn of_categories(column: &Column, rows: usize) -> (Colors, Legend) {
    let (names, index_of) = categories(column, rows);
    let entries = names.iter().map(|(name, index)| (name.clone(), palette(*index))).collect();
    let color = |row: usize| palette(index_of(row)).to_array();
    let colors = Colors::Each(collect((0..rows).into_par_iter().map(color)));
    (colors, Legend::Categories { title: column.name.clone(), entries })
}

/// The index of each row's category in the palette.
type CategoryOfRow<'a> = Box<dyn Fn(usize) -> usize + Sync + 'a>;

/// The categories of a column with their indices in the palette, and the index of each row. Types
/// that are small integers keep their colour, whichever of them are there.
fn categories(column: &Column, rows: usize) -> (Vec<(String, usize)>, CategoryOfRow<'_>) {
    if let ColumnData::Text(words) = &column.data {
        let mut order: Vec<usize> = (0..words.names.len()).collect();
        order.sort_by(|a, b| words.names[*a].cmp(&words.names[*b]));
        let names = order.iter().zip(0..).map(|(word, i)| (words.names[*word].to_string(), i));
        let names = names.collect();
        let mut rank = vec![0; order.len()];
        order.iter().zip(0..).for_each(|(word, index)| rank[*word] = index);
        return (names, Box::new(move |row| rank[words.codes[row] as usize]));
    }
    let add = |mut values: BTreeSet<i64>, row| {
        values.insert(column.number(row) as i64);
        values
    };
    let values = (0..rows).into_par_iter().fold(BTreeSet::new, add);
    let values = values.reduce(BTreeSet::new, |a, b| a.into_iter().chain(b).collect());
    let first = values.first().copied().unwrap_or(0).min(1);
    let index = move |value: i64| value.saturating_sub(first).unsigned_abs() as usize;
    let names = values.iter().map(|value| (value.to_string(), index(*value))).collect();
    (names, Box::new(move |row| index(column.number(row) as i64)))
}

/// Maps the numbers of a column or an expression; few integers and words are categories.
fn of_column_or_expression(
    particles: &Particles,
    text: &str,
    options: &Appearance,
) -> Result<Coloring, AppearanceError> {
    let name = quoted(text);
    let text = if particles.column(text).is_some() { &*name } else { text };
    let failed = |error| AppearanceError::of_expression("color", error);
    let expression = Expression::parse(text).map_err(failed)?;
    let column = match expression.columns()[..] {
        [name] if quoted(name) == text => particles.column(name),
        _ => None,
    };
    let choice = ColorChoice::Named(text.to_owned());
    if let Some(column) = column.filter(|column| is_categorical(column)) {
        let (colors, legend) = of_categories(column, particles.len());
        return Ok(Coloring { colors, legend, choice, range: None, unknown: None });
    }
    let values = expression.values(&ParticleColumns(particles), particles.len());
    let values = values.map_err(|error| {
        let near = did_you_mean(text, color_names()).filter(|_| column.is_none());
        let mut failed = failed(error);
        failed.help = near.or(failed.help);
        failed
    })?;
    let Some(range) = options.range.resolve(&values, options.log) else {
        let message = match options.log {
            true => format!("`{text}` has no positive numbers for a logarithmic range"),
            false => format!("`{text}` has no numbers"),
        };
        return Err(AppearanceError::new("color", message));
    };
    let map = options.colormap;
    let table = map.linear_table(MAP_STEPS);
    let color = |value: &f64| match range.position(*value) {
        position if position.is_nan() => UNKNOWN,
        position => {
            let at = position.clamp(0.0, 1.0) * (MAP_STEPS - 1) as f64;
            table[at.round() as usize]
        }
    };
    let colors = Colors::Each(collect(values.par_iter().map(color)));
    let is_unknown = |row: usize| range.position(values[row]).is_nan();
    let unknown = Missing::find(values.len(), is_unknown).map(|missing| UnknownColors {
        missing,
        what: format!("`{}`", column.map_or(text, |column| &*column.name)),
        flaw: if range.log { "not positive" } else { NO_NUMBER },
    });
    let title = column.map_or_else(|| text.to_owned(), |column| column.name.clone());
    let exceeded = range.exceeded_by(&values, |_| true);
    let legend = Legend::Range { title, map, range, exceeded };
    let ends = [range.low, range.high].map(RangeEnd::Number);
    let chosen = RangeChoice { low: ends[0], high: ends[1] };
    Ok(Coloring { colors, legend, choice, range: Some(chosen), unknown })
}

/// Colours that numbers are rounded to; a step is less than a tenth of what the eye can tell.
const MAP_STEPS: usize = 4096;

fn is_categorical(column: &Column) -> bool {
    match &column.data {
        ColumnData::Text(_) => true,
        ColumnData::F32(_) | ColumnData::F64(_) => false,
        data => {
            let is_type = Role::of(&column.name) == Some(Role::Type);
            let range = column.range();
            let few = |[low, high]: [f64; 2]| high - low < MAX_CATEGORIES as f64;
            is_type && !data.is_empty() && range.is_some_and(few)
        }
    }
}
