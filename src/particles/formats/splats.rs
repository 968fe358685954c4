//! 3D Gaussian splats in PLY as spheres: the radius is the geometric mean of the three scales, the
//! colour that of the constant spherical harmonic.

use crate::particles::column::{Column, ColumnData};
use crate::particles::model::Particles;
use crate::particles::request::{ColumnInfo, ColumnKind, Wanted};

/// The constant spherical harmonic.
const HARMONIC: f64 = 0.282_094_791_773_878_14;

/// Names of the properties that make a splat.
const RAW: [&str; 7] = ["f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0", "scale_1", "scale_2"];

/// Names of the columns made of them.
const MADE: [&str; 5] = ["red", "green", "blue", "opacity", "radius"];

/// Splats were found.
pub(super) struct Splats;

impl Splats {
    /// Recognises splats by their properties.
    pub(super) fn find<'n>(names: impl Iterator<Item = &'n str>) -> Option<Self> {
        let names: Vec<&str> = names.collect();
        RAW.iter().all(|raw| names.contains(raw)).then_some(Self)
    }

    /// The properties that must be read.
    pub(super) fn needs(&self, wanted: &Wanted) -> Wanted {
        let Wanted::Only(names) = wanted else { return Wanted::All };
        let is_made = |name: &&String| MADE.iter().any(|made| made.eq_ignore_ascii_case(name));
        let mut needed: Vec<String> = names.iter().filter(|name| !is_made(name)).cloned().collect();
        if names.iter().any(|name| is_made(&name)) {
            needed.extend(RAW.map(str::to_owned));
        }
        Wanted::Only(needed)
    }

    /// The columns with those that are made.
    pub(super) fn infos(&self, mut columns: Vec<ColumnInfo>) -> Vec<ColumnInfo> {
        columns.retain(|info| !is_raw(&info.name));
        let info =
            |name: &str| ColumnInfo { name: name.to_owned(), kind: ColumnKind::Float, range: None };
        columns.extend(MADE.map(info));
        columns
    }

    /// Turns the properties into colour, opacity and radius.
    pub(super) fn convert(&self, particles: &mut Particles, wanted: &Wanted) {
        let rows = particles.len();
        let made = {
            let columns = RAW.map(|raw| particles.columns.iter().find(|c| c.name == raw));
            let [Some(red), Some(green), Some(blue), Some(opacity), Some(a), Some(b), Some(c)] =
                columns
            else {
                return;
            };
            let each = |of: &dyn Fn(usize) -> f64| {
                ColumnData::F32((0..rows).map(|row| of(row) as f32).collect())
            };
            let color = |column: &Column| {
                each(&|row| (0.5 + HARMONIC * column.number(row)).clamp(0.0, 1.0))
            };
            let logistic = |x: f64| 1.0 / (1.0 + libm::exp(-x));
            let size = |row| libm::exp((a.number(row) + b.number(row) + c.number(row)) / 3.0);
            [
                color(red),
                color(green),
                color(blue),
                each(&|row| logistic(opacity.number(row))),
                each(&size),
            ]
        };
        particles.columns.retain(|column| !is_raw(&column.name));
        for (name, data) in MADE.into_iter().zip(made) {
            if wanted.has(name) {
                particles.columns.push(Column { name: name.to_owned(), data });
            }
        }
        let note = "3D Gaussian splats are shown as spheres whose radius is the geometric mean of \
                    their three scales";
        particles.notes.push(note.to_owned());
    }
}

fn is_raw(name: &str) -> bool {
    RAW.contains(&name)
}
