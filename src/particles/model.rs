//! Particles as columns.

use std::path::PathBuf;

use rayon::prelude::*;
use serde::Serialize;

use crate::math::DVec3;

use super::column::{Column, ColumnData, Role, is_called};
use super::format::Format;
use super::trouble::Trouble;

/// One frame of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Particles {
    /// The file; `-` is standard input.
    pub path: PathBuf,
    /// The format that was read.
    pub format: Format,
    /// Centres, in the unit of the file.
    pub positions: Positions,
    /// The columns that were asked for, in the order of the file, without the positions.
    pub columns: Vec<Column>,
    /// The simulation cell.
    pub cell: Option<Cell>,
    /// The frame; the first is 0.
    pub frame: u64,
    /// Time step or time of the frame as the file says it.
    pub time: Option<f64>,
    /// Title or comment.
    pub title: Option<String>,
    /// The unit of length, if the format or the file defines one.
    pub unit: Option<LengthUnit>,
    /// Line of the first particle, the first line being 1. `None` if the particles are not on
    /// consecutive lines.
    pub first_line: Option<u64>,
    /// What the user should know, such as atoms that were left out.
    pub notes: Vec<String>,
}

/// Centres of all particles. Text is read as the nearest f64, binary numbers keep their type.
#[derive(Clone, Debug, PartialEq)]
pub enum Positions {
    /// In f32.
    F32(Vec<[f32; 3]>),
    /// In f64.
    F64(Vec<[f64; 3]>),
}

/// A simulation cell: a parallelepiped.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Cell {
    /// One corner.
    pub origin: DVec3,
    /// The edges that start there: a, b and c.
    pub vectors: [DVec3; 3],
    /// True along each edge where the cell repeats.
    pub periodic: [bool; 3],
}

/// A unit of length.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum LengthUnit {
    /// 1e-10 m.
    Angstrom,
    /// 1e-9 m.
    Nanometre,
}

impl LengthUnit {
    /// The symbol, as in a scale bar.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Angstrom => "Å",
            Self::Nanometre => "nm",
        }
    }
}

impl Particles {
    /// Positions, and nothing else.
    pub(super) fn new(path: PathBuf, format: Format, positions: Positions) -> Self {
        Self {
            path,
            format,
            positions,
            columns: Vec::new(),
            cell: None,
            frame: 0,
            time: None,
            title: None,
            unit: None,
            first_line: None,
            notes: Vec::new(),
        }
    }

    /// Number of particles.
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// Returns true if there are no particles.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The column with this name: exactly, or else regardless of case and of a unit in brackets.
    pub fn column(&self, name: &str) -> Option<&Column> {
        let exact = self.columns.iter().find(|column| column.name == name);
        exact.or_else(|| self.columns.iter().find(|column| is_called(&column.name, name)))
    }

    /// The column with this role, by the order of its usual names.
    pub fn role(&self, role: Role) -> Option<&Column> {
        role.names().iter().find_map(|name| self.column(name))
    }
}

impl Positions {
    /// Number of particles.
    pub fn len(&self) -> usize {
        match self {
            Self::F32(centers) => centers.len(),
            Self::F64(centers) => centers.len(),
        }
    }

    /// Returns true if there are no particles.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Centres from one column for each axis, all of equal length: in f32 if all of them are.
    pub(super) fn from_columns(axes: &[ColumnData]) -> Result<Self, Trouble> {
        let [x, y, z] = axes else { return Err(Trouble::new("expected three coordinates")) };
        if let (ColumnData::F32(x), ColumnData::F32(y), ColumnData::F32(z)) = (x, y, z) {
            let all = x.iter().zip(y).zip(z).map(|((&x, &y), &z)| [x, y, z]);
            return Self::F32(all.collect()).finite();
        }
        let rows = 0..x.len().min(y.len()).min(z.len());
        let all = rows.map(|row| [x, y, z].map(|axis| axis.number(row)));
        Self::F64(all.collect()).finite()
    }

