use super::*;
use crate::appearance::colors::{Colors, Legend};
use crate::appearance::needed_columns::needed_columns;
use crate::appearance::options::{ColorChoice, RadiusChoice};
use crate::appearance::radii::Radii;
use crate::color::Rgb;
use crate::math::DVec3;
use crate::particles::{Categories, Column, ColumnData, Format, Positions};

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
fn unknown_elements_are_said_with_their_line() {
    let warnings = |names: [&str; 3], change: &dyn Fn(&mut Appearance)| {
        let mut particles = particles();
        let ColumnData::Text(words) = &mut particles.columns[0].data else { panic!() };
        words.names = names.map(Into::into).to_vec();
        let mut options = Appearance::default();
        change(&mut options);
        dress(particles, &options).unwrap().warnings
    };
    assert!(warnings(["O", "H", "C"], &|_| ()).is_empty());
    let both = "a.xyz:4: no element is called `Q1`: it is grey and drawn with a radius of 0.8 Å";
    assert_eq!(warnings(["O", "Q1", "C"], &|_| ()), [both]);
    let of_rest = |options: &mut Appearance| {
        options.select = Some("x > 1".to_owned());
        options.radius = RadiusChoice::Number(1.0);
    };
    let grey = "a.xyz:5: no element is called `Xx`: it is grey";
    assert_eq!(warnings(["Xx", "H", "C"], &of_rest), [grey]);
    let more = warnings(["Xx", "H", "C"], &|options| options.color = ColorChoice::Type);
    let larger = "a.xyz:3: no element is called `Xx`, like 2 of 4 particles: they are drawn with a \
                  radius of 0.8 Å";
    assert_eq!(more, [larger]);
    let neither = |options: &mut Appearance| {
        options.color = ColorChoice::Type;
        options.radius = RadiusChoice::Spacing;
    };
    assert!(warnings(["Xx", "H", "C"], &neither).is_empty());
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
    let expected = [[1., 1., 11.], [1., 1., 21.], [11., 1., 1.], [11., 1., 11.], [11., 1., 21.]];
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
