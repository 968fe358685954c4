//! Scenes as Python holds them: where a scene comes from. It is read and built for each render,
//! with the options of that render.

use std::path::PathBuf;
use std::sync::{Mutex, MutexGuard, PoisonError};

use photosphere::cli::keywords::{KeywordRender, OpenedScene, SceneInput};
use photosphere::job::{Pick, pick_in_scene};
use photosphere::scene::data::StridedArray;
use photosphere::scene::{FileRows, Override, PreparedScene, SphereArrays, TableInput};
use photosphere::studio::Style;
use photosphere::{Error, Result, accel};
use pyo3::prelude::*;
use serde_json::json;

use crate::columns::{Columns, finite};
use crate::{arrays, error, pool};

/// Keys of a scene with their values in TOML.
pub(crate) type Changes = Vec<(String, String)>;

/// Options as words of a command line, and changed keys.
type Choices = (Vec<String>, Changes);

/// Where a scene comes from.
#[pyclass(frozen, module = "photosphere._core")]
pub(crate) struct Scene {
    pub(crate) input: SceneInput,
    /// The options that decided how the particles look, if they are in memory.
    look: Option<(Style, Vec<(String, String)>)>,
    /// The scene of the last pick, with its choices.
    picked: Mutex<Option<(Choices, Pickable)>>,
}

/// A scene in which spheres are picked.
struct Pickable {
    prepared: PreparedScene,
    /// Which rows of its particles each table shows.
    rows: Vec<Option<FileRows>>,
}

/// Spheres in memory, for a sphere table.
#[pyclass(frozen, module = "photosphere._core")]
pub(crate) struct Spheres(SphereArrays);

#[pymethods]
impl Spheres {
    /// Centres and radii (one, or one for each) in f32 if `single`, with linear colours, emission
    /// and ids.
    #[new]
    fn new(
        center: &Bound<'_, PyAny>,
        single: bool,
        radius: &Bound<'_, PyAny>,
        color: Option<&Bound<'_, PyAny>>,
        emission: Option<&Bound<'_, PyAny>>,
        ids: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let (center, len) = match single {
            true => {
                let rows: Vec<[f32; 3]> = finite(arrays::rows(center)?, "center")?;
                let len = rows.len();
                (StridedArray::columns_from(rows), len)
            }
            false => {
                let rows: Vec<[f64; 3]> = finite(arrays::rows(center)?, "center")?;
                let len = rows.len();
                (StridedArray::columns_from(rows), len)
            }
        };
        let radius = match radius.extract::<f64>() {
            Ok(radius) => StridedArray::constant(radius, len),
            Err(_) if single => StridedArray::from_vec(arrays::values::<f32>(radius)?),
            Err(_) => StridedArray::from_vec(arrays::values::<f64>(radius)?),
        };
        let colors = |rows: Option<&Bound<'_, PyAny>>| -> PyResult<_> {
            let rows = rows.map(arrays::rows::<f32, 3>).transpose()?;
            Ok(rows.map(StridedArray::columns_from))
        };
        let ids = ids.map(arrays::values::<u32>).transpose()?.map(StridedArray::of_ids);
        let (color, emission) = (colors(color)?, colors(emission)?);
        Ok(Self(SphereArrays { center, radius, color, emission, ids }))
    }
}

#[pymethods]
impl Scene {
    /// A scene file, or a particle file.
    #[staticmethod]
    fn file(path: PathBuf) -> Self {
        Self::of(SceneInput::File(path))
    }

    /// The text of a scene, whose sphere tables are in memory.
    #[staticmethod]
    fn text(name: String, text: String, folder: PathBuf, tables: Vec<PyRef<'_, Spheres>>) -> Self {
        let tables = tables.iter().map(|table| TableInput::from(table.0.clone())).collect();
        Self::of(SceneInput::Text { name, text, folder, tables })
    }

    /// Particles in memory, whose look these choices decide.
    #[staticmethod]
    fn particles(
        py: Python<'_>,
        columns: &Columns,
        name: String,
        words: Vec<String>,
        changes: Changes,
    ) -> PyResult<Self> {
        let request = parse(py, &words)?;
        let changes = overrides(&changes);
        let given = TableInput::from(columns.take()?);
        let path = PathBuf::from(&name);
        let look = request.look(&changes);
        let input = |particles| SceneInput::Particles { name, path, particles };
        let particles = pool::run_interruptible(py, move || {
            let (name, path) = ("the arrays".to_owned(), PathBuf::from("arrays.npz"));
            let particles = given;
            let opened = request.open(SceneInput::Particles { name, path, particles }, &changes)?;
            opened.file.particle_input().ok_or_else(|| Error::input("there are no particles"))
        })?;
        Ok(Self { look: Some(look), ..Self::of(input(particles)) })
    }