    /// Refuses coordinates that are not finite.
    pub(super) fn finite(self) -> Result<Self, Trouble> {
        let bad = match &self {
            Self::F32(all) => first_bad(all, |x| !x.is_finite()),
            Self::F64(all) => first_bad(all, |x| !x.is_finite()),
        };
        let Some(row) = bad else { return Ok(self) };
        let DVec3 { x, y, z } = self.get(row);
        let at = format!("row {row} (the first is 0) is at ({x:?}, {y:?}, {z:?})");
        Err(Trouble::new(format!("{at}: expected finite numbers")))
    }

    /// The centre of a particle.
    #[inline]
    pub fn get(&self, row: usize) -> DVec3 {
        match self {
            Self::F32(centers) => DVec3::from_array(centers[row].map(f64::from)),
            Self::F64(centers) => DVec3::from_array(centers[row]),
        }
    }
}

/// The first row with a bad coordinate. Usually there is none, so rows are looked at together.
fn first_bad<T: Copy + Sync>(rows: &[[T; 3]], is_bad: impl Fn(T) -> bool + Sync) -> Option<usize> {
    const ROWS: usize = 1 << 12;
    let has_bad =
        |rows: &[[T; 3]]| rows.as_flattened().iter().fold(false, |any, x| any | is_bad(*x));
    let at = rows.par_chunks(ROWS).position_first(has_bad)? * ROWS;
    let row = rows[at..].iter().position(|row| row.iter().any(|x| is_bad(*x)))?;
    Some(at + row)
}

impl Cell {
    /// A cell with edges along the axes, periodic in all directions.
    pub fn orthogonal(origin: DVec3, size: DVec3) -> Self {
        let vectors = [
            DVec3::new(size.x, 0.0, 0.0),
            DVec3::new(0.0, size.y, 0.0),
            DVec3::new(0.0, 0.0, size.z),
        ];
        Self { origin, vectors, periodic: [true; 3] }
    }

    /// The cell with these edge lengths and angles in degrees (alpha between b and c, beta between
    /// a and c, gamma between a and b): a along x, b in the plane of x and y.
    pub fn from_lengths_and_angles(lengths: [f64; 3], degrees: [f64; 3]) -> Self {
        let [a, b, c] = lengths;
        // Right angles are exact.
        let cos =
            |degrees: f64| if degrees == 90.0 { 0.0 } else { libm::cos(degrees.to_radians()) };
        let [cos_a, cos_b, cos_c] = degrees.map(cos);
        let sin_c = if cos_c == 0.0 { 1.0 } else { libm::sin(degrees[2].to_radians()) };
        let y = (cos_a - cos_b * cos_c) / sin_c;
        let z = (1.0 - cos_b * cos_b - y * y).max(0.0).sqrt();
        let vectors = [
            DVec3::new(a, 0.0, 0.0),
            DVec3::new(b * cos_c, b * sin_c, 0.0),
            DVec3::new(c * cos_b, c * y, c * z),
        ];
        Self { origin: DVec3::ZERO, vectors, periodic: [true; 3] }
    }

    /// The volume; negative if the edges are left-handed.
    pub fn volume(&self) -> f64 {
        let [a, b, c] = self.vectors;
        a.cross(b).dot(c)
    }

    /// The point with these coordinates relative to the edges.
    pub fn point(&self, fractions: [f64; 3]) -> DVec3 {
        let [a, b, c] = self.vectors;
        self.origin + a * fractions[0] + b * fractions[1] + c * fractions[2]
    }

    /// The coordinates of a point relative to the edges; not finite if the volume is 0.
    pub fn fractions(&self, point: DVec3) -> [f64; 3] {
        let [a, b, c] = self.vectors;
        let from = point - self.origin;
        let volume = self.volume();
        [b.cross(c), c.cross(a), a.cross(b)].map(|normal| from.dot(normal) / volume)
    }
}
