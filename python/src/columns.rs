//! Particles as columns, from arrays or from a file.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use numpy::{Element, IntoPyArray, PyArray1, PyArray2};
use photosphere::Error;
use photosphere::appearance::{self, Appearance, AppearanceError};
use photosphere::math::{DVec3, MAX_COORDINATE};
use photosphere::particles::{
    Categories, Cell, Column, ColumnData, Format, LengthUnit, Particles, Positions, ReadRequest,
    Wanted, count_frames, read, survey as survey_file,
};
use pyo3::exceptions::{PyKeyError, PyValueError};
use pyo3::prelude::*;

use crate::{arrays, error, pool};

/// A simulation cell: origin, edges, and along which of them it repeats.
type CellNumbers = ([f64; 3], [[f64; 3]; 3], [bool; 3]);

/// The particles of one frame.
#[pyclass(frozen, module = "photosphere._core")]
pub(crate) struct Columns(Mutex<Option<Particles>>);

#[pymethods]
impl Columns {
    /// From arrays, which are checked to be of numbers: positions in f32 if `single`, columns of
    /// numbers with their type, and columns of words as codes with names.
    #[new]
    fn new(
        name: PathBuf,
        positions: &Bound<'_, PyAny>,
        single: bool,
        numbers: Vec<(String, String, Bound<'_, PyAny>)>,
        words: Vec<(String, Vec<String>, Bound<'_, PyAny>)>,
        cell: Option<CellNumbers>,
        unit: Option<&str>,
    ) -> PyResult<Self> {
        let positions = match single {
            true => Positions::F32(finite(arrays::rows(positions)?, "positions")?),
            false => Positions::F64(finite(arrays::rows(positions)?, "positions")?),
        };
        let mut columns = Vec::new();
        for (name, kind, array) in &numbers {
            let data = match kind.as_str() {
                "u8" => ColumnData::U8(arrays::values(array)?),
                "i32" => ColumnData::I32(arrays::values(array)?),
                "i64" => ColumnData::I64(arrays::values(array)?),
                "f32" => ColumnData::F32(arrays::values(array)?),
                _ => ColumnData::F64(arrays::values(array)?),
            };
            columns.push(Column { name: name.clone(), data });
        }
        for (name, names, codes) in &words {
            let names = names.iter().map(|name| Arc::from(name.as_str())).collect();
            let data = ColumnData::Text(Categories { codes: arrays::values(codes)?, names });
            columns.push(Column { name: name.clone(), data });
        }
        let known = [LengthUnit::Angstrom, LengthUnit::Nanometre];
        Ok(Self(Mutex::new(Some(Particles {
            path: name,
            format: Format::Npy,
            positions,
            columns,
            cell: cell.map(|(origin, vectors, periodic)| Cell {
                origin: DVec3::from_array(origin),
                vectors: vectors.map(DVec3::from_array),
                periodic,
            }),
            frame: 0,
            time: None,
            title: None,
            unit: known.into_iter().find(|known| Some(known.symbol()) == unit),
            first_line: None,
            notes: Vec::new(),
        }))))
    }

    /// Reads one frame of a file, with these columns or all. `names` are those of the columns of a
    /// file that names none.
    #[staticmethod]
    fn read(
        py: Python<'_>,
        path: PathBuf,
        format: Option<&str>,
        frame: i64,
        columns: Option<Vec<String>>,
        names: Vec<String>,
        topology: Option<PathBuf>,
    ) -> PyResult<Self> {
        let request = ReadRequest { names, ..request(py, format, frame, columns, topology)? };
        let particles = pool::run_interruptible(py, move || read(&path, &request))?;
        Ok(Self(Mutex::new(Some(particles))))
    }

    /// Number of particles.
    fn count(&self) -> usize {
        self.with(Particles::len).unwrap_or(0)
    }

    /// Names of the columns, without the positions.
    fn names(&self) -> Vec<String> {
        let names = |particles: &Particles| {
            particles.columns.iter().map(|column| column.name.clone()).collect()
        };
        self.with(names).unwrap_or_default()
    }

    /// The positions, as an array of its own.
    fn positions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let positions = self.with(|particles| particles.positions.clone()).ok_or_else(taken)?;
        match positions {
            Positions::F32(rows) => table(py, rows),
            Positions::F64(rows) => table(py, rows),
        }
    }

    /// The symbol of the unit of length, if it is known.
    fn unit(&self) -> Option<&'static str> {
        self.with(|particles| particles.unit.map(LengthUnit::symbol)).flatten()
    }

