//! Particles with radii and colours: everything that a scene needs to know of them.

use std::collections::BTreeSet;

use crate::math::DVec3;
use crate::particles::{Categories, Cell, ColumnData, Particles, Positions};

use super::arrange::{copies, move_particles};
use super::cell_edges::cell_edges;
use super::colors::{Colors, Legend, colors};
use super::expression::Expression;
use super::failure::AppearanceError;
use super::named_color::named_color;
use super::options::{Appearance, ColorChoice, RadiusChoice};
use super::particle_columns::{POSITION, ParticleColumns};
use super::radii::{Radii, radii};
use super::value_range::{RangeChoice, RangeEnd};

/// Particles as they look.
#[derive(Clone, Debug, PartialEq)]
pub struct Dressed {
    /// Centres of the visible particles.
    pub positions: Positions,
    /// Their radii.
    pub radii: Radii,
    /// Their colours.
    pub colors: Colors,
    /// Rows of the visible particles in the file, without periodic copies; `None` for all.
    pub rows: Option<Vec<u32>>,
    /// Number of spheres that are edges of the cell; they come last.
    pub edges: usize,
    /// Number of periodic copies, one behind the other in the arrays.
    pub copies: usize,
    /// Centres and radii of the particles that are hidden.
    pub hidden: Vec<(DVec3, f64)>,
    /// The cell with all copies.
    pub cell: Option<Cell>,
    /// What the colours mean.
    pub legend: Legend,
    /// The options that were chosen automatically: key and value.
    pub choices: Vec<(&'static str, String)>,
    /// The symbol of the unit of length.
    pub unit: Option<&'static str>,
    /// What the user should know.
    pub notes: Vec<String>,
}

impl Dressed {
    /// Number of visible spheres.
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// Returns true if no particle is visible.
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// Number of visible particles with their copies, without edges of the cell.
    pub fn particle_count(&self) -> usize {
        self.len() - self.edges
    }
}

/// The columns that these options name or may need, of those that a file has. `None` if they name
/// one that it lacks: then all of them are needed, for the message.
pub fn needed_columns(options: &Appearance, of_file: &[&str]) -> Option<Vec<String>> {
    let mut names: BTreeSet<&str> = BTreeSet::new();
    let texts = [options.select.as_deref(), options.slice.as_deref()];
    let radius = match &options.radius {
        RadiusChoice::Expression(text) => Some(&**text),
        _ => None,
    };
    let color = match &options.color {
        ColorChoice::Named(text) => Some(&**text),
        _ => None,
    };
    let parsed: Vec<Expression> =
        texts.into_iter().chain([radius, color]).flatten().filter_map(parse).collect();
    parsed.iter().for_each(|expression| names.extend(expression.columns()));
    let is_known = |name: &&str| {
        POSITION.contains(name)
            || named_color(name).is_some()
            || of_file.iter().any(|known| known.eq_ignore_ascii_case(name))
    };
    if !names.iter().all(is_known) {
        return None;
    }
    names.extend([radius, color].into_iter().flatten());
    let is_named = |name: &&&str| names.iter().any(|wanted| wanted.eq_ignore_ascii_case(name));
    let is_needed = |name: &&&str| is_named(name) || has_role(name, options);
    Some(of_file.iter().filter(is_needed).map(|name| (*name).to_owned()).collect())
}

fn parse(text: &str) -> Option<Expression> {
    Expression::parse(text).ok()
}

/// Returns true if the look may depend on a column because of what its name means.
fn has_role(name: &str, options: &Appearance) -> bool {
    use crate::particles::Role;
    let is_auto = matches!(options.color, ColorChoice::Auto | ColorChoice::AutoOr(_));
    let is_element =
        matches!(Role::of(name), Some(Role::Element | Role::AtomicNumber | Role::Type));
    let needs_elements =
        matches!(options.radius, RadiusChoice::Auto | RadiusChoice::Vdw | RadiusChoice::Covalent)
            || is_auto
            || matches!(options.color, ColorChoice::Element | ColorChoice::Type);
    match Role::of(name) {
        Some(Role::Radius | Role::Diameter) => options.radius == RadiusChoice::Auto,
        Some(Role::Red | Role::Green | Role::Blue) => is_auto || options.color == ColorChoice::Rgb,
        _ if options.unwrap && matches!(name, "ix" | "iy" | "iz") => true,
        _ => is_element && needs_elements,
    }
}

/// Gives particles radii and colours.
///
/// # Errors
/// If an option is wrong for these particles.
pub fn dress(mut particles: Particles, options: &Appearance) -> Result<Dressed, AppearanceError> {
    let path = particles.path.display().to_string();
    move_particles(&mut particles, options)?;
    let mut rows = None;
    if let Some(text) = &options.select {
        let chosen = condition(&particles, "select", text)?;
        rows = Some(keep(&mut particles, &chosen));
        if particles.is_empty() {
            return Err(AppearanceError::new("select", "no particle fulfils the condition"));
        }
    }
    let (mut radii, radius) = radii(&particles, options)?;
    let mut coloring = colors(&particles, options)?;
    let mut hidden = Vec::new();
    if let Some(text) = &options.slice {
        let cut = condition(&particles, "slice", text)?;
        let visible: Vec<bool> = cut.iter().map(|cut| !cut).collect();
        if !visible.contains(&true) {
            return Err(AppearanceError::new("slice", "all particles are hidden"));
        }
        let rows_of_cut = (0..cut.len()).filter(|row| cut[*row]);
        hidden = rows_of_cut.map(|row| (particles.positions.get(row), radii.get(row))).collect();
        match &mut radii {
            Radii::Constant(_) => {}
            Radii::F32(values) => retain(values, &visible),
            Radii::F64(values) => retain(values, &visible),
        }
        if let Colors::Each(colors) = &mut coloring.colors {
            retain(colors, &visible);
        }
        particles.columns.clear();
        let kept = keep(&mut particles, &visible);
        rows = Some(match rows {
            None => kept,
            Some(rows) => kept.iter().map(|row| rows[*row as usize]).collect(),
        });
    }
    let shifts = copies(&particles, options)?;
    let [i, j, k] = options.replicate;
    let cell = particles.cell.map(|cell| {
        let [a, b, c] = cell.vectors;
        Cell { vectors: [a * f64::from(i), b * f64::from(j), c * f64::from(k)], ..cell }
    });
    let mut choices = Vec::new();
    if options.radius != radius {
        choices.push(("radius", radius.to_string()));
    }
    if options.color != coloring.choice {
        choices.push(("color", coloring.choice.to_string()));
    }
    if let Some(range) = coloring.range.filter(|range| *range != options.range) {
        choices.push(("range", range_text(&range)));
    }
    let mut dressed = Dressed {
        positions: particles.positions,
        radii,
        colors: coloring.colors,
        rows,
        edges: 0,
        copies: shifts.len(),
        hidden,
        cell,
        legend: coloring.legend,
        choices,
        unit: particles.unit.map(|unit| unit.symbol()),
        notes: particles.notes,
    };
    repeat(&mut dressed, &shifts);
    if options.cell {
        draw_cell(&mut dressed, &path)?;
    }
    Ok(dressed)
}

/// A range as an option.
pub fn range_text(range: &RangeChoice) -> String {
    let end = |end: RangeEnd| match end {
        RangeEnd::Number(number) => number.to_string(),
        RangeEnd::Percentile(percent) => format!("p{percent}"),
    };
    format!("{},{}", end(range.low), end(range.high))
}

fn condition(
    particles: &Particles,
    key: &'static str,
    text: &str,
) -> Result<Vec<bool>, AppearanceError> {
    let failed = |error| AppearanceError::of_expression(key, error);
    let expression = Expression::parse(text).map_err(failed)?;
    expression.select(&ParticleColumns(particles), particles.len()).map_err(failed)
}

/// Keeps the chosen particles, and returns their rows.
fn keep(particles: &mut Particles, chosen: &[bool]) -> Vec<u32> {
    match &mut particles.positions {
        Positions::F32(centers) => retain(centers, chosen),
        Positions::F64(centers) => retain(centers, chosen),
    }
    for column in &mut particles.columns {
        match &mut column.data {
            ColumnData::U8(values) => retain(values, chosen),
            ColumnData::I32(values) => retain(values, chosen),
            ColumnData::I64(values) => retain(values, chosen),
            ColumnData::F32(values) => retain(values, chosen),
            ColumnData::F64(values) => retain(values, chosen),
            ColumnData::Text(words) => keep_words(words, chosen),
        }
    }
    (0..chosen.len() as u32).filter(|row| chosen[*row as usize]).collect()
}

/// Keeps the words of the chosen rows, and forgets those that no row has.
fn keep_words(words: &mut Categories, chosen: &[bool]) {
    retain(&mut words.codes, chosen);
    let mut is_used = vec![false; words.names.len()];
    words.codes.iter().for_each(|code| is_used[*code as usize] = true);
    let mut new_code = vec![0; words.names.len()];
    let mut names = Vec::new();
    for (code, name) in words.names.iter().enumerate().filter(|(code, _)| is_used[*code]) {
        new_code[code] = names.len() as u32;
        names.push(name.clone());
    }
    words.codes.iter_mut().for_each(|code| *code = new_code[*code as usize]);
    words.names = names;
}

fn retain<T>(values: &mut Vec<T>, chosen: &[bool]) {
    let mut row = 0;
    values.retain(|_| {
        row += 1;
        chosen[row - 1]
    });
}

/// Colour of the edges of the cell: sRGB 90.
const EDGE: [f32; 3] = [0.102; 3];

/// Radius of the edges in diagonals of the cell.
const EDGE_RADIUS: f64 = 0.0018;

/// Appends the edges of the cell, as spheres.
fn draw_cell(dressed: &mut Dressed, path: &str) -> Result<(), AppearanceError> {
    let Some(Cell { origin, vectors, .. }) = dressed.cell else {
        return Err(AppearanceError::new("cell", format!("`{path}` has no cell")));
    };
    let [a, b, c] = vectors;
    let radius = EDGE_RADIUS * (a + b + c).length();
    let edges = cell_edges(origin, vectors, radius);
    let (count, added) = (dressed.len(), edges.len());
    dressed.edges = added;
    match &mut dressed.radii {
        Radii::Constant(all) => {
            let mut radii = vec![*all; count];
            radii.resize(count + added, radius);
            dressed.radii = Radii::F64(radii);
        }
        Radii::F32(radii) => radii.resize(count + added, radius as f32),
        Radii::F64(radii) => radii.resize(count + added, radius),
    }
    match &mut dressed.colors {
        Colors::Constant(all) => {
            let mut colors = vec![all.to_array(); count];
            colors.resize(count + added, EDGE);
            dressed.colors = Colors::Each(colors);
        }
        Colors::Each(colors) => colors.resize(count + added, EDGE),
    }
    match &mut dressed.positions {
        Positions::F32(centers) => {
            centers.extend(edges.iter().map(|edge| edge.to_array().map(|x| x as f32)));
        }
        Positions::F64(centers) => centers.extend(edges.iter().map(|edge| edge.to_array())),
    }
    Ok(())
}

/// Appends the periodic copies; the first shift is 0.
fn repeat(dressed: &mut Dressed, shifts: &[DVec3]) {
    let count = dressed.len();
    for shift in &shifts[1..] {
        match &mut dressed.positions {
            Positions::F32(centers) => {
                centers.extend_from_within(..count);
                let first = centers.len() - count;
                for center in &mut centers[first..] {
                    let moved = DVec3::from_array(center.map(f64::from)) + *shift;
                    *center = moved.to_array().map(|x| x as f32);
                }
            }
            Positions::F64(centers) => {
                centers.extend_from_within(..count);
                let first = centers.len() - count;
                for center in &mut centers[first..] {
                    *center = (DVec3::from_array(*center) + *shift).to_array();
                }
            }
        }
        match &mut dressed.radii {
            Radii::Constant(_) => {}
            Radii::F32(values) => values.extend_from_within(..count),
            Radii::F64(values) => values.extend_from_within(..count),
        }
        if let Colors::Each(colors) = &mut dressed.colors {
            colors.extend_from_within(..count);
        }
    }
    let hidden = dressed.hidden.clone();
    for shift in &shifts[1..] {
        dressed.hidden.extend(hidden.iter().map(|(center, radius)| (*center + *shift, *radius)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Rgb;
    use crate::particles::{Column, Format};

    /// Four particles in a cell of side 10: two waters' oxygens, a hydrogen, and a carbon outside.
    fn particles() -> Particles {
        let words = ["O", "H", "C"].map(std::sync::Arc::from).to_vec();
        let element = Categories { codes: vec![0, 1, 0, 2], names: words };
        let column = |name: &str, data| Column { name: name.to_owned(), data };
        Particles {
            path: "a.xyz".into(),
            format: Format::Xyz,
            positions: Positions::F64(vec![
                [1.0, 1.0, 1.0],
                [2.0, 1.0, 1.0],
                [9.0, 1.0, 1.0],
                [12.0, -3.0, 5.0],
            ]),
            columns: vec![
                column("element", ColumnData::Text(element)),
                column("charge", ColumnData::F64(vec![-0.8, 0.4, -0.8, 4.0])),
                column("type", ColumnData::I32(vec![1, 3, 1, 3])),
                column("ix", ColumnData::I32(vec![0, 1, 0, 0])),
                column("iy", ColumnData::I32(vec![0, 0, -1, 0])),
                column("iz", ColumnData::I32(vec![0; 4])),
            ],
            cell: Some(Cell::orthogonal(DVec3::ZERO, DVec3::splat(10.0))),
            frame: 0,
            time: None,
            title: None,
            unit: None,
            first_line: Some(3),
            notes: Vec::new(),
        }
    }

    fn dressed(change: impl FnOnce(&mut Appearance)) -> Dressed {
        let mut options = Appearance::default();
        change(&mut options);
        dress(particles(), &options).unwrap_or_else(|error| panic!("{error:?}"))
    }

    fn centers(dressed: &Dressed) -> Vec<[f64; 3]> {
        (0..dressed.len()).map(|row| dressed.positions.get(row).to_array()).collect()
    }

    fn colors(dressed: &Dressed) -> Vec<Rgb> {
        let Colors::Each(colors) = &dressed.colors else { panic!("{:?}", dressed.colors) };
        colors.iter().map(|color| Rgb::from_array(*color)).collect()
    }

    #[test]
    fn elements_have_their_radii_and_colours() {
        let found = dressed(|_| ());
        let choices = vec![("radius", "covalent".to_owned()), ("color", "element".to_owned())];
        assert_eq!(found.choices, choices);
        let radii: Vec<f64> = (0..4).map(|row| found.radii.get(row)).collect();
        assert_eq!(radii, [0.66f32, 0.31, 0.66, 0.73].map(f64::from));
        let oxygen = crate::appearance::Element::with_symbol("O").unwrap().color();
        assert_eq!(colors(&found)[0], oxygen);
        let Legend::Categories { entries, .. } = &found.legend else { panic!() };
        let names: Vec<&str> = entries.iter().map(|(name, _)| &**name).collect();
        assert_eq!(names, ["H", "C", "O"]);
        let scaled = dressed(|options| {
            options.radius = RadiusChoice::Vdw;
            options.radius_scale = 0.5;
        });
        assert_eq!(scaled.radii.get(0), f64::from(0.76f32));
    }

    #[test]
    fn numbers_are_mapped_and_out_of_range_is_clamped() {
        let found = dressed(|options| {
            options.color = ColorChoice::from("charge".to_owned());
            options.range = RangeChoice::parse("-0.8,0.4").unwrap();
        });
        let map = crate::appearance::ColorMap::Viridis;
        let expected = [0.0, 1.0, 0.0, 1.0].map(|position| map.linear(position));
        for (found, expected) in colors(&found).into_iter().zip(expected) {
            assert!((found - expected).abs().max_element() < 1e-6);
        }
        assert!(!found.choices.iter().any(|(key, _)| *key == "range"));
        let whole = dressed(|options| options.color = ColorChoice::from("2 * charge".to_owned()));
        assert!(whole.choices.contains(&("range", "-1.6,8".to_owned())), "{:?}", whole.choices);
    }

    #[test]
    fn types_keep_their_colours_whichever_are_there() {
        let types = |options: &mut Appearance| options.color = ColorChoice::Type;
        let both = colors(&dressed(types));
        let one = colors(&dressed(|options| {
            types(options);
            options.select = Some("type == 3".to_owned());
        }));
        assert_eq!(one, [both[1], both[3]]);
        assert_ne!(both[0], both[1]);
    }

    #[test]
    fn selections_leave_rows_out_and_slices_only_hide() {
        let selected = dressed(|options| options.select = Some("x < 9 || x > 10".to_owned()));
        assert_eq!(selected.rows, Some(vec![0, 1, 3]));
        let sliced = dressed(|options| {
            options.select = Some("x < 10".to_owned());
            options.slice = Some("element == 'H'".to_owned());
        });
        assert_eq!(sliced.rows, Some(vec![0, 2]));
        assert_eq!(sliced.hidden, [(DVec3::new(2.0, 1.0, 1.0), f64::from(0.31f32))]);
        assert_eq!(colors(&sliced).len(), 2);
        for (key, text) in [("select", "x > 100"), ("slice", "x < 100")] {
            let options = match key {
                "select" => Appearance { select: Some(text.to_owned()), ..Default::default() },
                _ => Appearance { slice: Some(text.to_owned()), ..Default::default() },
            };
            assert_eq!(dress(particles(), &options).map_err(|e| e.key), Err(key));
        }
    }

    #[test]
    fn particles_move_within_the_cell() {
        let wrapped = dressed(|options| options.wrap = true);
        assert_eq!(centers(&wrapped)[3], [2.0, 7.0, 5.0]);
        let unwrapped = dressed(|options| options.unwrap = true);
        assert_eq!(centers(&unwrapped)[1..3], [[12.0, 1.0, 1.0], [9.0, -9.0, 1.0]]);
        // Across the boundary, at 9 and 1 (and 2): the circular middle is near 0.
        let centered = dressed(|options| {
            options.select = None;
            options.center = true;
            options.wrap = true;
        });
        let [first, _, third] = [0, 1, 2].map(|row| centers(&centered)[row]);
        assert!((first[0] - third[0] - 2.0).abs() < 1e-9, "{first:?} {third:?}");
    }

    #[test]
    fn copies_repeat_everything_and_the_cell_grows() {
        let found = dressed(|options| {
            options.replicate = [2, 1, 3];
            options.cell = true;
        });
        assert_eq!((found.copies, found.particle_count()), (6, 24));
        let all = centers(&found);
        let moved: Vec<[f64; 3]> = all[..24].iter().skip(4).step_by(4).copied().collect();
        let expected =
            [[1., 1., 11.], [1., 1., 21.], [11., 1., 1.], [11., 1., 11.], [11., 1., 21.]];
        assert_eq!(moved, expected);
        assert_eq!(found.cell.map(|cell| cell.volume()), Some(6000.0));
        assert!(found.edges > 100 && all.len() == 24 + found.edges);
        assert_eq!(colors(&found)[..4], colors(&found)[20..24]);
        let mut without = particles();
        without.cell = None;
        for options in [
            Appearance { wrap: true, ..Default::default() },
            Appearance { replicate: [2, 1, 1], ..Default::default() },
            Appearance { cell: true, ..Default::default() },
        ] {
            let error = dress(without.clone(), &options).expect_err("there is no cell");
            assert_eq!(error.message, "`a.xyz` has no cell");
        }
    }

    #[test]
    fn nothing_known_gives_half_the_spacing_and_one_colour() {
        let mut plain = particles();
        plain.columns.clear();
        let found = dress(plain, &Appearance::default()).unwrap();
        assert_eq!(found.choices[0].0, "radius");
        // Nearest neighbours are 1, 1, 6.4 and 7 away.
        assert_eq!(found.radii, Radii::Constant(3.2));
        assert!(matches!(found.colors, Colors::Constant(_)));
        assert_eq!(found.legend, Legend::Nothing);
    }

    #[test]
    fn only_needed_columns_are_asked_for() {
        let of_file = ["element", "charge", "type", "mass", "radius", "ix", "vx"];
        let needed = |change: fn(&mut Appearance)| {
            let mut options = Appearance::default();
            change(&mut options);
            needed_columns(&options, &of_file)
        };
        let names = |names: &[&str]| Some(names.iter().map(|name| (*name).to_owned()).collect());
        assert_eq!(needed(|_| ()), names(&["element", "type", "radius"]));
        let plain = needed(|options| {
            options.radius = RadiusChoice::Number(1.0);
            options.color = ColorChoice::from("crimson".to_owned());
            options.select = Some("sqrt(vx) < z".to_owned());
        });
        assert_eq!(plain, names(&["vx"]));
        assert_eq!(needed(|options| options.slice = Some("vy > 0".to_owned())), None);
    }
}