    /// Facts about the scene with these choices, as JSON.
    fn describe(
        slf: Py<Self>,
        py: Python<'_>,
        words: Vec<String>,
        changes: Changes,
    ) -> PyResult<String> {
        let request = parse(py, &words)?;
        pool::run_interruptible(py, move || {
            let OpenedScene { file, text, notes, choices } =
                slf.get().open(&request, &overrides(&changes))?;
            let loaded = file.particles().next();
            let settings = &file.settings;
            Ok(json!({
                "spheres": file.size().spheres,
                "own_spheres": file.description.spheres.len(),
                "particles": loaded.map(|loaded| loaded.len() - loaded.look.edges),
                "edges": loaded.map(|loaded| loaded.look.edges),
                "copies": loaded.map(|loaded| loaded.look.copies),
                "text": text,
                "notes": notes,
                "choices": choices,
                "width": settings.image.width,
                "height": settings.image.height,
                "spp": settings.render.samples_per_pixel,
                "camera": file.description.camera,
                "overlay": request.overlay(&file),
            })
            .to_string())
        })
    }

    /// The identity of the scene: equal ones render to equal pictures.
    fn content_hash(
        slf: Py<Self>,
        py: Python<'_>,
        words: Vec<String>,
        changes: Changes,
    ) -> PyResult<String> {
        let request = parse(py, &words)?;
        pool::run_interruptible(py, move || {
            let (scene, _) = slf.get().open(&request, &overrides(&changes))?.file.build()?;
            Ok(scene.content_hash().to_string())
        })
    }

    /// The sphere in the middle of a pixel, as JSON; `None` for the background.
    fn pick(
        slf: Py<Self>,
        py: Python<'_>,
        words: Vec<String>,
        changes: Changes,
        pixel: [u32; 2],
    ) -> PyResult<Option<String>> {
        let request = parse(py, &words)?;
        let given = (words, changes);
        pool::run_interruptible(py, move || {
            let this = slf.get();
            let kept = this.last_picked().take().filter(|(choices, _)| *choices == given);
            let scene = match kept {
                Some((_, scene)) => scene,
                None => {
                    let opened = this.open(&request, &overrides(&given.1))?;
                    let rows = opened.file.file_rows();
                    let (scene, settings) = opened.file.build()?;
                    Pickable { prepared: PreparedScene::new(&scene, settings)?, rows }
                }
            };
            let found = scene.pick(pixel);
            *this.last_picked() = Some((given, scene));
            Ok(found?.map(|found| found.to_string()))
        })
    }
}

impl Scene {
    fn of(input: SceneInput) -> Self {
        Self { input, look: None, picked: Mutex::new(None) }
    }

    /// Reads the scene.
    ///
    /// # Errors
    /// If the scene or an option is wrong, or one would change particles that are in memory.
    pub(crate) fn open(
        &self,
        request: &KeywordRender,
        changes: &[Override],
    ) -> Result<OpenedScene> {
        if self.look.as_ref().is_some_and(|look| *look != request.look(changes)) {
            let message = "the style and the look of particles are part of their scene";
            return Err(Error::input(message).with_help(
                "give these options where the scene is made: ps.spheres(...) or .scene(...)",
            ));
        }
        request.open(self.input.clone(), changes)
    }

    fn last_picked(&self) -> MutexGuard<'_, Option<(Choices, Pickable)>> {
        self.picked.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The tables in memory, for a render that goes on.
    pub(crate) fn tables(&self) -> Vec<TableInput> {
        match &self.input {
            SceneInput::File(_) => Vec::new(),
            SceneInput::Text { tables, .. } => tables.clone(),
            SceneInput::Particles { particles, .. } => vec![particles.clone()],
        }
    }
}

/// Reads options.
///
/// # Errors
/// Says what is wrong with them.
pub(crate) fn parse(py: Python<'_>, words: &[String]) -> PyResult<KeywordRender> {
    KeywordRender::parse(words).map_err(|message| error::raise_usage(py, &message))
}

/// Changed keys as overrides.
pub(crate) fn overrides(changes: &Changes) -> Vec<Override> {
    changes.iter().map(|(key, value)| Override::new(key, value)).collect()
}

impl Pickable {
    /// The sphere in the middle of a pixel, with its rows.
    fn pick(&self, pixel: [u32; 2]) -> Result<Option<serde_json::Value>> {
        let image = &self.prepared.settings().image;
        if pixel[0] >= image.width || pixel[1] >= image.height {
            let [x, y] = pixel;
            let (width, height) = (image.width, image.height);
            return Err(Error::input(format!("the picture has no pixel {x}, {y}"))
                .with_help(format!("it has {width} columns and {height} rows, counted from 0")));
        }
        let scene = self.prepared.scene();
        let accel =
            accel::Backend::BruteForce.build(scene.spheres(), &accel::BuildOptions::default())?;
        let found = pick_in_scene(&self.prepared, accel.as_ref(), pixel);
        Ok(found.map(|found| as_json(&found, scene.table_and_row(found.row), &self.rows)))
    }
}

/// A sphere, with its row in its table, and that of the particle that it shows.
fn as_json(
    found: &Pick,
    place: Option<(usize, u32)>,
    rows: &[Option<FileRows>],
) -> serde_json::Value {
    let particles = place.and_then(|(table, row)| Some((rows.get(table)?.as_ref()?, row)));
    json!({
        "name": found.name,
        "row": found.row,
        "table_row": place.map(|(_, row)| row),
        "is_of_particles": particles.is_some(),
        "particle": particles.and_then(|(rows, row)| rows.row_in_file(row)),
        "center": found.center.to_array(),
        "radius": found.radius,
        "depth": found.distance,
    })
}