    /// A column: numbers, or codes with their words.
    fn column<'py>(
        &self,
        py: Python<'py>,
        name: &str,
    ) -> PyResult<(Bound<'py, PyAny>, Option<Vec<String>>)> {
        let found = self.with(|particles| particles.column(name).map(|column| column.data.clone()));
        let data = found.ok_or_else(taken)?;
        let data = data.ok_or_else(|| PyKeyError::new_err(name.to_owned()))?;
        Ok(match data {
            ColumnData::U8(values) => (values.into_pyarray(py).into_any(), None),
            ColumnData::I32(values) => (values.into_pyarray(py).into_any(), None),
            ColumnData::I64(values) => (values.into_pyarray(py).into_any(), None),
            ColumnData::F32(values) => (values.into_pyarray(py).into_any(), None),
            ColumnData::F64(values) => (values.into_pyarray(py).into_any(), None),
            ColumnData::Text(words) => {
                let names = words.names.iter().map(ToString::to_string).collect();
                (words.codes.into_pyarray(py).into_any(), Some(names))
            }
        })
    }

    /// Rows of the particles that fulfil a condition once they have moved as `moves` says: unwrap,
    /// center, wrap.
    fn selected<'py>(
        &self,
        py: Python<'py>,
        condition: String,
        moves: [bool; 3],
    ) -> PyResult<Bound<'py, PyAny>> {
        let [unwrap, center, wrap] = moves;
        let options =
            Appearance { select: Some(condition), unwrap, center, wrap, ..Appearance::default() };
        let rows = self.ask(py, |particles| appearance::selected_rows(particles, &options))?;
        Ok(rows.into_pyarray(py).into_any())
    }

    /// The radius that an expression has for each particle.
    fn radii<'py>(&self, py: Python<'py>, text: &str) -> PyResult<Bound<'py, PyAny>> {
        let numbers =
            self.ask(py, |particles| appearance::numbers_of(particles, "radius", text))?;
        Ok(numbers.into_pyarray(py).into_any())
    }

    /// The simulation cell.
    fn cell(&self) -> Option<CellNumbers> {
        self.with(|particles| particles.cell).flatten().map(|cell| {
            (cell.origin.to_array(), cell.vectors.map(|edge| edge.to_array()), cell.periodic)
        })
    }
}

impl Columns {
    /// Takes the particles out, for a scene.
    pub(crate) fn take(&self) -> PyResult<Particles> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).take().ok_or_else(taken)
    }

    /// Asks something of the particles, without the GIL.
    fn ask<T: Send>(
        &self,
        py: Python<'_>,
        question: impl FnOnce(&Particles) -> std::result::Result<T, AppearanceError> + Send,
    ) -> PyResult<T> {
        pool::run(py, || {
            let answer = self.with(question).ok_or_else(|| Error::input(TAKEN))?;
            answer.map_err(|AppearanceError { key, message, help, .. }| {
                let error = Error::input(format!("{key}: {message}"));
                match help {
                    Some(help) => error.with_help(help),
                    None => error,
                }
            })
        })
    }

    fn with<T>(&self, what: impl FnOnce(&Particles) -> T) -> Option<T> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).as_ref().map(what)
    }
}

const TAKEN: &str = "these columns belong to a scene already";

fn taken() -> PyErr {
    PyValueError::new_err(TAKEN)
}

fn table<'py, T: Element>(py: Python<'py>, rows: Vec<[T; 3]>) -> PyResult<Bound<'py, PyAny>> {
    use numpy::PyArrayMethods;
    let count = rows.len();
    let flat: Bound<'py, PyArray1<T>> = PyArray1::from_vec(py, rows.into_flattened());
    let table: Bound<'py, PyArray2<T>> = flat.reshape([count, 3])?;
    Ok(table.into_any())
}

/// Refuses coordinates that are not finite or beyond those of a scene, and names the first row.
pub(crate) fn finite<T: Into<f64> + Copy, const N: usize>(
    rows: Vec<[T; N]>,
    name: &str,
) -> PyResult<Vec<[T; N]>> {
    // A comparison with NaN is false.
    let is_good = |number: &T| (*number).into().abs() <= MAX_COORDINATE;
    let Some(bad) = rows.iter().position(|row| !row.iter().all(is_good)) else { return Ok(rows) };
    let numbers: Vec<f64> = rows[bad].iter().map(|number| (*number).into()).collect();
    let expected = match numbers.iter().all(|number| number.is_finite()) {
        true => format!("expected numbers within ±{MAX_COORDINATE:e}"),
        false => "expected finite numbers".to_owned(),
    };
    Err(PyValueError::new_err(format!("{name}: row {bad} is {numbers:?}: {expected}")))
}

/// What is in a particle file, as JSON; `count` also counts its frames, which may read all of it.
#[pyfunction]
pub(crate) fn survey(
    py: Python<'_>,
    path: PathBuf,
    format: Option<&str>,
    frame: i64,
    names: Vec<String>,
    topology: Option<PathBuf>,
    count: bool,
) -> PyResult<String> {
    let request = ReadRequest { names, ..request(py, format, frame, None, topology)? };
    pool::run_interruptible(py, move || {
        let mut survey = survey_file(&path, &request)?;
        if count && survey.frames.is_none() {
            survey.frames = Some(count_frames(&path, &request)?);
        }
        serde_json::to_string(&survey).map_err(|error| Error::input(error.to_string()))
    })
}

fn request(
    py: Python<'_>,
    format: Option<&str>,
    frame: i64,
    columns: Option<Vec<String>>,
    topology: Option<PathBuf>,
) -> PyResult<ReadRequest> {
    let unknown = |name: &str| {
        let known: Vec<&str> = Format::NAMES.iter().map(|(name, _)| *name).collect();
        let help = format!("the formats are {}", known.join(", "));
        error::raise(py, &Error::input(format!("there is no format `{name}`")).with_help(help))
    };
    let format = format.map(|name| Format::named(name).ok_or_else(|| unknown(name))).transpose()?;
    let columns = columns.map_or(Wanted::All, Wanted::Only);
    Ok(ReadRequest { format, frame, columns, topology, ..ReadRequest::default() })
}
